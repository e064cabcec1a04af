#include "measurement/surface_section.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "measurement/carried_planes.h"
#include "tests/measurement/sphere_scan.h"

namespace fathom {
namespace {

// Sections by `poses`, each outlined by the same rectangle, finely, in millimetres of its image.
std::vector<SurfaceSection> rectangles(const std::vector<Eigen::Isometry3d>& poses, double low, double high) {
  const auto planes = carried_planes(scan_of(poses, 1.0));
  Polygon outline;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) outline.emplace_back(0.0, low + (high - low) * i / kSteps);
  for (int i = 0; i < kSteps; ++i) outline.emplace_back(1e-3, high - (high - low) * i / kSteps);
  std::vector<SurfaceSection> sections;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    SurfaceSection section;
    section.frame = static_cast<int>(i);
    section.place = planes[i].value();
    section.outlines_px = {outline};
    sections.push_back(section);
  }
  return sections;
}

TEST(SectionDistance, OfParallelPlanesIsTheSameHoweverItIsAveraged) {
  const auto sections = rectangles(turning_sweep({0.0, 2.5}), 3.0, 20.0);
  const SectionDistance distance = distance_between(sections[0], sections[1]);
  EXPECT_NEAR(distance.mean_mm, 2.5, 1e-9);
  EXPECT_NEAR(distance.largest_mm, 2.5, 1e-9);
  EXPECT_NEAR(distance.lattice_mm, 2.5, 1e-9);
}

// Along a line from the axis of a fan on the logarithm of the distance has the mean log(largest) - 1.
TEST(SectionDistance, InAFanFromItsAxisOnIsTheGeometricMean) {
  std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  poses[1].rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()));
  const auto sections = rectangles(poses, 0.0, 20.0);
  const SectionDistance distance = distance_between(sections[0], sections[1]);
  EXPECT_NEAR(distance.largest_mm, 40.0 * std::sin(0.05), 1e-2);
  EXPECT_NEAR(distance.mean_mm, 0.5 * distance.largest_mm, 1e-6);
  EXPECT_NEAR(distance.lattice_mm / distance.largest_mm, 1.0 / std::numbers::e, 2e-3);
}

// Stretched as much as it is squeezed: exact for two outlines at two distances, sqrt(d1 d2).
TEST(SectionDistance, OfTwoPlacesBalancesThem) {
  std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  poses[1].rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()));
  auto sections = rectangles(poses, 4.0, 4.01);
  const auto others = rectangles(poses, 16.0, 16.01);
  for (std::size_t i = 0; i < sections.size(); ++i) sections[i].outlines_px.push_back(others[i].outlines_px[0]);
  const double lattice_mm = distance_between(sections[0], sections[1]).lattice_mm;
  EXPECT_NEAR(lattice_mm / (2.0 * std::sin(0.05)), std::sqrt(4.0 * 16.0), 0.02);
}

}  // namespace
}  // namespace fathom
