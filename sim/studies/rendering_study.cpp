#include "sim/studies/rendering_study.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "core/random.h"
#include "sim/studies/formula_surfaces.h"
#include "surface/shaded_picture.h"
#include "surface/vertex_normals.h"

namespace fathom {

namespace {

constexpr int kPicture_px = 300;
constexpr double kScale_px = 120.0;  // of the sphere's radius
constexpr std::uint64_t kSeed = 34;

Mesh sphere(const MesherOptions& mesher, double spacing, ShadingNormals normals) {
  Mesh mesh = formula_mesh(formula_surfaces().front(), mesher, spacing);
  if (normals == ShadingNormals::kTriangles) {
    mesh.normals = vertex_normals(mesh);
  } else {
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) mesh.normals[i] = mesh.vertices[i].normalized();
  }
  return mesh;
}

}  // namespace

RenderingVariation rendering_variation(const MesherOptions& mesher, double spacing, ShadingNormals normals, int views) {
  const Mesh mesh = sphere(mesher, spacing, normals);
  const ColoredMesh painted{&mesh, cv::Scalar::all(255.0)};
  Random random(kSeed);
  cv::Mat sum = cv::Mat::zeros(kPicture_px, kPicture_px, CV_64F);
  cv::Mat squares = sum.clone();
  cv::Mat covered = sum.clone();
  for (int view = 0; view < views; ++view) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
    OrthographicView camera;
    camera.direction = turn * -Eigen::Vector3d::UnitZ();
    camera.up = turn * Eigen::Vector3d::UnitY();
    camera.width_px = kPicture_px;
    camera.height_px = kPicture_px;
    camera.px_per_mm = kScale_px;
    camera.centre_mm = Eigen::Vector3d::Zero();
    Shading shading;
    shading.background = cv::Scalar::all(0.0);
    const ShadedPicture shaded = shaded_picture(std::span(&painted, 1), camera, shading);
    for (int y = 0; y < kPicture_px; ++y) {
      for (int x = 0; x < kPicture_px; ++x) {
        const double grey = shaded.picture.at<cv::Vec3b>(y, x)[0];
        sum.at<double>(y, x) += grey;
        squares.at<double>(y, x) += grey * grey;
        covered.at<double>(y, x) += shaded.covered.at<unsigned char>(y, x) > 0 ? 1.0 : 0.0;
      }
    }
  }
  RenderingVariation result;
  result.triangles = mesh.triangles.size();
  int inner = 0;
  int border = 0;
  for (int y = 0; y < kPicture_px; ++y) {
    for (int x = 0; x < kPicture_px; ++x) {
      const double mean = sum.at<double>(y, x) / views;
      const double deviation = std::sqrt(std::max(0.0, squares.at<double>(y, x) / views - mean * mean));
      result.mean_image += deviation;
      const double times = covered.at<double>(y, x);
      if (times == views) {
        ++inner;
        result.mean_sphere += deviation;
        result.largest_sphere = std::max(result.largest_sphere, deviation);
      } else if (times > 0.0) {
        ++border;
      }
    }
  }
  const double pixels = kPicture_px * kPicture_px;
  result.mean_image /= pixels;
  result.mean_sphere /= std::max(1, inner);
  result.border_percent = 100.0 * border / pixels;
  return result;
}

}  // namespace fathom
