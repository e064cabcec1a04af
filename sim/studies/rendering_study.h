#pragma once

#include <string>

#include "surface/layer_mesher.h"

namespace fathom {

/// How much the shaded picture of a sphere changes when the sphere is turned and the light is not: any change comes
/// from the triangles. Treece 2000, section 3.6.1, table 3.4.
struct RenderingVariation {
  std::size_t triangles = 0;
  double mean_image = 0.0;   ///< mean over all pixels of the standard deviation over the views, grey levels of 255
  double mean_sphere = 0.0;  ///< the same over the pixels that the sphere covers in all views
  double largest_sphere = 0.0;
  double border_percent = 0.0;  ///< pixels that the sphere covers in some views only, of all
};

/// Where the normals come from that the light is computed with.
enum class ShadingNormals {
  kField,     ///< the gradient of the function at the vertices
  kTriangles  ///< the mean of the triangles around a vertex, as viewers do that read a mesh without normals
};

/// The sphere x^2 + y^2 + z^2 - 1 on a lattice of this spacing, seen from `views` directions all around.
RenderingVariation rendering_variation(const MesherOptions& mesher, double spacing, ShadingNormals normals,
                                       int views = 20);

}  // namespace fathom
