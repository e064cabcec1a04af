#include "measurement/contour_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "core/random.h"
#include "surface/mesh_check.h"
#include "surface/mesh_measure.h"
#include "tests/measurement/sphere_scan.h"

namespace fathom {
namespace {

constexpr double kPi = std::numbers::pi;
const Eigen::Vector3d kCentre(12.0, 14.0, 0.0);
constexpr double kRadius = 10.0;

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void expect_sound(const Mesh& mesh) {
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
}

void expect_same(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  EXPECT_TRUE(a.vertices == b.vertices);
  EXPECT_TRUE(a.triangles == b.triangles);
  EXPECT_TRUE(a.normals == b.normals);
  EXPECT_TRUE(a.sweep_signs == b.sweep_signs);
}

double distance_to(const Mesh& mesh, const Eigen::Vector3d& point) {
  double least = 1e300;
  for (const Mesh::Triangle& t : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[static_cast<std::size_t>(t[0])];
    const Eigen::Vector3d u = mesh.vertices[static_cast<std::size_t>(t[1])] - a;
    const Eigen::Vector3d v = mesh.vertices[static_cast<std::size_t>(t[2])] - a;
    const Eigen::Vector3d w = point - a;
    if (w.norm() > 3.0) continue;
    // Clamped barycentric coordinates overestimate the distance a little near corners, which is on the safe side.
    const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), wu = w.dot(u), wv = w.dot(v);
    const double d = uu * vv - uv * uv;
    double s = std::clamp((wu * vv - wv * uv) / d, 0.0, 1.0);
    double r = std::clamp((wv * uu - wu * uv) / d, 0.0, 1.0 - s);
    least = std::min(least, (w - s * u - r * v).norm());
  }
  return least;
}

// Twenty parallel planes from one end of the ball to the other, the outermost a little inside of it.
std::vector<double> planes_through_ball() { return evenly(-9.999, 9.999, 20); }

// Cones between the circles: what linear interpolation of distances makes of parallel sections.
double stack_of_cones_mm3(const std::vector<double>& places) {
  double sum = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double r1 = std::sqrt(kRadius * kRadius - places[i - 1] * places[i - 1]);
    const double r2 = std::sqrt(kRadius * kRadius - places[i] * places[i]);
    sum += kPi / 3.0 * (places[i] - places[i - 1]) * (r1 * r1 + r1 * r2 + r2 * r2);
  }
  return sum;
}

TEST(ContourSurface, OfABallIsOfFirstOrderTheStackOfConesThroughItsSections) {
  const FrameLocator locator = scan_of(turning_sweep(planes_through_ball()), 0.1);
  for (const Guide guide : {Guide::kDiscs, Guide::kCentroids, Guide::kShape}) {
    ContourSurfaceOptions options;
    options.guide = guide;
    options.order = GapOrder::kLinear;
    ContourSurface surface(locator, options);
    const Mesh& mesh = surface.update(ball(locator, kCentre, kRadius));
    expect_sound(mesh);
    EXPECT_EQ(mesh_topology(mesh).genus(), 0);
    EXPECT_TRUE(mesh.sweep_signs.empty());
    const double cones_ml = stack_of_cones_mm3(planes_through_ball()) / 1000.0;
    EXPECT_NEAR(*surface.volume_ml() / cones_ml, 1.0, 3e-3);
  }
}

TEST(ContourSurface, PassesThroughItsContours) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(-9.5, 9.5, 12), 0.01, -0.02), 0.1);
  const Structure structure = ball(locator, kCentre, kRadius);
  for (const GapOrder order : {GapOrder::kLinear, GapOrder::kCurved}) {
    ContourSurfaceOptions options;
    options.order = order;
    ContourSurface surface(locator, options);
    const Mesh& mesh = surface.update(structure);
    for (const Contour& contour : structure.contours) {
      for (std::size_t i = 0; i < contour.points_px.size(); i += 10) {
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

TEST(ContourSurface, OfSecondOrderLosesAboutHalfOfWhatLinearInterpolationCutsOffABall) {
  const double truth_ml = 4.0 / 3.0 * kPi * std::pow(kRadius, 3) / 1000.0;
  const FrameLocator locator = scan_of(turning_sweep(planes_through_ball()), 0.1);
  std::array<double, 2> error{};
  for (const GapOrder order : {GapOrder::kLinear, GapOrder::kCurved}) {
    ContourSurfaceOptions options;
    options.order = order;
    ContourSurface surface(locator, options);
    surface.update(ball(locator, kCentre, kRadius));
    error[static_cast<std::size_t>(order)] = *surface.volume_ml() / truth_ml - 1.0;
  }
  EXPECT_NEAR(error[0], -0.0095, 0.002);
  EXPECT_LT(std::abs(error[1]), 0.55 * std::abs(error[0]));
}

TEST(ContourSurface, OfSecondOrderIsNotGuidedByCentroids) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(-9.0, 9.0, 10)), 0.1);
  ContourSurfaceOptions options;
  options.guide = Guide::kCentroids;
  EXPECT_NO_THROW(ContourSurface(locator, options));
  options.order = GapOrder::kCurved;
  EXPECT_THROW(ContourSurface(locator, options), Error);
}

TEST(ContourSurface, IsOfSecondOrderUnlessToldOtherwiseOrGuidedByCentroids) {
  const FrameLocator locator = scan_of(turning_sweep(evenly(-9.0, 9.0, 7)), 0.1);
  for (const auto& [guide, order] : {std::pair{Guide::kDiscs, GapOrder::kCurved},
                                     {Guide::kShape, GapOrder::kCurved},
                                     {Guide::kCentroids, GapOrder::kLinear}}) {
    ContourSurfaceOptions options;
    options.guide = guide;
    ContourSurface by_default(locator, options);
    options.order = order;
    ContourSurface told(locator, options);
    by_default.update(ball(locator, kCentre, kRadius));
    told.update(ball(locator, kCentre, kRadius));
    expect_same(by_default.mesh(), told.mesh());
  }
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

TEST(ContourSurface, OfASweepThatTurnsBackCountsTheBallOnce) {
  std::vector<double> places = evenly(-9.5, 4.0, 10);
  for (const double back : evenly(2.5, -5.0, 6)) places.push_back(back);
  for (const double again : evenly(-3.5, 9.5, 9)) places.push_back(again);
  const FrameLocator locator = scan_of(turning_sweep(places), 0.1);
  ContourSurface surface(locator, {});
  surface.update(ball(locator, kCentre, kRadius));
  expect_sound(surface.mesh());
  EXPECT_EQ(std::count(surface.mesh().sweep_signs.begin(), surface.mesh().sweep_signs.end(), -1) > 0, true);
  ASSERT_FALSE(surface.warnings().empty());
  EXPECT_NE(surface.warnings().back().find("backward"), std::string::npos);
  ContourSurface once(locator, {});
  Structure forward = ball(locator, kCentre, kRadius);
  std::erase_if(forward.contours, [&](const Contour& contour) { return contour.frame >= 7 && contour.frame < 19; });
  once.update(forward);
  EXPECT_NEAR(*surface.volume_ml() / *once.volume_ml(), 1.0, 0.02);
}

TEST(ContourSurface, OfPlanesThatCrossInTheObjectCountsWhatWasSweptTwiceOnce) {
  // An unsteady hand: planes 1 mm apart tilt against each other by up to 8 degrees and cross in the ball.
  std::vector<Eigen::Isometry3d> poses = turning_sweep(evenly(-9.0, 9.0, 19));
  Random random(3);
  for (Eigen::Isometry3d& pose : poses) {
    pose.rotate(Eigen::AngleAxisd(0.08 * random.normal(), Eigen::Vector3d::UnitX()));
  }
  const FrameLocator locator = scan_of(poses, 0.1);
  ContourSurface surface(locator, {});
  surface.update(ball(locator, kCentre, kRadius));
  expect_sound(surface.mesh());
  const std::vector<double> places = evenly(-9.0, 9.0, 19);
  EXPECT_NEAR(*surface.volume_ml() / (stack_of_cones_mm3(places) / 1000.0), 1.0, 0.05);
}

TEST(ContourSurface, OfARotationalSweepHasNoVolume) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 12; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(kCentre);
    pose.rotate(Eigen::AngleAxisd(kPi * i / 11, Eigen::Vector3d::UnitX()));
    poses.push_back(pose);
  }
  const FrameLocator locator = scan_of(poses, 0.1);
  ContourSurface surface(locator, {});
  surface.update(ball(locator, kCentre, kRadius));
  EXPECT_FALSE(surface.volume_ml().has_value());
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
