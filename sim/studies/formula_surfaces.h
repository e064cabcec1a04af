#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "surface/isosurface.h"
#include "surface/mesh.h"

namespace fathom {

/// Triangles of an object and what is left of its measures, as Treece 2000, tables 3.2 and 3.3, prints them.
struct PublishedMeshes {
  int cubes = 0;
  int tetrahedra = 0;
  int regularised = 0;
  std::optional<double> volume_percent;  ///< regularised, of marching tetrahedra's
  double area_percent = 0.0;
};

/// Where a function is zero; inside it is positive. Without units in the source, millimetres here.
struct FormulaSurface {
  std::string name;
  PointField field;
  Eigen::Vector3d reach_mm;          ///< to both sides of the origin lies all of the surface that is meshed
  std::optional<double> volume_mm3;  ///< the true one, where there is a formula for it
  std::optional<PublishedMeshes> published;
  bool open = false;  ///< it ends at the reach
};

/// "sphere", "peaks" (3.17) and "closed" (3.18) of Treece 2000, section 3.6, a torus, and a sphere with bumps.
///
/// The published areas and volumes are not calibrated, and fit neither equation in its own units: z was drawn on
/// another scale. Here z is scaled so that the areas of both objects, and the volume of the second, are in the
/// published proportions. Outside of its ellipse the product of (3.18) rises again; the surface meant lies within.
const std::vector<FormulaSurface>& formula_surfaces();

/// The mesh on samples of just this layer distance. `aside` is how far the lattice's middle lies beside the object's,
/// in layer distances: by default so that nothing is symmetric.
Mesh formula_mesh(const FormulaSurface& surface, const MesherOptions& mesher, double spacing_mm,
                  const Eigen::Vector3d& aside = {0.037, 0.021, 0.043});

/// The layer distance at which marching cubes make the published number of triangles, within 2 %. `surface` must have
/// been published.
double published_spacing_mm(const FormulaSurface& surface);

}  // namespace fathom
