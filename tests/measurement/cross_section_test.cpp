#include "measurement/cross_section.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "acquisition/recording.h"
#include "core/error.h"
#include "measurement/planimetry.h"
#include "tests/measurement/sections.h"

namespace fathom {
namespace {

using namespace sections;

Polygon ellipse(double x, double y, double a, double b, int points) {
  Polygon outline;
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points;
    outline.emplace_back(x + a * std::cos(angle), y + b * std::sin(angle));
  }
  return outline;
}

double polygon_area(double a, double b, int points) {
  return 0.5 * points * std::sin(2.0 * std::numbers::pi / points) * a * b;
}

Polygon box(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

Contour contour(int frame, Polygon points) {
  Contour contour;
  contour.frame = frame;
  contour.points_px = std::move(points);
  return contour;
}

// Anisotropic pixels, sheared a little, turned and shifted against the probe.
Calibration calibration() {
  Calibration calibration;
  Eigen::Matrix3d pixels;
  pixels << 0.11, 0.002, 0.0, 0.0, 0.14, 0.0, 0.0, 0.0, 0.125;
  calibration.probe_from_image.linear() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix() * pixels;
  calibration.probe_from_image.translation() = Eigen::Vector3d(-12.0, 5.0, 31.0);
  return calibration;
}

// A recording whose probe moves as `tracker_from_probe` says; frames without are marked as invalid.
MemoryRecording recording(const std::vector<std::optional<Eigen::Isometry3d>>& tracker_from_probe) {
  RecordingHeader header;
  header.transforms = {"ProbeToTracker"};
  for (const auto& pose : tracker_from_probe) {
    FrameHeader frame;
    frame.time_s = 2.0 + 0.04 * static_cast<double>(header.frames.size());
    frame.poses.emplace_back(Pose{pose.value_or(Eigen::Isometry3d::Identity()).matrix(), pose ? "OK" : "INVALID"});
    header.frames.push_back(frame);
  }
  return MemoryRecording("sweep.mha", header, {});
}

// Poses from a seed, any distance apart.
std::vector<std::optional<Eigen::Isometry3d>> random_poses(int count) {
  Random random(4);
  std::vector<std::optional<Eigen::Isometry3d>> poses;
  for (int i = 0; i < count; ++i) poses.emplace_back(random_motion(random, 0.3));
  return poses;
}

struct Fixture {
  explicit Fixture(std::vector<std::optional<Eigen::Isometry3d>> with_poses)
      : poses(std::move(with_poses)), sweep(recording(poses)), locator(sweep, calibration()) {}
  std::vector<std::optional<Eigen::Isometry3d>> poses;
  MemoryRecording sweep;
  FrameLocator locator;
};

TEST(EvenOddArea, IsThatOfTheShapeWhicheverWayItIsDrawn) {
  Polygon outline = ellipse(300.0, 200.0, 50.0, 30.0, 100);
  for (int round = 0; round < 2; ++round) {
    const PlaneArea area = even_odd_area({&outline});
    EXPECT_NEAR(area.area_px2, polygon_area(50.0, 30.0, 100), 1e-9);
    EXPECT_NEAR(area.centroid_px.x(), 300.0, 1e-10);
    EXPECT_NEAR(area.centroid_px.y(), 200.0, 1e-10);
    std::reverse(outline.begin(), outline.end());
  }
}

TEST(EvenOddArea, SubtractsHolesAndAddsIslandsInThem) {
  std::vector<Polygon> outlines = {box(12, 12, 2, 4), box(0, 0, 100, 50), box(200, 0, 10, 10), box(10, 10, 20, 20)};
  std::reverse(outlines[3].begin(), outlines[3].end());
  std::vector<const Polygon*> drawn;
  for (const Polygon& outline : outlines) drawn.push_back(&outline);
  const PlaneArea area = even_odd_area(drawn);
  EXPECT_NEAR(area.area_px2, 5000.0 - 400.0 + 8.0 + 100.0, 1e-9);
  EXPECT_NEAR(area.centroid_px.x(), (5000.0 * 50 - 400.0 * 20 + 8.0 * 13 + 100.0 * 205) / 4708.0, 1e-9);
  EXPECT_NEAR(area.centroid_px.y(), (5000.0 * 25 - 400.0 * 20 + 8.0 * 14 + 100.0 * 5) / 4708.0, 1e-9);
}

TEST(EvenOddArea, KeepsItsDigitsFarFromTheOrigin) {
  const Polygon outline = ellipse(9e5, -9e5, 3.0, 2.0, 50);
  const PlaneArea area = even_odd_area({&outline});
  EXPECT_NEAR(area.area_px2, polygon_area(3.0, 2.0, 50), 1e-8);
  EXPECT_NEAR(area.centroid_px.x(), 9e5, 1e-8);
}

TEST(EvenOddArea, OfALineIsNothingAndLiesOnIt) {
  const Polygon line = {{1.0, 1.0}, {3.0, 1.0}, {5.0, 1.0}};
  EXPECT_EQ(even_odd_area({&line}).area_px2, 0.0);
  EXPECT_EQ(even_odd_area({&line}).centroid_px, Eigen::Vector2d(3.0, 1.0));
}

TEST(CrossSections, HaveTheFramesOwnNormalAreaAndCentroidInSpace) {
  const Fixture scan(random_poses(6));
  Structure structure;
  structure.contours = {contour(4, ellipse(100, 80, 40, 20, 60)), contour(1, box(10, 20, 30, 40))};
  std::reverse(structure.contours[1].points_px.begin(), structure.contours[1].points_px.end());
  structure.extremities = {{2, {7.0, 8.0}, 0}};
  std::vector<std::string> warnings;
  const auto found = cross_sections(structure, scan.locator, &warnings);
  EXPECT_TRUE(warnings.empty());
  ASSERT_EQ(found.size(), 3u);
  const int frames[] = {1, 2, 4};
  const double areas_px2[] = {1200.0, 0.0, polygon_area(40, 20, 60)};
  const Eigen::Vector2d centroids_px[] = {{25.0, 40.0}, {7.0, 8.0}, {100.0, 80.0}};
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Affine3d reference_from_image =
        *scan.poses[static_cast<std::size_t>(frames[i])] * calibration().probe_from_image;
    const Eigen::Vector3d normal = reference_from_image.linear().col(0).cross(reference_from_image.linear().col(1));
    EXPECT_EQ(found[i].frame, frames[i]);
    EXPECT_TRUE(found[i].normal.isApprox(normal.normalized(), 1e-12));
    EXPECT_NEAR(found[i].vector_area_mm2.dot(found[i].normal), 0.11 * 0.14 * areas_px2[i], 1e-9);
    EXPECT_NEAR(found[i].vector_area_mm2.cross(found[i].normal).norm(), 0.0, 1e-9);
    const Eigen::Vector3d in_image(centroids_px[i].x(), centroids_px[i].y(), 0.0);
    EXPECT_NEAR((found[i].centroid_mm - reference_from_image * in_image).norm(), 0.0, 1e-9);
  }
}

TEST(CrossSections, DoNotDependOnTheWayOrOrderOfDrawing) {
  const Fixture scan(random_poses(3));
  Structure structure;
  for (int frame = 0; frame < 3; ++frame) {
    structure.contours.push_back(contour(frame, ellipse(100, 80, 40, 20, 60)));
    structure.contours.push_back(contour(frame, ellipse(110, 80, 10, 10, 30)));
    structure.contours.push_back(contour(frame, ellipse(200, 80, 12, 9, 30)));
  }
  const auto expected = cross_sections(structure, scan.locator, nullptr);
  std::reverse(structure.contours.begin(), structure.contours.end());
  for (Contour& drawn : structure.contours) std::reverse(drawn.points_px.begin(), drawn.points_px.end());
  const auto found = cross_sections(structure, scan.locator, nullptr);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].frame, expected[i].frame);
    EXPECT_TRUE(found[i].vector_area_mm2.isApprox(expected[i].vector_area_mm2, 1e-12));
    EXPECT_TRUE(found[i].centroid_mm.isApprox(expected[i].centroid_mm, 1e-12));
  }
}

TEST(CrossSections, LeaveOutFramesWithoutAPoseAndNameThem) {
  auto poses = random_poses(9);
  poses[2] = poses[5] = poses[6] = std::nullopt;
  const Fixture scan(poses);
  Structure structure;
  for (int frame : {0, 2, 3, 5, 6}) structure.contours.push_back(contour(frame, box(1, 1, 5, 5)));
  std::vector<std::string> warnings = {"before"};
  EXPECT_EQ(cross_sections(structure, scan.locator, &warnings).size(), 2u);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[1].rfind("frames 2, 5 and 6 left out", 0), 0u) << warnings[1];
  EXPECT_NO_THROW(cross_sections(structure, scan.locator, nullptr));
}

TEST(CrossSections, NameFramesMarkedAsAbsentBetweenOutlines) {
  const Fixture scan(random_poses(9));
  Structure structure;
  for (int frame : {2, 3, 6}) structure.contours.push_back(contour(frame, box(1, 1, 5, 5)));
  structure.absent = {{0, 0}, {1, 0}, {8, 0}};
  std::vector<std::string> warnings;
  EXPECT_EQ(cross_sections(structure, scan.locator, &warnings).size(), 3u);
  EXPECT_TRUE(warnings.empty()) << "the ends are known";
  structure.absent = {{0, 0}, {4, 0}, {5, 0}};
  EXPECT_EQ(cross_sections(structure, scan.locator, &warnings).size(), 3u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].rfind("frames 4 and 5 marked as absent", 0), 0u) << warnings[0];
}

TEST(CrossSections, SayWhenFramesLostAtTheEndsOfASweepLeaveAPartUnmeasured) {
  const auto warning = [](const std::vector<int>& lost) {
    auto poses = random_poses(9);
    for (const int frame : lost) poses[static_cast<std::size_t>(frame)] = std::nullopt;
    const Fixture scan(poses);
    Structure structure;
    for (int frame = 1; frame < 8; ++frame) structure.contours.push_back(contour(frame, box(1, 1, 5, 5)));
    std::vector<std::string> warnings;
    cross_sections(structure, scan.locator, &warnings);
    return warnings.empty() ? std::string() : warnings.back();
  };
  EXPECT_EQ(warning({0, 8}), "") << "nothing was outlined there";
  EXPECT_EQ(warning({4}).find("not measured"), std::string::npos);
  EXPECT_NE(warning({1, 2}).find("not measured before frame 3"), std::string::npos) << warning({1, 2});
  EXPECT_NE(warning({4, 7}).find("not measured beyond frame 6"), std::string::npos) << warning({4, 7});
  EXPECT_NE(warning({1, 7}).find("not measured before frame 2 nor beyond frame 6"), std::string::npos);
}

TEST(CrossSections, RefuseWhatHasNoDefiniteAreaAndSayWhere) {
  const Fixture scan(random_poses(5));
  const auto complaint = [&](const Structure& structure) -> std::string {
    try {
      cross_sections(structure, scan.locator, nullptr);
      return {};
    } catch (const Error& error) {
      return error.what();
    }
  };
  Structure good;
  good.name = "bladder";
  good.contours = {contour(3, box(0, 0, 10, 10)), contour(3, box(2, 2, 5, 5))};
  EXPECT_EQ(complaint(good), "");

  Structure structure = good;
  structure.contours[1].points_px = box(5, 5, 10, 2);
  EXPECT_EQ(complaint(structure).rfind("sweep.mha: structure bladder, frame 3: its outline crosses another", 0), 0u);
  structure.contours[1].points_px = {{2, 2}, {5, 5}, {5, 2}, {2, 5}};
  EXPECT_NE(complaint(structure).find("crosses itself near (3.5, 3.5)"), std::string::npos);
  structure.contours[1] = structure.contours[0];
  EXPECT_NE(complaint(structure).find("drawn twice"), std::string::npos);
  structure = good;
  structure.contours[0].closed = false;
  EXPECT_NE(complaint(structure).find("open"), std::string::npos);
  structure = good;
  structure.contours[0].points_px.resize(2);
  EXPECT_NE(complaint(structure), "");
  for (const int frame : {-1, 5}) {
    structure = good;
    structure.contours[0].frame = frame;
    EXPECT_NE(complaint(structure).find("frame " + std::to_string(frame)), std::string::npos);
  }
  structure = good;
  structure.contours[0].recording = 1;
  EXPECT_NE(complaint(structure).find("exam"), std::string::npos);
  structure = good;
  structure.extremities = {{3, {1.0, 1.0}, 0}};
  EXPECT_NE(complaint(structure).find("extremity"), std::string::npos);
  structure.extremities = {{2, {1.0, 1.0}, 0}, {2, {1.0, 1.0}, 0}};
  EXPECT_NE(complaint(structure), "");
}

TEST(CrossSections, OfAnOutlinedSphereMeasureItsVolume) {
  // Outlines of 200 points on a sphere of radius 12 mm, on frames that all lie differently: the whole way to a volume.
  const Eigen::Affine3d probe_from_image = calibration().probe_from_image;
  const Eigen::Matrix3d pixels = probe_from_image.linear();
  Random random(6);
  const Eigen::Isometry3d placed = random_motion(random, 1.0);
  const int count = 24;
  std::vector<std::optional<Eigen::Isometry3d>> poses;
  Structure structure;
  for (int i = 0; i < count; ++i) {
    const double z = 12.0 * (2.0 * i / (count - 1) - 1.0);
    // Tilted planes that follow each other: the image's own axes, then the pose that brings them there.
    const double tilt = 0.3 * z / 12.0;
    const Eigen::Isometry3d plane = Eigen::Translation3d(0.0, 0.0, z) *
                                    Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()) * Eigen::Isometry3d::Identity();
    Eigen::Matrix3d axes;
    axes.col(0) = pixels.col(0).normalized();
    axes.col(2) = pixels.col(0).cross(pixels.col(1)).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    Eigen::Isometry3d image_plane_in_probe = Eigen::Isometry3d::Identity();
    image_plane_in_probe.linear() = axes;
    image_plane_in_probe.translation() = probe_from_image * Eigen::Vector3d(150.0, 150.0, 0.0);
    poses.emplace_back(placed * plane * image_plane_in_probe.inverse());
    const double distance = z * std::cos(tilt);
    const double radius = std::sqrt(std::max(0.0, 144.0 - distance * distance));
    const Eigen::Vector2d centre(0.0, -z * std::sin(tilt));
    Polygon outline;
    for (int k = 0; k < 200; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / 200.0;
      const Eigen::Vector3d on_plane(centre.x() + radius * std::cos(angle), centre.y() + radius * std::sin(angle), 0.0);
      outline.push_back((probe_from_image.inverse() * (image_plane_in_probe * on_plane)).head<2>());
    }
    if (radius > 0.1) structure.contours.push_back(contour(i, outline));
  }
  const Fixture scan(poses);
  const auto found = cross_sections(structure, scan.locator, nullptr);
  EXPECT_GE(found.size(), 20u);
  const double volume = cubic_planimetry_ml(found);
  EXPECT_NEAR(volume, sphere_ml(12.0), 0.005 * sphere_ml(12.0));
}

}  // namespace
}  // namespace fathom
