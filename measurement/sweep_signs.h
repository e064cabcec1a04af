#pragma once

#include <memory>
#include <span>
#include <vector>

#include "measurement/contour_lattice.h"
#include "measurement/section_plane.h"
#include "surface/layer_mesh.h"
#include "surface/mesh.h"

namespace fathom {

/// Which parts of a surface were swept forward and which backward. Treece 2000, equation (3.12) and section 3.4.2: a
/// region between two planes is passed forward where the way from one to the other runs along their average normal.
/// The sense in which most of the structure was passed is the forward one, whichever way the probe was held.
class SweepSigns {
 public:
  /// Gaps in their order. `layers` are those of the gap, both sections' own included.
  void add_gap(const SectionPlane& first, const SectionPlane& second, const ContourLattice& lattice,
               std::span<const std::shared_ptr<const SampledLayer>> layers);

  /// `mesh` is the joined mesh of `layers`, whose triangles face outward where the layers run forward along the
  /// normals: turns those that do not face outward, and sets the sweep signs if there are any. Returns the volume
  /// passed backward as a share of all that was passed; at most one half.
  double apply(std::span<const LayerMesh* const> layers, Mesh& mesh) const;

 private:
  // The length of the way along the average normal, affine in (a, b); forward where positive.
  struct Gap {
    SectionPlane first;
    SectionPlane second;
    std::size_t first_layer = 0;
    std::size_t last_layer = 0;
    double way_mm = 0.0;
    Eigen::Vector2d way_per_mm = Eigen::Vector2d::Zero();
    bool forward = false;   // somewhere in the lattice
    bool backward = false;  // the same
    ContourLattice lattice;
    std::vector<std::shared_ptr<const SampledLayer>> layers;

    double way_at(const Eigen::Vector2d& ab_mm) const { return way_mm + way_per_mm.dot(ab_mm); }
  };

  // All gaps' ways along their average normals and against them, weighted by what is inside.
  struct Passed {
    double along_mm3 = 0.0;
    double against_mm3 = 0.0;
  };
  Passed passed() const;
  static int sign_at(const Gap& gap, double u, const Eigen::Vector3d& point_mm);

  std::vector<Gap> gaps_;
};

}  // namespace fathom
