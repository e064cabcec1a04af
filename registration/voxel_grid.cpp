#include "registration/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"

namespace fathom {

namespace {

constexpr double kMaxVoxels = 1 << 30;  // what volume files may hold

// How many voxels a box of this extent gets.
double voxels_at(const Eigen::Vector3d& extent_mm, double spacing_mm) {
  return ((extent_mm / spacing_mm).array().round() + 1.0).prod();
}

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

// The finest spacing, to three digits, that keeps a box within so many voxels.
double finest_spacing_mm(const Eigen::Vector3d& extent_mm, double max_voxels, double spacing_mm) {
  while (voxels_at(extent_mm, spacing_mm) > max_voxels) spacing_mm *= 1.002;
  const double digit = std::pow(10.0, std::floor(std::log10(spacing_mm)) - 2.0);
  double rounded = std::ceil(spacing_mm / digit) * digit;
  while (voxels_at(extent_mm, rounded) > max_voxels) rounded += digit;
  return rounded;
}

}  // namespace

Eigen::Affine3d VoxelGrid::reference_from_voxel() const {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() *= spacing_mm;
  map.translation() = origin_mm;
  return map;
}

cv::Rect clipped(cv::Size image_size, const std::optional<cv::Rect>& clip) {
  const cv::Rect image({0, 0}, image_size);
  if (!clip) return image;
  // Kept apart from cv::Rect's own intersection, whose sums overflow for hostile numbers.
  const auto right = std::min<std::int64_t>(std::int64_t{clip->x} + clip->width, image_size.width);
  const auto bottom = std::min<std::int64_t>(std::int64_t{clip->y} + clip->height, image_size.height);
  const int x = std::max(clip->x, 0);
  const int y = std::max(clip->y, 0);
  if (clip->width <= 0 || clip->height <= 0 || right <= x || bottom <= y) {
    throw Error("the clip rectangle leaves nothing of images of " + std::to_string(image_size.width) + " x " +
                std::to_string(image_size.height) + " pixels; give x,y,width,height within them");
  }
  return {x, y, static_cast<int>(right) - x, static_cast<int>(bottom) - y};
}

VoxelGrid grid_around(const std::vector<PlacedFrame>& frames, cv::Size image_size, const std::optional<cv::Rect>& clip,
                      double spacing_mm) {
  const cv::Rect used = clipped(image_size, clip);
  const cv::Point last(std::min(used.x + used.width, image_size.width - 1),
                       std::min(used.y + used.height, image_size.height - 1));
  const Eigen::AlignedBox3d box = box_around(frames, used.tl(), last);
  VoxelGrid grid;
  grid.origin_mm = box.min();
  grid.spacing_mm = spacing_mm;
  for (int axis = 0; axis < 3; ++axis) {
    const double steps = std::round(box.sizes()[axis] / spacing_mm);
    if (!(steps < kMaxVoxels)) {
      throw Error("a spacing of " + text("%g", spacing_mm) + " mm is too fine for frames that reach over " +
                  text("%.0f", box.sizes()[axis]) + " mm; choose a larger spacing");
    }
    grid.size[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(steps) + 1;
  }
  return grid;
}

void require_fits(const VoxelGrid& grid, double bytes_per_voxel, double max_bytes, const std::string& name) {
  const Eigen::Vector3d size(static_cast<double>(grid.size[0]), static_cast<double>(grid.size[1]),
                             static_cast<double>(grid.size[2]));
  const double max_voxels = std::floor(std::min(kMaxVoxels, max_bytes / bytes_per_voxel));
  if (size.prod() <= max_voxels) return;
  const std::string what = name + ": at " + text("%g", grid.spacing_mm) + " mm it takes " +
                           text("%.0f", std::ceil(size.prod() * bytes_per_voxel / 1e6)) + " MB (" +
                           text("%.0f", size[0]) + " x " + text("%.0f", size[1]) + " x " + text("%.0f", size[2]) +
                           " voxels), and " + text("%.0f", max_voxels * bytes_per_voxel / 1e6) + " MB are allowed; ";
  if (max_voxels < 1.0) throw Error(what + "allow more memory");
  const Eigen::Vector3d extent_mm = (size.array() - 1.0) * grid.spacing_mm;
  throw Error(what + "a spacing of " + text("%g", finest_spacing_mm(extent_mm, max_voxels, grid.spacing_mm)) +
              " mm fits");
}

}  // namespace fathom
