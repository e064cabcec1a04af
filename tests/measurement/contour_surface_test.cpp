#include "measurement/contour_surface.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "surface/mesh_measure.h"
#include "tests/measurement/surface_checks.h"

namespace fathom {
namespace {

using surfaces::distance_to;
using surfaces::expect_same;
using surfaces::expect_sound;
using surfaces::kCentre;
using surfaces::kPi;
using surfaces::kRadius;
using surfaces::message_of;

TEST(ContourSurface, PassesThroughItsContours) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(-9.5, 9.5, 12), 0.01, -0.02), 0.1);
  const Structure structure = ball(locator, kCentre, kRadius);
  for (const GapOrder order : {GapOrder::kLinear, GapOrder::kCurved}) {
    ContourSurfaceOptions options;
    options.order = order;
    ContourSurface surface(locator, options);
    const Mesh& mesh = surface.update(structure);
    for (const Contour& contour : structure.contours) {
      for (std::size_t i = 0; i < contour.points_px.size(); ++i) {
        const Eigen::Vector2d& px = contour.points_px[i];
        const Eigen::Vector3d point =
            *locator.reference_from_image(contour.frame) * Eigen::Vector3d(px.x(), px.y(), 0.0);
        EXPECT_LE(distance_to(mesh, point), 0.5 * surface.spacing_mm()) << "frame " << contour.frame;
      }
    }
  }
}

TEST(ContourSurface, EndsFlatOnTheFirstAndLastFrame) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(-4.0, 5.0, 4), 0.02), 0.1);
  ContourSurface surface(locator, {});
  const Mesh& mesh = surface.update(ball(locator, kCentre, kRadius));
  expect_sound(mesh);
  const Eigen::Affine3d image_from_reference = locator.reference_from_image(3)->inverse();
  double area_on_plane = 0.0;
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    const bool on_plane = std::all_of(triangle.begin(), triangle.end(), [&](std::int32_t vertex) {
      return std::abs((image_from_reference * mesh.vertices[static_cast<std::size_t>(vertex)]).z()) < 1e-3;
    });
    if (!on_plane) continue;
    const Eigen::Vector3d& a = mesh.vertices[static_cast<std::size_t>(triangle[0])];
    const Eigen::Vector3d& b = mesh.vertices[static_cast<std::size_t>(triangle[1])];
    const Eigen::Vector3d& c = mesh.vertices[static_cast<std::size_t>(triangle[2])];
    area_on_plane += 0.5 * (b - a).cross(c - a).norm();
  }
  const Eigen::Vector3d centre_px = image_from_reference * kCentre;
  const double off = 0.1 * centre_px.z();
  EXPECT_NEAR(area_on_plane / (kPi * (kRadius * kRadius - off * off)), 1.0, 0.01);
}

TEST(ContourSurface, KeepsItsVolumeTenMetresAwayAndTurned) {
  std::vector<Eigen::Isometry3d> poses = turning_sweep(evenly(-9.0, 9.0, 10), 0.02);
  const FrameLocator near = scan_of(poses, 0.1);
  Eigen::Isometry3d away = Eigen::Isometry3d::Identity();
  away.translate(Eigen::Vector3d(10000.0, -7000.0, 4000.0));
  away.rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()));
  for (Eigen::Isometry3d& pose : poses) pose = away * pose;
  const FrameLocator far = scan_of(poses, 0.1);
  const Structure structure = ball(near, kCentre, kRadius);
  ContourSurface here(near, {});
  ContourSurface there(far, {});
  here.update(structure);
  there.update(structure);
  EXPECT_NEAR(*there.volume_ml() / *here.volume_ml(), 1.0, 1e-6);
}

TEST(ContourSurface, FacesOutwardWhicheverWayTheProbeWasHeld) {
  std::vector<double> places = evenly(-9.0, 9.0, 10);
  const FrameLocator forward = scan_of(turning_sweep(places), 0.1);
  std::reverse(places.begin(), places.end());
  const FrameLocator backward = scan_of(turning_sweep(places), 0.1);
  ContourSurface a(forward, {});
  ContourSurface b(backward, {});
  a.update(ball(forward, kCentre, kRadius));
  b.update(ball(backward, kCentre, kRadius));
  EXPECT_NEAR(*a.volume_ml() / *b.volume_ml(), 1.0, 1e-3);
  for (const ContourSurface* surface : {&a, &b}) {
    const Mesh& mesh = surface->mesh();
    EXPECT_GT(volume_mm3(mesh), 0.0);
    std::size_t outward = 0;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      outward += mesh.normals[i].dot(mesh.vertices[i] - kCentre) > 0.0 ? 1 : 0;
    }
    EXPECT_EQ(outward, mesh.vertices.size());
  }
}

TEST(ContourSurface, EndsHalfWayToAFrameThatIsMarkedAbsent) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(0.0, 40.0, 5)), 0.1);
  Structure structure;
  structure.name = "two balls";
  for (const int frame : {0, 1, 3, 4}) {
    Contour contour = ball_contour(locator, 0, {12.0, 14.0, 0.0}, 8.0)[0];
    contour.frame = frame;
    structure.contours.push_back(contour);
  }
  structure.absent.push_back({2, 0});
  ContourSurface surface(locator, {});
  const Mesh& mesh = surface.update(structure);
  expect_sound(mesh);
  EXPECT_EQ(mesh_topology(mesh).components, 2);
  double gap_low = 0.0, gap_high = 40.0;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    if (vertex.z() < 20.0) gap_low = std::max(gap_low, vertex.z());
    if (vertex.z() > 20.0) gap_high = std::min(gap_high, vertex.z());
  }
  EXPECT_NEAR(gap_low, 15.0, 0.7);
  EXPECT_NEAR(gap_high, 25.0, 0.7);
}

TEST(ContourSurface, IsNotWhereSeveralFramesAreMarkedAbsent) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(0.0, 40.0, 5)), 0.1);
  const auto balls = [&](const std::vector<int>& outlined, const std::vector<int>& absent) {
    Structure structure;
    structure.name = "two balls";
    for (const int frame : outlined) {
      Contour contour = ball_contour(locator, 0, {12.0, 14.0, 0.0}, 8.0)[0];
      contour.frame = frame;
      structure.contours.push_back(contour);
    }
    for (const int frame : absent) structure.absent.push_back({frame, 0});
    return structure;
  };
  ContourSurface surface(locator, {});
  surface.update(balls({0, 1, 4}, {2, 3}));
  EXPECT_TRUE(std::isfinite(surface.spacing_mm()));
  EXPECT_EQ(mesh_topology(surface.mesh()).components, 2);
  // As far apart as any frames, so as many layers as between any.
  ContourSurface whole(locator, {});
  whole.update(balls({0, 1, 2, 3, 4}, {}));
  EXPECT_EQ(surface.layers(), whole.layers());
  EXPECT_EQ(surface.spacing_mm(), whole.spacing_mm());
}

TEST(ContourSurface, EndsInAPointAtAnExtremity) {
  const FrameLocator locator = scan_of(turning_sweep({0.0, 10.0}), 0.1);
  Structure structure;
  structure.name = "cone";
  structure.contours = ball_contour(locator, 0, {12.0, 14.0, 0.0}, 6.0);
  structure.extremities.push_back({1, {120.0, 140.0}, 0});
  ContourSurfaceOptions options;
  options.guide = Guide::kShape;
  ContourSurface surface(locator, options);
  expect_sound(surface.update(structure));
  EXPECT_NEAR(*surface.volume_ml() / (kPi * 36.0 * 10.0 / 3.0 / 1000.0), 1.0, 2e-3);
}

TEST(ContourSurface, RefusesWhatHasNoSurfaceAndSaysWhy) {
  const FrameLocator locator = scan_of(turning_sweep({0.0, 2.0, 2.0, 4.0}), 0.1, {});
  ContourSurface surface(locator, {});
  Structure structure = ball(locator, kCentre, kRadius);
  EXPECT_NE(message_of([&] { surface.update(structure); }).find("frames 1 and 2 lie on the same plane"),
            std::string::npos);
  structure.contours.erase(structure.contours.begin() + 2);
  surface.update(structure);
  const Mesh kept = surface.mesh();

  Structure one = structure;
  one.contours.resize(1);
  EXPECT_NE(message_of([&] { surface.update(one); }).find("at least two frames"), std::string::npos);
  Structure crossing = structure;
  std::swap(crossing.contours[1].points_px[3], crossing.contours[1].points_px[60]);
  EXPECT_NE(message_of([&] { surface.update(crossing); }).find("crosses itself"), std::string::npos);
  const Progress stop = [](double) { return false; };
  Structure edited = structure;
  edited.contours[1].points_px[0] += Eigen::Vector2d(0.5, 0.0);
  EXPECT_THROW(surface.update(edited, stop), Cancelled);
  expect_same(surface.mesh(), kept);
}

TEST(ContourSurface, RefusesASpacingTooFineForMemoryWithOneThatFits) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(-9.0, 9.0, 10)), 0.1);
  ContourSurfaceOptions options;
  options.spacing_mm = 0.01;
  ContourSurface surface(locator, options);
  const std::string message = message_of([&] { surface.update(ball(locator, kCentre, kRadius)); });
  EXPECT_NE(message.find(" GB"), std::string::npos) << message;
  EXPECT_NE(message.find("mm fits"), std::string::npos) << message;
  for (const double spacing : {0.0, -1.0, std::nan(""), double{INFINITY}}) {
    options.spacing_mm = spacing;
    EXPECT_THROW(ContourSurface(locator, options), Error);
  }
}

TEST(ContourSurface, LeavesOutFramesWithoutAPositionAndSaysSo) {
  const FrameLocator whole = scan_of(turning_sweep(evenly(-9.0, 9.0, 10)), 0.1);
  const FrameLocator locator = scan_of(turning_sweep(evenly(-9.0, 9.0, 10)), 0.1, {4});
  ContourSurface surface(locator, {});
  surface.update(ball(whole, kCentre, kRadius));
  ASSERT_EQ(surface.warnings().size(), 1u);
  EXPECT_NE(surface.warnings()[0].find("frame 4"), std::string::npos);
}

}  // namespace
}  // namespace fathom
