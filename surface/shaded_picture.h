#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "surface/mesh.h"

namespace fathom {

/// A mesh and the colour that it is painted in, blue, green, red from 0 to 255.
struct ColoredMesh {
  const Mesh* mesh = nullptr;
  cv::Scalar color = cv::Scalar(255.0, 255.0, 255.0);
};

/// A camera that looks along parallel rays.
struct OrthographicView {
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< the way it looks; of any length
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();          ///< what is up in the picture; not along `direction`
  int width_px = 640;
  int height_px = 480;
  std::optional<double> px_per_mm;           ///< by default, so that all meshes fit with a margin of 4 %
  std::optional<Eigen::Vector3d> centre_mm;  ///< is shown in the middle of the picture; by default, that of the meshes

  /// Throws Error when the view shows nothing: a direction that is zero, a size that is not in 1 to 16384, ...
  void check() const;
};

/// Phong's model, evaluated at the vertices. The three shares add up to at most 1, so that nothing is overexposed.
struct Shading {
  double ambient = 0.15;
  double diffuse = 0.60;
  double specular = 0.25;   ///< in white
  double shininess = 30.0;  ///< exponent of the specular part
  /// Where the light comes from, as seen by the viewer: x to the right, y up, z towards the viewer.
  Eigen::Vector3d light = Eigen::Vector3d(-0.4, 0.5, 1.0);
  cv::Scalar background = cv::Scalar(24.0, 17.0, 13.0);  ///< blue, green, red
  int samples_per_px = 1;  ///< along each side of a pixel, 1 to 8; with 1 the picture is not smoothed in any way

  void check() const;
};

struct ShadedPicture {
  cv::Mat picture;  ///< 8-bit BGR
  cv::Mat covered;  ///< 8 bits: the share of a pixel that meshes cover, 255 for all of it
  double px_per_mm = 0.0;
  /// Maps (x, y, z, 1) in millimetres to x to the right and y down in the picture; (0, 0) is the centre of the top-left
  /// pixel.
  Eigen::Matrix<double, 2, 4> px_from_mm = Eigen::Matrix<double, 2, 4>::Zero();
};

/// Draws meshes with Gouraud shading: light is computed at the vertices, with the mesh's normals or, if it has none,
/// `vertex_normals`, and interpolated across the triangles. The nearest triangle hides the others. A triangle that is
/// seen from behind is lit as its other side. The same input gives the same bytes. Meshes must be valid (see
/// require_valid). Throws Error when there is nothing to fit the view to, or a setting makes no sense.
ShadedPicture shaded_picture(std::span<const ColoredMesh> meshes, const OrthographicView& view,
                             const Shading& shading = {});

}  // namespace fathom
