#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "measurement/curved_gap.h"
#include "measurement/section_gap.h"
#include "surface/sampled_layer.h"

namespace fathom {

/// Where the samples of a contour surface lie in (a, b): those of Lattice, columns along a and rows along b, at whole
/// multiples of the steps. Treece 2000, figure 3.22.
struct ContourLattice {
  Lattice lattice = Lattice::kBodyCentred;
  double spacing_mm = 1.0;  ///< of the rows, and about that of the layers
  int first_column = 0;
  int first_row = 0;  ///< even
  int columns = 0;
  int rows = 0;

  double column_step_mm() const;
  double row_step_mm() const { return spacing_mm; }
  /// Of column `i` and row `j`, counted from the first, not displaced.
  Eigen::Vector2d at_mm(int i, int j) const;
  std::int64_t samples_per_layer() const { return std::int64_t{columns} * rows; }

  bool operator==(const ContourLattice&) const = default;
};

/// The smallest lattice that holds the rectangle with `margin` spacings around it, rounded up so that most edits of a
/// contour leave it as it is.
ContourLattice contour_lattice(Lattice lattice, double spacing_mm, const Eigen::Vector2d& low_mm,
                               const Eigen::Vector2d& high_mm, double margin);

/// The samples on a section's own plane: the section's field. Even layer.
SampledLayer section_layer(const ContourLattice& lattice, const PlacedSection& section);

/// How many layers lie from a section's plane to the next one's: even, so that every section has an even layer, and
/// such that they are about a spacing apart. `distance_mm` is between the planes where the contours are.
int layers_between(double distance_mm, double spacing_mm);

/// The samples between two sections, without the sections' own layers: `count` - 1 layers, the first of them odd.
/// `curved`, if not null, is of this gap and makes the interpolation one of second order.
std::vector<std::shared_ptr<const SampledLayer>> gap_layers(const ContourLattice& lattice, const SectionGap& gap,
                                                            int count, const CurvedGap* curved = nullptr);

/// Whether the field is inside at the lattice's border, where its surface would be cut open.
bool touches_border(const SampledLayer& layer);

}  // namespace fathom
