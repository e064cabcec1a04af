#include "surface/shaded_picture.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "core/error.h"
#include "surface/vertex_normals.h"

namespace fathom {

namespace {

constexpr int kMostPixels = 16384;    // along a side
constexpr int kMostSamples = 8;       // along a side of a pixel
constexpr double kMostDrawn = 2.5e8;  // samples in all: beyond, the picture would take more than 5 GB
constexpr double kMargin = 0.04;      // of the picture's smaller side, free around what is fitted
constexpr double kAlong = 1e-9;       // sine of an angle below which two directions count as the same

/// Columns: to the right, up, towards the viewer.
Eigen::Matrix3d viewer_axes(const OrthographicView& view) {
  Eigen::Matrix3d axes;
  axes.col(2) = -view.direction.stableNormalized();
  axes.col(0) = view.up.stableNormalized().cross(axes.col(2)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Eigen::Vector3d bgr(const cv::Scalar& color) { return {color[0], color[1], color[2]}; }

bool is_color(const cv::Scalar& color) { return ((bgr(color).array() >= 0.0) && (bgr(color).array() <= 255.0)).all(); }

/// Where the picture lies before the viewer, on a raster of samples.
struct Camera {
  Eigen::Matrix3d axes;
  Eigen::Vector3d centre_mm;
  double px_per_mm = 1.0;
  Eigen::Vector2d middle_px;

  /// x to the right and y down in pixels, and towards the viewer in millimetres.
  Eigen::Vector3d operator()(const Eigen::Vector3d& point_mm) const {
    const Eigen::Vector3d seen = axes.transpose() * (point_mm - centre_mm);
    return {middle_px.x() + px_per_mm * seen.x(), middle_px.y() - px_per_mm * seen.y(), seen.z()};
  }
};

Camera camera(std::span<const ColoredMesh> meshes, const OrthographicView& view) {
  Camera camera;
  camera.axes = viewer_axes(view);
  camera.middle_px = {0.5 * (view.width_px - 1), 0.5 * (view.height_px - 1)};
  // Of the vertices that are drawn, in the viewer's axes.
  Eigen::AlignedBox3d box;
  for (const ColoredMesh& colored : meshes) {
    for (const Mesh::Triangle& triangle : colored.mesh->triangles) {
      for (const std::int32_t vertex : triangle) {
        box.extend(camera.axes.transpose() * colored.mesh->vertices[static_cast<std::size_t>(vertex)]);
      }
    }
  }
  if (box.isEmpty() && !(view.px_per_mm && view.centre_mm)) {
    throw Error("there is no surface to fit the view to; give a scale and a centre, or a surface with triangles");
  }
  camera.centre_mm = view.centre_mm ? *view.centre_mm : Eigen::Vector3d(camera.axes * box.center());
  if (view.px_per_mm) {
    camera.px_per_mm = *view.px_per_mm;
    return camera;
  }
  const Eigen::Vector3d centre = camera.axes.transpose() * camera.centre_mm;
  const Eigen::Vector3d half = (box.max() - centre).cwiseMax(centre - box.min());
  const double free_px = 2.0 * kMargin * std::min(view.width_px, view.height_px);
  const double fit = 0.5 * std::min((view.width_px - free_px) / half.x(), (view.height_px - free_px) / half.y());
  if (!(fit > 0.0 && std::isfinite(fit)))
    throw Error("the surface has no size as it is seen; give a scale for the view");
  camera.px_per_mm = fit;
  return camera;
}

/// Light on both sides of a vertex: what it reflects of the mesh's colour, and in white.
struct Light {
  double own = 0.0;
  double white = 0.0;
};

Light light(const Eigen::Vector3d& normal, const Eigen::Vector3d& towards_light, const Shading& shading) {
  Light light;
  light.own = shading.ambient;
  const double facing = normal.dot(towards_light);
  if (facing <= 0.0) return light;
  light.own += shading.diffuse * facing;
  // The mirrored ray's share towards the viewer, who is along z.
  const double mirrored = 2.0 * facing * normal.z() - towards_light.z();
  if (mirrored > 0.0) light.white = shading.specular * std::pow(mirrored, shading.shininess);
  return light;
}

struct SeenVertex {
  Eigen::Vector3d place;  // of the raster; z in millimetres towards the viewer
  Eigen::Vector3d front;  // colour, blue, green, red, of the side that faces the viewer along the normal
  Eigen::Vector3d back;
};

std::vector<SeenVertex> seen_vertices(const ColoredMesh& colored, const Camera& camera, const Shading& shading) {
  const Mesh& mesh = *colored.mesh;
  const std::vector<Eigen::Vector3d> own = mesh.normals.empty() ? vertex_normals(mesh) : std::vector<Eigen::Vector3d>();
  const std::vector<Eigen::Vector3d>& normals = mesh.normals.empty() ? own : mesh.normals;
  const Eigen::Vector3d towards_light = shading.light.stableNormalized();
  const auto painted = [&](const Eigen::Vector3d& normal) -> Eigen::Vector3d {
    const Light lit = light(normal, towards_light, shading);
    return lit.own * bgr(colored.color) + Eigen::Vector3d::Constant(255.0 * lit.white);
  };
  std::vector<SeenVertex> seen(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Vector3d normal = camera.axes.transpose() * normals[v];
    seen[v] = {camera(mesh.vertices[v]), painted(normal), painted(-normal)};
  }
  return seen;
}

// Twice the signed area of a, b, p. Computed the same way from either end, so that a sample near a side belongs to at
// least one of the two triangles that meet there, and no background shines through.
double edge_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double x, double y) {
  const bool swap = a.x() != b.x() ? a.x() > b.x() : a.y() > b.y();
  const Eigen::Vector3d& from = swap ? b : a;
  const Eigen::Vector3d& to = swap ? a : b;
  const double area = (to.x() - from.x()) * (y - from.y()) - (to.y() - from.y()) * (x - from.x());
  return swap ? -area : area;
}

/// The samples of a picture: colours, and how near to the viewer they are; -infinity where there is nothing.
struct Raster {
  cv::Mat_<cv::Vec3f> colors;
  cv::Mat_<double> nearness;
};

// The samples from `low` to `high` that there are, as a first and a last one.
std::array<int, 2> samples_between(double low, double high, int count) {
  return {static_cast<int>(std::ceil(std::clamp(low, 0.0, static_cast<double>(count)))),
          static_cast<int>(std::floor(std::clamp(high, -1.0, count - 1.0)))};
}

void draw(const std::array<const SeenVertex*, 3>& corners, Raster& raster) {
  const Eigen::Vector3d& a = corners[0]->place;
  const Eigen::Vector3d& b = corners[1]->place;
  const Eigen::Vector3d& c = corners[2]->place;
  const double area = edge_area(a, b, c.x(), c.y());
  if (area == 0.0 || !std::isfinite(area)) return;  // edge-on, or far outside of what can be drawn
  // Rows run down, so that a triangle that is seen counter-clockwise has a negative area here.
  const bool front = area < 0.0;
  const auto [left, right] =
      samples_between(std::min({a.x(), b.x(), c.x()}), std::max({a.x(), b.x(), c.x()}), raster.colors.cols);
  const auto [top, bottom] =
      samples_between(std::min({a.y(), b.y(), c.y()}), std::max({a.y(), b.y(), c.y()}), raster.colors.rows);
  const double turn = front ? -1.0 : 1.0;
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const double of_a = turn * edge_area(b, c, x, y);
      const double of_b = turn * edge_area(c, a, x, y);
      const double of_c = turn * edge_area(a, b, x, y);
      if (of_a < 0.0 || of_b < 0.0 || of_c < 0.0) continue;
      const Eigen::Vector3d weights = Eigen::Vector3d(of_a, of_b, of_c) / (of_a + of_b + of_c);
      const double near = weights.dot(Eigen::Vector3d(a.z(), b.z(), c.z()));
      if (!(near > raster.nearness(y, x))) continue;
      raster.nearness(y, x) = near;
      Eigen::Vector3d color = Eigen::Vector3d::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        color += weights[static_cast<Eigen::Index>(k)] * (front ? corners[k]->front : corners[k]->back);
      }
      raster.colors(y, x) = {static_cast<float>(color[0]), static_cast<float>(color[1]), static_cast<float>(color[2])};
    }
  }
}

// Pixels as the mean of their samples.
void resolve(const Raster& raster, int samples, ShadedPicture& shaded) {
  const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))); };
  const double share = 1.0 / (samples * samples);
  for (int y = 0; y < shaded.picture.rows; ++y) {
    for (int x = 0; x < shaded.picture.cols; ++x) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      int covered = 0;
      for (int j = y * samples; j < (y + 1) * samples; ++j) {
        for (int i = x * samples; i < (x + 1) * samples; ++i) {
          const cv::Vec3f& color = raster.colors(j, i);
          sum += Eigen::Vector3d(color[0], color[1], color[2]);
          if (raster.nearness(j, i) > -std::numeric_limits<double>::infinity()) ++covered;
        }
      }
      sum *= share;
      shaded.picture.at<cv::Vec3b>(y, x) = {byte(sum[0]), byte(sum[1]), byte(sum[2])};
      shaded.covered.at<std::uint8_t>(y, x) = byte(255.0 * share * covered);
    }
  }
}

}  // namespace

void OrthographicView::check() const {
  if (!direction.allFinite() || direction.isZero(0.0))
    throw Error("the view has no direction; give one that is finite");
  if (!up.allFinite() || up.isZero(0.0) || up.stableNormalized().cross(direction.stableNormalized()).norm() < kAlong) {
    throw Error("what is up in the view must be a direction across the one it looks along; choose another");
  }
  if (width_px < 1 || height_px < 1 || width_px > kMostPixels || height_px > kMostPixels) {
    throw Error("a picture of " + std::to_string(width_px) + " by " + std::to_string(height_px) +
                " pixels cannot be drawn; choose sides from 1 to " + std::to_string(kMostPixels));
  }
  if (px_per_mm && !(*px_per_mm > 0.0 && std::isfinite(*px_per_mm))) {
    throw Error("the scale of the view must be above 0 pixels per mm and finite");
  }
  if (centre_mm && !centre_mm->allFinite()) throw Error("the centre of the view is not finite");
}

void Shading::check() const {
  constexpr double kRounding = 1e-9;  // of three shares that add up to 1
  if (!(ambient >= 0.0 && diffuse >= 0.0 && specular >= 0.0 && ambient + diffuse + specular <= 1.0 + kRounding)) {
    throw Error("the ambient, diffuse and specular shares of light must not be negative nor above 1 together");
  }
  if (!(shininess >= 1.0 && std::isfinite(shininess))) throw Error("the shininess must be at least 1 and finite");
  if (!light.allFinite() || light.isZero(0.0)) throw Error("the light has no direction; give one that is finite");
  if (!is_color(background)) throw Error("the background's colour must be made of values from 0 to 255");
  if (samples_per_px < 1 || samples_per_px > kMostSamples) {
    throw Error("a picture takes from 1 to " + std::to_string(kMostSamples) + " samples along a pixel's side, not " +
                std::to_string(samples_per_px));
  }
}

ShadedPicture shaded_picture(std::span<const ColoredMesh> meshes, const OrthographicView& view,
                             const Shading& shading) {
  view.check();
  shading.check();
  for (const ColoredMesh& colored : meshes) {
    assert(colored.mesh != nullptr);
    if (!is_color(colored.color)) throw Error("a surface's colour must be made of values from 0 to 255");
  }
  const int samples = shading.samples_per_px;
  if (static_cast<double>(view.width_px) * view.height_px * samples * samples > kMostDrawn) {
    throw Error("a picture of " + std::to_string(view.width_px) + " by " + std::to_string(view.height_px) +
                " pixels with " + std::to_string(samples * samples) +
                " samples each takes too much memory; make it smaller or take fewer samples");
  }
  const Camera of_picture = camera(meshes, view);
  // Samples lie evenly in their pixels, about the pixels' centres.
  Camera of_samples = of_picture;
  of_samples.px_per_mm *= samples;
  of_samples.middle_px = {0.5 * (view.width_px * samples - 1), 0.5 * (view.height_px * samples - 1)};

  Raster raster;
  raster.colors.create(view.height_px * samples, view.width_px * samples);
  raster.colors.setTo(shading.background);
  raster.nearness.create(raster.colors.size());
  raster.nearness.setTo(-std::numeric_limits<double>::infinity());
  for (const ColoredMesh& colored : meshes) {
    const std::vector<SeenVertex> vertices = seen_vertices(colored, of_samples, shading);
    const auto at = [&](std::int32_t vertex) { return &vertices[static_cast<std::size_t>(vertex)]; };
    for (const auto& [a, b, c] : colored.mesh->triangles) draw({at(a), at(b), at(c)}, raster);
  }

  ShadedPicture shaded;
  shaded.px_per_mm = of_picture.px_per_mm;
  shaded.px_from_mm.col(3) = of_picture(Eigen::Vector3d::Zero()).head<2>();
  shaded.px_from_mm.row(0).head<3>() = of_picture.px_per_mm * of_picture.axes.col(0).transpose();
  shaded.px_from_mm.row(1).head<3>() = -of_picture.px_per_mm * of_picture.axes.col(1).transpose();
  shaded.picture.create(view.height_px, view.width_px, CV_8UC3);
  shaded.covered.create(view.height_px, view.width_px, CV_8UC1);
  resolve(raster, samples, shaded);
  return shaded;
}

}  // namespace fathom
