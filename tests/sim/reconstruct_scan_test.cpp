#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "registration/reconstruct.h"
#include "sim/simulate.h"

namespace fathom {
namespace {

/// The centroid of the true outlines' points, which lie on a sphere, by the ball that fits them.
Eigen::Vector3d centre_of_ball(const SimulatedScan& scan, const FrameLocator& locator) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Contour& contour : scan.outlines.front().contours) {
    const Eigen::Affine3d reference_from_image = *locator.reference_from_image(contour.frame);
    for (const Eigen::Vector2d& point : contour.points_px) {
      // |p|^2 = 2 p.c + (r^2 - |c|^2) is linear in the centre.
      const Eigen::Vector3d p = reference_from_image * Eigen::Vector3d(point.x(), point.y(), 0.0);
      const Eigen::Vector4d row(2.0 * p.x(), 2.0 * p.y(), 2.0 * p.z(), 1.0);
      normal += row * row.transpose();
      right += p.squaredNorm() * row;
    }
  }
  return normal.ldlt().solve(right).head<3>();
}

struct Body {
  double mass_mm3 = 0.0;
  Eigen::Vector3d centroid_mm = Eigen::Vector3d::Zero();
};

/// Voxels weighted by their values, of which 255 is all object.
Body body_of(const Volume& volume, double spacing_mm) {
  const cv::Mat& voxels = volume.voxels;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double mass = 0.0;
  for (int z = 0; z < voxels.size[0]; ++z) {
    for (int y = 0; y < voxels.size[1]; ++y) {
      for (int x = 0; x < voxels.size[2]; ++x) {
        const double share = voxels.at<std::uint8_t>(z, y, x) / 255.0;
        mass += share;
        sum += share * Eigen::Vector3d(x, y, z);
      }
    }
  }
  return {mass * std::pow(spacing_mm, 3), volume.reference_from_voxel * Eigen::Vector3d(sum / mass)};
}

class ReconstructScan : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Patterns, ReconstructScan, testing::Values("linear", "free"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST_P(ReconstructScan, ABallKeepsItsPlaceAndItsMass) {
  SimulateOptions options;
  options.pattern = GetParam();
  options.frames = 67;
  const SimulatedScan scan = simulate(options);
  const FrameLocator locator(*scan.recording, scan.calibration);
  ReconstructOptions reconstruction;
  reconstruction.spacing_mm = 0.4;
  reconstruction.insertion = Insertion::kLinear;
  const Body body = body_of(reconstruct(*scan.recording, locator, reconstruction).volume, reconstruction.spacing_mm);
  EXPECT_LT((body.centroid_mm - centre_of_ball(scan, locator)).norm(), 0.3);
  EXPECT_NEAR(body.mass_mm3 / (4.0 / 3.0 * std::numbers::pi * 1000.0), 1.0, 0.01);
}

}  // namespace
}  // namespace fathom
