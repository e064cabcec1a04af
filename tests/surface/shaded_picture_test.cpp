#include "surface/shaded_picture.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "surface/vertex_normals.h"
#include "tests/surface/shapes.h"

namespace fathom {
namespace {

using namespace shapes;
constexpr double kPi = std::numbers::pi;
const cv::Scalar kRed(30.0, 30.0, 200.0);
const cv::Scalar kGreen(30.0, 200.0, 30.0);

// With the normals of the true sphere.
Mesh smooth_sphere(double radius, int divisions) {
  Mesh mesh = icosphere(radius, divisions);
  for (const Eigen::Vector3d& vertex : mesh.vertices) mesh.normals.push_back(vertex / radius);
  return mesh;
}

OrthographicView view_of(int side_px, double px_per_mm) {
  OrthographicView view;
  view.width_px = side_px;
  view.height_px = side_px;
  view.px_per_mm = px_per_mm;
  view.centre_mm = Eigen::Vector3d::Zero();
  return view;
}

Eigen::Vector2d place(const ShadedPicture& shaded, const Eigen::Vector3d& point_mm) {
  return shaded.px_from_mm * point_mm.homogeneous();
}

cv::Mat grey_of(const ShadedPicture& shaded) {
  cv::Mat green;
  cv::extractChannel(shaded.picture, green, 1);
  return green;
}

bool same(const cv::Mat& a, const cv::Mat& b) { return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0.0; }

TEST(ShadedPicture, OfASphereHasTheSilhouetteOfADisc) {
  const Mesh mesh = smooth_sphere(10.0, 5);
  const ColoredMesh colored{&mesh, kRed};
  const ShadedPicture shaded = shaded_picture({&colored, 1}, view_of(501, 20.0));
  EXPECT_EQ(shaded.picture.type(), CV_8UC3);
  EXPECT_EQ(shaded.covered.type(), CV_8UC1);
  const double area_px = kPi * 200.0 * 200.0;
  EXPECT_NEAR(cv::countNonZero(shaded.covered), area_px, 2e-3 * area_px);
  EXPECT_EQ(cv::countNonZero(shaded.covered == 255), cv::countNonZero(shaded.covered));
  const cv::Rect box = cv::boundingRect(shaded.covered);
  EXPECT_NEAR(box.x + 0.5 * (box.width - 1), 250.0, 0.51);
  EXPECT_NEAR(box.y + 0.5 * (box.height - 1), 250.0, 0.51);
  EXPECT_NEAR(box.width, 400, 1);
  // Outside is the background and nothing else.
  const cv::Scalar background = Shading().background;
  const cv::Vec3b corner = shaded.picture.at<cv::Vec3b>(0, 0);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(corner[k], static_cast<int>(background[k]));
}

TEST(ShadedPicture, SidesThatTrianglesShareLeaveNoGap) {
  // Pieces in one plane whose sides pass through samples, and others; turned to odd angles.
  Random random(8);
  const Mesh mesh = smooth_sphere(10.0, 4);
  for (int round = 0; round < 10; ++round) {
    const Mesh turned = round == 0 ? mesh : moved(mesh, random_motion(random, 0.0));
    const ColoredMesh colored{&turned, kRed};
    const cv::Mat covered = shaded_picture({&colored, 1}, view_of(301, 14.0)).covered;
    for (int y = 0; y < covered.rows; ++y) {  // a disc: in each row one run
      int runs = 0;
      for (int x = 1; x < covered.cols; ++x) {
        runs += covered.at<std::uint8_t>(y, x) != 0 && covered.at<std::uint8_t>(y, x - 1) == 0;
      }
      EXPECT_LE(runs, 1) << y;
    }
  }
}

TEST(ShadedPicture, IsBrightestWhereTheSphereFacesTheLight) {
  const Mesh mesh = smooth_sphere(10.0, 6);
  const ColoredMesh colored{&mesh, cv::Scalar::all(255.0)};
  Shading shading;
  shading.ambient = 0.2;
  shading.diffuse = 0.8;
  shading.specular = 0.0;
  shading.light = {0.6, 0.48, 0.64};
  // Seen from the side of x, with z up: right is y.
  OrthographicView view = view_of(401, 18.0);
  view.direction = {-2.0, 0.0, 0.0};
  view.up = {-0.5, 0.0, 3.0};
  const ShadedPicture shaded = shaded_picture({&colored, 1}, view, shading);
  const cv::Mat grey = grey_of(shaded);
  // Lambert: everywhere.
  double worst = 0.0;
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      const double right = (x - 200) / 180.0;
      const double up = (200 - y) / 180.0;
      if (std::hypot(right, up) > 0.97) continue;
      const Eigen::Vector3d normal(right, up, std::sqrt(1.0 - right * right - up * up));
      const double expected = 255.0 * (0.2 + 0.8 * std::max(0.0, normal.dot(shading.light)));
      worst = std::max(worst, std::abs(grey.at<std::uint8_t>(y, x) - expected));
    }
  }
  EXPECT_LT(worst, 2.0);
  double most = 0.0;
  cv::minMaxLoc(grey, nullptr, &most);
  EXPECT_NEAR(most, 255.0, 1.0);
  const cv::Moments spot = cv::moments(grey >= 254, true);
  EXPECT_NEAR(spot.m10 / spot.m00, 200.0 + 180.0 * 0.6, 2.0);
  EXPECT_NEAR(spot.m01 / spot.m00, 200.0 - 180.0 * 0.48, 2.0);
  // The same place in millimetres.
  const Eigen::Vector2d lit = place(shaded, {6.4, 6.0, 4.8});
  EXPECT_NEAR(lit.x(), 200.0 + 180.0 * 0.6, 1e-9);
  EXPECT_NEAR(lit.y(), 200.0 - 180.0 * 0.48, 1e-9);
}

TEST(ShadedPicture, GleamsHalfWayBetweenLightAndViewer) {
  const Mesh mesh = smooth_sphere(10.0, 6);
  const ColoredMesh colored{&mesh, kRed};
  Shading shading;
  shading.ambient = 0.0;
  shading.diffuse = 0.0;
  shading.specular = 1.0;
  shading.shininess = 40.0;
  shading.light = {1.0, 0.0, 1.0};
  const ShadedPicture shaded = shaded_picture({&colored, 1}, view_of(401, 18.0), shading);
  const cv::Moments spot = cv::moments((grey_of(shaded) >= 200) & (shaded.covered > 0), true);
  EXPECT_NEAR(spot.m10 / spot.m00, 200.0 + 180.0 * std::sin(kPi / 8.0), 2.0);
  EXPECT_NEAR(spot.m01 / spot.m00, 200.0, 1.0);
  // White, whatever the mesh's colour.
  const cv::Vec3b pixel = shaded.picture.at<cv::Vec3b>(200, 200 + static_cast<int>(180.0 * std::sin(kPi / 8.0)));
  EXPECT_GT(pixel[0], 250);
  EXPECT_EQ(pixel[0], pixel[2]);
}

TEST(ShadedPicture, WhatIsNearerHidesWhatIsFarther) {
  const Mesh near = shifted(smooth_sphere(4.0, 4), {1.0, 0.0, 20.0});
  const Mesh far = smooth_sphere(8.0, 4);
  const std::vector<ColoredMesh> near_first = {{&near, kRed}, {&far, kGreen}};
  const std::vector<ColoredMesh> far_first = {{&far, kGreen}, {&near, kRed}};
  const OrthographicView view = view_of(200, 10.0);
  const ShadedPicture shaded = shaded_picture(near_first, view);
  EXPECT_TRUE(same(shaded.picture, shaded_picture(far_first, view).picture));
  const auto is_red = [](const ShadedPicture& picture, int x, int y) {
    const cv::Vec3b pixel = picture.picture.at<cv::Vec3b>(y, x);
    return pixel[2] > pixel[1];
  };
  EXPECT_TRUE(is_red(shaded, 110, 100));
  EXPECT_TRUE(is_red(shaded, 80, 100));
  EXPECT_FALSE(is_red(shaded, 60, 100));
  OrthographicView behind = view;
  behind.direction = Eigen::Vector3d::UnitZ();
  EXPECT_FALSE(is_red(shaded_picture(near_first, behind), 90, 100));
  // Spheres that cross part on the plane between them.
  const Mesh left = shifted(smooth_sphere(6.0, 5), {-4.0, 0.0, 0.0});
  const Mesh right = shifted(smooth_sphere(6.0, 5), {4.0, 0.0, 0.0});
  const std::vector<ColoredMesh> crossing = {{&left, kRed}, {&right, kGreen}};
  const ShadedPicture both = shaded_picture(crossing, view);
  for (int y = 70; y < 130; ++y) {
    EXPECT_TRUE(is_red(both, 98, y));
    EXPECT_FALSE(is_red(both, 101, y));
  }
}

TEST(ShadedPicture, FitsWhatItShows) {
  const Mesh mesh = shifted(box({0, 0, 0}, {40, 10, 5}), {300.0, -200.0, 100.0});
  const ColoredMesh colored{&mesh, kRed};
  OrthographicView view;
  view.width_px = 500;
  view.height_px = 300;
  const ShadedPicture shaded = shaded_picture({&colored, 1}, view);
  EXPECT_NEAR(shaded.px_per_mm, (500.0 - 24.0) / 40.0, 1e-9);
  const cv::Rect box = cv::boundingRect(shaded.covered);
  EXPECT_NEAR(box.x, 12, 1);
  EXPECT_NEAR(box.width, 476, 1);
  EXPECT_NEAR(box.height, 119, 1);
  EXPECT_NEAR(box.y, 90, 1);
  EXPECT_EQ(cv::countNonZero(shaded.covered), box.area());
}

TEST(ShadedPicture, SamplesSmoothItsEdgesAndMoveNothing) {
  const Mesh mesh = smooth_sphere(10.0, 5);
  const ColoredMesh colored{&mesh, kRed};
  const OrthographicView view = view_of(101, 4.0);
  Shading smooth;
  smooth.samples_per_px = 4;
  const ShadedPicture plain = shaded_picture({&colored, 1}, view);
  const ShadedPicture fine = shaded_picture({&colored, 1}, view, smooth);
  const double area_px = kPi * 40.0 * 40.0;
  EXPECT_NEAR(cv::sum(fine.covered)[0] / 255.0, area_px, 3e-3 * area_px);
  EXPECT_GT(cv::countNonZero((fine.covered > 0) & (fine.covered < 255)), 100);
  const cv::Moments moments = cv::moments(fine.covered);
  EXPECT_NEAR(moments.m10 / moments.m00, 50.0, 0.01);
  EXPECT_NEAR(moments.m01 / moments.m00, 50.0, 0.01);
  // Well inside the two agree to what the colour changes within a pixel.
  cv::Mat inside;
  cv::erode(fine.covered == 255, inside, cv::Mat::ones(9, 9, CV_8U));
  EXPECT_LE(cv::norm(plain.picture, fine.picture, cv::NORM_INF, inside), 3.0);
  EXPECT_EQ(plain.px_from_mm, fine.px_from_mm);
  EXPECT_TRUE(same(fine.picture, shaded_picture({&colored, 1}, view, smooth).picture));
}

TEST(ShadedPicture, LightsWhatIsSeenFromBehindAsItsOtherSide) {
  const Mesh front = smooth_sphere(10.0, 4);
  Mesh back = turned_inside_out(front);
  for (Eigen::Vector3d& normal : back.normals) normal = -normal;
  const ColoredMesh outward{&front, kRed};
  const ColoredMesh inward{&back, kRed};
  EXPECT_TRUE(same(shaded_picture({&outward, 1}, view_of(200, 9.0)).picture,
                   shaded_picture({&inward, 1}, view_of(200, 9.0)).picture));
}

TEST(ShadedPicture, UsesAreaWeightedNormalsWhereThereAreNone) {
  Mesh mesh = icosphere(10.0, 3);
  const ColoredMesh colored{&mesh, kRed};
  const cv::Mat without = shaded_picture({&colored, 1}, view_of(200, 9.0)).picture;
  mesh.normals = vertex_normals(mesh);
  EXPECT_TRUE(same(without, shaded_picture({&colored, 1}, view_of(200, 9.0)).picture));
  mesh.normals.assign(mesh.vertices.size(), Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(same(without, shaded_picture({&colored, 1}, view_of(200, 9.0)).picture));
}

TEST(ShadedPicture, RefusesSettingsThatMakeNoSense) {
  const Mesh mesh = tetrahedron();
  const ColoredMesh colored{&mesh, kRed};
  const std::span<const ColoredMesh> meshes(&colored, 1);
  OrthographicView view;
  view.up = 3.0 * view.direction;
  EXPECT_THROW(shaded_picture(meshes, view), Error);
  view = {};
  view.direction.setZero();
  EXPECT_THROW(shaded_picture(meshes, view), Error);
  view = {};
  view.width_px = 0;
  EXPECT_THROW(shaded_picture(meshes, view), Error);
  view = {};
  view.px_per_mm = 0.0;
  EXPECT_THROW(shaded_picture(meshes, view), Error);
  EXPECT_THROW(shaded_picture({}, {}), Error);
  Shading shading;
  shading.diffuse = 0.9;
  EXPECT_THROW(shaded_picture(meshes, {}, shading), Error);
  shading = {};
  shading.samples_per_px = 9;
  EXPECT_THROW(shaded_picture(meshes, {}, shading), Error);
  shading = {};
  shading.light.setZero();
  EXPECT_THROW(shaded_picture(meshes, {}, shading), Error);
  const ColoredMesh glaring{&mesh, cv::Scalar(0.0, 0.0, 256.0)};
  EXPECT_THROW(shaded_picture({&glaring, 1}, {}), Error);
  // An empty picture is no fault where the view is given.
  EXPECT_EQ(cv::countNonZero(shaded_picture({}, view_of(20, 1.0)).covered), 0);
}

}  // namespace
}  // namespace fathom
