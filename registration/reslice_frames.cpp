#include "registration/reslice_frames.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

// Outer corners of the used pixels.
std::vector<Eigen::Vector3d> corners(const Eigen::Affine3d& map, const cv::Rect& used) {
  std::vector<Eigen::Vector3d> found;
  for (const double x : {used.x - 0.5, used.x + used.width - 0.5}) {
    for (const double y : {used.y - 0.5, used.y + used.height - 0.5}) found.push_back(map * Eigen::Vector3d(x, y, 0.0));
  }
  return found;
}

Eigen::Hyperplane<double, 3> plane_of(const Eigen::Affine3d& map) { return {frame_normal(map), map.translation()}; }

double gap_mm(const PlacedFrame& a, const PlacedFrame& b, const cv::Rect& used) {
  double largest = 0.0;
  for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    const auto plane = plane_of(from->reference_from_image);
    for (const Eigen::Vector3d& corner : corners(to->reference_from_image, used)) {
      largest = std::max(largest, plane.absDistance(corner));
    }
  }
  return largest;
}

Eigen::AlignedBox3d box_of(const ResliceSurface& surface, double thickness_mm) {
  Eigen::AlignedBox3d box;
  for (const ResliceRow& row : surface.rows) {
    for (const double side : {-0.5, 0.5}) {
      const Eigen::Vector3d start_mm = row.start_mm + side * thickness_mm * row.normal;
      box.extend(start_mm);
      box.extend(start_mm + (surface.columns - 1) * row.step_mm);
    }
  }
  return box;
}

}  // namespace

Eigen::AlignedBox3d ResliceFrames::reach(std::size_t frame) const {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& corner : corners(frames[frame].placed.reference_from_image, used)) box.extend(corner);
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(max_gap_mm[frames[frame].sweep]);
  return {box.min() - margin, box.max() + margin};
}

double typical_gap_mm(const std::vector<PlacedFrame>& frames, const cv::Rect& used) {
  std::vector<double> gaps_mm;
  double way_mm = 0.0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    gaps_mm.push_back(gap_mm(frames[i - 1], frames[i], used));
    way_mm += gaps_mm.back();
  }
  std::sort(gaps_mm.begin(), gaps_mm.end());
  double walked_mm = 0.0;
  for (const double gap : gaps_mm) {
    walked_mm += gap;
    if (walked_mm >= 0.5 * way_mm) return gap;
  }
  return 0.0;
}

NearFrames near_frames(const ResliceFrames& frames, const ResliceSurface& surface, double thickness_mm) {
  // Half a pixel more, for frames that show the points on either side of them.
  const Eigen::AlignedBox3d picture = box_of(surface, thickness_mm + surface.spacing_mm);
  const std::size_t count = frames.frames.size();
  const auto follows = [&](std::size_t i) {
    return i + 1 < count && frames.frames[i].sweep == frames.frames[i + 1].sweep;
  };
  std::vector<bool> touches(count);
  for (std::size_t i = 0; i < count; ++i) touches[i] = picture.intersects(frames.reach(i));
  NearFrames near;
  for (std::size_t i = 0; i < count; ++i) {
    if (!touches[i]) continue;
    near.index.push_back(i);
    near.linked.push_back(follows(i) && touches[i + 1]);
  }
  const auto rows = static_cast<Eigen::Index>(near.index.size());
  near.distance.resize(rows, 4);
  near.x.resize(rows, 4);
  near.y.resize(rows, 4);
  Eigen::Vector3d last_normal = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < rows; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Eigen::Affine3d& map = frames.frames[near.index[i]].placed.reference_from_image;
    const auto plane = plane_of(map);
    const bool linked = i > 0 && near.linked[i - 1];
    const double side = linked && plane.normal().dot(last_normal) < 0.0 ? -1.0 : 1.0;
    last_normal = side * plane.normal();
    near.distance.row(k) = side * plane.coeffs().transpose();
    // Projection along the plane's normal, also where image x and y are not perpendicular.
    const Eigen::Matrix<double, 3, 2> sides = map.linear().leftCols<2>();
    const Eigen::Matrix<double, 2, 3> image_from_mm = (sides.transpose() * sides).inverse() * sides.transpose();
    const Eigen::Vector2d first_px = -image_from_mm * map.translation() - Eigen::Vector2d(frames.used.x, frames.used.y);
    near.x.row(k) << image_from_mm.row(0), first_px.x();
    near.y.row(k) << image_from_mm.row(1), first_px.y();
  }
  return near;
}

void RowFunctions::set(const NearFrames& near, const ResliceRow& row, int first, int end) {
  const bool same_step = row.step_mm == row_step_ && first == first_ && end == end_;
  first_ = first;
  end_ = end;
  row_step_ = row.step_mm;
  const NearFrames::Functions* const functions[3] = {&near.distance, &near.x, &near.y};
  for (int k = 0; k < 3; ++k) {
    const auto block = functions[k]->middleRows(first, end - first);
    at_[k].noalias() = block.leftCols<3>() * row.start_mm;
    at_[k] += block.col(3);
    if (!same_step) step_[k].noalias() = block.leftCols<3>() * row.step_mm;
  }
}

}  // namespace fathom
