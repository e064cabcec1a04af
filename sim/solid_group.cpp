#include <algorithm>
#include <cassert>

#include "sim/solid.h"

namespace fathom {

namespace {

double group_volume_mm3(const std::vector<PlacedSolid>& parts) {
  double sum = 0.0;
  for (const PlacedSolid& part : parts) sum += part.solid->volume_mm3();
  return sum;
}

double group_area_mm2(const std::vector<PlacedSolid>& parts) {
  double sum = 0.0;
  for (const PlacedSolid& part : parts) sum += part.solid->area_mm2();
  return sum;
}

double group_reach_mm(const std::vector<PlacedSolid>& parts) {
  double reach = 0.0;
  for (const PlacedSolid& part : parts) reach = std::max(reach, part.place_mm.norm() + part.solid->radius_mm());
  return reach;
}

class Group final : public Solid {
 public:
  explicit Group(std::vector<PlacedSolid> parts)
      : Solid(group_volume_mm3(parts), group_area_mm2(parts), group_reach_mm(parts)), parts_(std::move(parts)) {
    assert(!parts_.empty());
  }

  double distance_bound_mm(const Eigen::Vector3d& x) const override {
    double nearest = parts_.front().solid->distance_bound_mm(x - parts_.front().place_mm);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      nearest = std::min(nearest, parts_[i].solid->distance_bound_mm(x - parts_[i].place_mm));
    }
    return nearest;
  }

  Contact contact(const Eigen::Vector3d& direction) const override {
    Contact farthest;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      Contact contact = parts_[i].solid->contact(direction);
      contact.point_mm += parts_[i].place_mm;
      if (i == 0 || contact.point_mm.dot(direction) > farthest.point_mm.dot(direction)) farthest = contact;
    }
    return farthest;
  }

 private:
  std::vector<PlacedSolid> parts_;
};

}  // namespace

std::shared_ptr<const Solid> make_group(std::vector<PlacedSolid> parts) {
  return std::make_shared<Group>(std::move(parts));
}

std::vector<PlacedSolid> centred(std::vector<PlacedSolid> parts) {
  const Group group(parts);
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
    middle[axis] = (group.contact(along).point_mm[axis] + group.contact(-along).point_mm[axis]) / 2.0;
  }
  for (PlacedSolid& part : parts) part.place_mm -= middle;
  return parts;
}

}  // namespace fathom
