#include "measurement/ellipsoid_volume.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

#include <Eigen/Eigenvalues>

namespace fathom {

std::optional<EllipsoidVolume> ellipsoid_volume(const Structure& structure, const FrameLocator& locator,
                                                int recording) {
  std::vector<Eigen::Vector3d> points;
  std::set<int> frames;
  const auto add = [&](int frame, const Eigen::Vector2d& point_px) {
    const auto place = locator.reference_from_image(frame);
    if (!place) return;
    points.push_back(*place * Eigen::Vector3d(point_px.x(), point_px.y(), 0.0));
    frames.insert(frame);
  };
  for (const Contour& contour : structure.contours) {
    if (contour.recording != recording || contour.frame >= locator.frame_count()) continue;
    for (const Eigen::Vector2d& point : contour.points_px) add(contour.frame, point);
  }
  for (const Extremity& extremity : structure.extremities) {
    if (extremity.recording == recording && extremity.frame < locator.frame_count()) {
      add(extremity.frame, extremity.point_px);
    }
  }
  if (frames.size() < 2) return std::nullopt;

  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) mean += point / static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) scatter += (point - mean) * (point - mean).transpose();
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector3d high = -low;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d along = axes.transpose() * (point - mean);
    low = low.cwiseMin(along);
    high = high.cwiseMax(along);
  }
  EllipsoidVolume result;
  result.diameters_mm = high - low;
  std::sort(result.diameters_mm.begin(), result.diameters_mm.end(), std::greater<>());
  result.volume_ml = std::numbers::pi / 6.0 * result.diameters_mm.prod() / 1000.0;
  return result;
}

}  // namespace fathom
