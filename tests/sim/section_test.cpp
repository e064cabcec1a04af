#include "sim/section.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/random.h"
#include "sim/phantom.h"
#include "sim/scan_path.h"

namespace fathom {
namespace {

constexpr double kPi = std::numbers::pi;

double signed_area(const Polygon& polygon) {
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - polygon[0];
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - polygon[0];
    area += (a.x() * b.y() - a.y() * b.x()) / 2.0;
  }
  return area;
}

double area_px2(const std::vector<Polygon>& outlines) {
  double area = 0.0;
  for (const Polygon& outline : outlines) area += signed_area(outline);
  return std::abs(area);
}

bool even_odd_inside(const std::vector<Polygon>& outlines, const Eigen::Vector2d& p) {
  bool inside = false;
  for (const Polygon& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d& a = outline[i];
      const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      if (p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) inside = !inside;
    }
  }
  return inside;
}

/// Image pixels of 0.2 x 0.15 mm, pixel (100, 120) at a point of the plane.
Eigen::Affine3d plane_through(const Eigen::Vector3d& point, const Eigen::Matrix3d& turn) {
  Eigen::Affine3d plane = Eigen::Affine3d::Identity();
  plane.linear() = turn * Eigen::Vector3d(0.2, 0.15, 0.175).asDiagonal();
  plane.translation() = point - plane.linear() * Eigen::Vector3d(100.0, 120.0, 0.0);
  return plane;
}
constexpr double kPixelArea = 0.2 * 0.15;

Eigen::Matrix3d random_rotation(Random& random) {
  Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
  return turn.normalized().toRotationMatrix();
}

TEST(SectionOutlines, OfABallHaveTheAreaOfTheirDisc) {
  const auto ball = make_ellipsoid({10.0, 10.0, 10.0});
  Random random(1);
  for (const double height : {-9.999, -9.7, -3.0, 0.0, 5.0, 9.0, 9.99}) {
    const Eigen::Matrix3d turn = random_rotation(random);
    const auto outlines = section_outlines(*ball, plane_through(turn * Eigen::Vector3d(1.3, -0.4, height), turn));
    ASSERT_EQ(outlines.size(), 1u) << height;
    const double expected = kPi * (100.0 - height * height);
    EXPECT_NEAR(area_px2(outlines) * kPixelArea / expected, 1.0, 1e-4) << height;
    EXPECT_LT(outlines[0].size(), 1000u);
  }
}

TEST(SectionOutlines, BeyondTheSolidAreNone) {
  const auto ball = make_ellipsoid({10.0, 10.0, 10.0});
  EXPECT_TRUE(section_outlines(*ball, plane_through({0, 0, 10.0001}, Eigen::Matrix3d::Identity())).empty());
}

TEST(SectionOutlines, OfACubeKeepItsCorners) {
  const auto cube = make_box({10.0, 10.0, 10.0});
  const Eigen::Affine3d level = plane_through({0.7, 0.3, 2.0}, Eigen::Matrix3d::Identity());
  const auto square = section_outlines(*cube, level);
  ASSERT_EQ(square.size(), 1u);
  EXPECT_NEAR(area_px2(square) * kPixelArea, 400.0, 400.0 * 1e-5);
  for (const double x : {-10.0, 10.0}) {
    for (const double y : {-10.0, 10.0}) {
      const Eigen::Vector3d corner_px = level.inverse() * Eigen::Vector3d(x, y, 2.0);
      double nearest = 1e9;
      for (const auto& point : square[0]) nearest = std::min(nearest, (point - corner_px.head<2>()).norm());
      EXPECT_LT(nearest, 1e-3);
    }
  }
  // Across the diagonal the section is a regular hexagon with sides of 10 sqrt(2) mm.
  const Eigen::Matrix3d diagonal =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Ones()).toRotationMatrix();
  const double hexagon = 1.5 * std::sqrt(3.0) * 200.0;
  EXPECT_NEAR(area_px2(section_outlines(*cube, plane_through({0, 0, 0}, diagonal))) * kPixelArea, hexagon,
              hexagon * 1e-5);
}

TEST(SectionOutlines, OfAConeThroughItsAxisAreATriangle) {
  const auto cone = make_cone(10.0, 20.0);
  const Eigen::Matrix3d upright = Eigen::AngleAxisd(kPi / 2.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_NEAR(area_px2(section_outlines(*cone, plane_through({0, 0, 0}, upright))) * kPixelArea, 200.0, 200.0 * 1e-5);
}

TEST(SectionOutlines, OfABranchingSolidHaveSeveralParts) {
  const Phantom hat = make_phantom("hat");
  const double tips = hat.solid->contact(Eigen::Vector3d::UnitZ()).point_mm.z();
  EXPECT_EQ(section_outlines(*hat.solid, plane_through({0, 0, tips - 2.0}, Eigen::Matrix3d::Identity())).size(), 3u);
  EXPECT_EQ(section_outlines(*hat.solid, plane_through({0, 0, -3.0}, Eigen::Matrix3d::Identity())).size(), 1u);
}

TEST(SectionOutlines, OfABowlAreARingWithAHole) {
  const auto bowl = make_bent_ellipsoid({10.0, 9.0, 2.0}, {.x2 = 0.08, .y2 = 0.09});
  const auto outlines = section_outlines(*bowl, plane_through({0, 0, 4.0}, Eigen::Matrix3d::Identity()));
  ASSERT_EQ(outlines.size(), 2u);
  EXPECT_LT(signed_area(outlines[0]) * signed_area(outlines[1]), 0.0);
  // Counted on a fine grid instead.
  double counted = 0.0;
  constexpr double kStep = 0.02;
  for (double x = -12.0; x < 12.0; x += kStep) {
    for (double y = -12.0; y < 12.0; y += kStep) counted += bowl->distance_bound_mm({x, y, 4.0}) <= 0.0;
  }
  EXPECT_NEAR(area_px2(outlines) * kPixelArea / (counted * kStep * kStep), 1.0, 1e-3);
}

class EveryPhantomSection : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Phantoms, EveryPhantomSection, testing::ValuesIn(object_names()), [](const auto& instance) {
  std::string name = instance.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(EveryPhantomSection, ImageIsWhiteExactlyWhereThePointIsInside) {
  const Phantom phantom = make_phantom(GetParam());
  const ScanPath path = make_scan_path(phantom, "free");
  for (const double u : {0.13, 0.52, 0.9}) {
    const Eigen::Affine3d plane = path.phantom_from_image(path.at(u), phantom.pixel_mm);
    const cv::Mat image = section_image(*phantom.solid, plane, phantom.image_size);
    int white = 0;
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const double bound = phantom.solid->distance_bound_mm(plane * Eigen::Vector3d(x, y, 0.0));
        if (std::abs(bound) < 1e-9) continue;  // rounding decides
        ASSERT_EQ(image.at<std::uint8_t>(y, x), bound <= 0.0 ? 255 : 0) << x << "," << y;
        white += bound <= 0.0;
      }
    }
    EXPECT_GT(white, 20);
  }
}

TEST_P(EveryPhantomSection, OutlinesFilledGiveTheImage) {
  const Phantom phantom = make_phantom(GetParam());
  for (const std::string& pattern : single_sweep_patterns()) {
    const ScanPath path = make_scan_path(phantom, pattern);
    for (const double u : {0.06, 0.71}) {
      const Eigen::Affine3d plane = path.phantom_from_image(path.at(u), phantom.pixel_mm);
      const cv::Mat image = section_image(*phantom.solid, plane, phantom.image_size);
      const auto outlines = section_outlines(*phantom.solid, plane);
      ASSERT_FALSE(outlines.empty());
      for (int y = 0; y < image.rows; y += 4) {
        for (int x = 0; x < image.cols; x += 4) {
          if (even_odd_inside(outlines, Eigen::Vector2d(x, y)) == (image.at<std::uint8_t>(y, x) == 255)) continue;
          const double off_mm = phantom.solid->distance_bound_mm(plane * Eigen::Vector3d(x, y, 0.0));
          ASSERT_LT(std::abs(off_mm), 0.02 * phantom.pixel_mm.minCoeff()) << pattern << " " << u;
        }
      }
    }
  }
}

TEST_P(EveryPhantomSection, OutlinePointsLieOnTheSurface) {
  const Phantom phantom = make_phantom(GetParam());
  const ScanPath path = make_scan_path(phantom, "oblique");
  for (const double u : {0.2, 0.5}) {
    const Eigen::Affine3d plane = path.phantom_from_image(path.at(u), phantom.pixel_mm);
    for (const Polygon& outline : section_outlines(*phantom.solid, plane)) {
      for (const Eigen::Vector2d& point : outline) {
        ASSERT_NEAR(phantom.solid->distance_bound_mm(plane * Eigen::Vector3d(point.x(), point.y(), 0.0)), 0.0, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace fathom
