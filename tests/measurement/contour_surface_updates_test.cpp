#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "measurement/contour_surface.h"
#include "tests/measurement/surface_checks.h"

namespace fathom {
namespace {

using surfaces::expect_same;
using surfaces::expect_sound;
using surfaces::kCentre;
using surfaces::kRadius;

TEST(ContourSurface, UpdatedAfterEditsEqualsTheOneMadeAfresh) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(-9.5, 9.5, 39), 0.01, 0.015), 0.1);
  Structure structure = ball(locator, kCentre, kRadius, 2);
  ContourSurfaceOptions options;
  options.order = GapOrder::kLinear;
  options.spacing_mm = 0.5;
  ContourSurface surface(locator, options);
  surface.update(structure);
  const int all = surface.layers();
  EXPECT_EQ(surface.layers_made(), all);

  const auto expect_equal_to_fresh = [&](int most_layers) {
    surface.update(structure);
    EXPECT_LE(surface.layers_made(), most_layers);
    ContourSurface fresh(locator, options);
    fresh.update(structure);
    expect_same(surface.mesh(), fresh.mesh());
    expect_sound(surface.mesh());
  };
  // Edited: smaller by a tenth.
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : structure.contours[8].points_px) centre_px += point / 120.0;
  for (Eigen::Vector2d& point : structure.contours[8].points_px) point = centre_px + 0.9 * (point - centre_px);
  expect_equal_to_fresh(all / 5);
  // Added between two, then removed again, then one at an end removed.
  structure.contours.push_back(ball_contour(locator, 11, kCentre, 0.97 * kRadius)[0]);
  expect_equal_to_fresh(all / 5);
  structure.contours.pop_back();
  expect_equal_to_fresh(all / 5);
  structure.contours.erase(structure.contours.begin());
  expect_equal_to_fresh(all / 5);
  // Nothing changed.
  surface.update(structure);
  EXPECT_EQ(surface.layers_made(), 0);
  // Larger than the lattice was.
  for (Eigen::Vector2d& point : structure.contours[8].points_px) point = centre_px + 1.8 * (point - centre_px);
  expect_equal_to_fresh(all + 2);
}

TEST(ContourSurface, DoesNotDependOnTheNumberOfThreads) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(-9.0, 9.0, 9), 0.02, 0.01), 0.1);
  const Structure structure = ball(locator, kCentre, kRadius);
  const int before = cv::getNumThreads();
  ContourSurface one(locator, {});
  cv::setNumThreads(1);
  one.update(structure);
  for (const int threads : {2, 5}) {
    cv::setNumThreads(threads);
    ContourSurface many(locator, {});
    many.update(structure);
    expect_same(one.mesh(), many.mesh());
  }
  cv::setNumThreads(before);
}

// An edit reaches two gaps on either side of it, and no farther.
TEST(ContourSurface, OfSecondOrderUpdatedAfterEditsEqualsTheOneMadeAfreshForAnyNumberOfThreads) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(-9.5, 9.5, 39), 0.01, 0.015), 0.1);
  Structure structure = ball(locator, kCentre, kRadius, 2);
  ContourSurfaceOptions options;
  options.spacing_mm = 0.5;
  options.order = GapOrder::kCurved;
  ContourSurface surface(locator, options);
  surface.update(structure);
  const int all = surface.layers();
  const int threads_before = cv::getNumThreads();
  const auto expect_equal_to_fresh = [&](int threads) {
    surface.update(structure);
    EXPECT_LE(surface.layers_made(), 2 * all / 5);
    cv::setNumThreads(threads);
    ContourSurface fresh(locator, options);
    fresh.update(structure);
    cv::setNumThreads(threads_before);
    expect_same(surface.mesh(), fresh.mesh());
    expect_sound(surface.mesh());
  };
  const std::vector<Eigen::Vector3d> before = surface.mesh().vertices;
  structure.contours[8].points_px[10] += Eigen::Vector2d(8.0, 3.0);
  expect_equal_to_fresh(1);
  EXPECT_FALSE(surface.mesh().vertices == before);
  structure.contours.push_back(ball_contour(locator, 11, kCentre, 0.97 * kRadius)[0]);
  expect_equal_to_fresh(5);
  structure.contours.pop_back();
  expect_equal_to_fresh(2);
  structure.contours.erase(structure.contours.begin());
  expect_equal_to_fresh(1);
  const Mesh kept = surface.mesh();
  structure.contours[4].points_px[0] += Eigen::Vector2d(0.5, 0.0);
  EXPECT_THROW(surface.update(structure, [](double) { return false; }), Cancelled);
  expect_same(surface.mesh(), kept);
  expect_equal_to_fresh(1);
}

}  // namespace
}  // namespace fathom
