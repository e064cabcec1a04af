#include "sim/scan_plan.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "registration/dividing_planes.h"
#include "sim/choice.h"

namespace fathom {

namespace {

constexpr int kSampledPlanes = 9;  // of each sweep: enough for the mean of their centres
constexpr int kRounds = 6;         // the ends move the dividing planes, and these the ends: settled after 2 or 3

SweepShape shape_of(const ScanPath& path, const Phantom& phantom, cv::Size size) {
  SweepShape shape;
  for (int i = 0; i < kSampledPlanes; ++i) {
    const Eigen::Affine3d map =
        path.phantom_from_image(path.at(static_cast<double>(i) / (kSampledPlanes - 1)), phantom.pixel_mm);
    shape.add(map, size.width, size.height);
  }
  return shape;
}

SolidPart part_of(std::size_t sweep, const Phantom& phantom, const SpacePartition& partition) {
  std::vector<SolidPart::Cell> cells;
  for (const SpacePartition::Cell& cell : partition.cells()) {
    if (cell.sweep == sweep) cells.push_back(partition.bounds(cell));
  }
  return {*phantom.solid, std::move(cells)};
}

cv::Size image_size_of(const Phantom& phantom, const SweepPattern& pattern) {
  const ScanGeometry& first = pattern.sweeps.front();
  const auto pixels = [&](const Eigen::Vector3d& axis, double share, double pixel_mm) {
    const double extent_mm =
        phantom.solid->contact(axis).point_mm.dot(axis) - phantom.solid->contact(-axis).point_mm.dot(axis);
    return static_cast<int>(std::lround(share * extent_mm / pixel_mm));
  };
  return {pixels(first.depth.cross(first.sweep), pattern.image.x(), phantom.pixel_mm.x()),
          pixels(first.depth, pattern.image.y(), phantom.pixel_mm.y())};
}

double farthest_move_mm(const ScanPath& before, const ScanPath& after) {
  return std::max((before.first.position_mm - after.first.position_mm).norm(),
                  (before.last.position_mm - after.last.position_mm).norm());
}

}  // namespace

ScanPlan make_scan_plan(const Phantom& phantom, const SweepPattern& pattern) {
  ScanPlan plan;
  plan.image_size = image_size_of(phantom, pattern);
  plan.cuts_off = true;
  for (const ScanGeometry& geometry : pattern.sweeps) {
    plan.sweeps.push_back(make_scan_path(phantom, geometry, SolidPart(*phantom.solid), plan.image_size));
  }
  const double settled_mm = 0.1 * SolidPart(*phantom.solid).inset_mm();
  for (int round = 0; round < kRounds; ++round) {
    std::vector<SweepShape> shapes;
    for (const ScanPath& path : plan.sweeps) shapes.push_back(shape_of(path, phantom, plan.image_size));
    const SpacePartition partition = place_dividing_planes(std::move(shapes), nullptr);
    double moved_mm = 0.0;
    for (std::size_t i = 0; i < plan.sweeps.size(); ++i) {
      ScanPath path = make_scan_path(phantom, pattern.sweeps[i], part_of(i, phantom, partition), plan.image_size);
      moved_mm = std::max(moved_mm, farthest_move_mm(plan.sweeps[i], path));
      plan.sweeps[i] = path;
    }
    if (moved_mm < settled_mm) break;
  }
  return plan;
}

ScanPlan make_scan_plan(const Phantom& phantom, const std::string& pattern) {
  const auto names = single_sweep_patterns();
  if (std::find(names.begin(), names.end(), pattern) != names.end()) {
    ScanPlan plan;
    plan.image_size = phantom.image_size;
    plan.sweeps = {make_scan_path(phantom, pattern)};
    return plan;
  }
  for (const SweepPattern& several : sweep_table()) {
    if (pattern == several.name) return make_scan_plan(phantom, several);
  }
  refuse_choice("pattern", pattern, pattern_names());
}

std::vector<std::string> pattern_names() {
  std::vector<std::string> names = single_sweep_patterns();
  for (const SweepPattern& several : sweep_table()) names.emplace_back(several.name);
  return names;
}

std::vector<int> frames_of_sweeps(int frames, std::size_t sweeps) {
  const int count = static_cast<int>(sweeps);
  if (frames < count) {
    throw Error("simulate: " + std::to_string(frames) + " frames are too few for the pattern's " +
                std::to_string(count) + " sweeps; choose at least " + std::to_string(count));
  }
  std::vector<int> shares(sweeps, frames / count);
  for (int i = 0; i < frames % count; ++i) ++shares[static_cast<std::size_t>(i)];
  return shares;
}

}  // namespace fathom
