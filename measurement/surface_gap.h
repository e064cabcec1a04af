#pragma once

#include <memory>
#include <vector>

#include "core/progress.h"
#include "measurement/contour_lattice.h"
#include "measurement/section_gap.h"
#include "measurement/surface_section.h"
#include "surface/sampled_layer.h"

namespace fathom {

/// The lattice between two sections of a surface through contours.
struct SurfaceGap {
  using ShapePtr = std::shared_ptr<const SectionShape>;

  std::shared_ptr<const SectionGap> between;
  /// Of the sections before and behind that the samples depend on; null where there is none. Shapes are the same while
  /// their sections are, so that they tell whether the samples are, too.
  std::vector<ShapePtr> beyond;
  std::vector<std::shared_ptr<const SampledLayer>> layers;  ///< the sections' own excluded

  bool is_between(const ShapePtr& first, const ShapePtr& second) const {
    return between->first().shape == first && between->second().shape == second;
  }
};

/// What leads from section to section, whatever the lattice; taken over from `before` where it is the same. `curved`:
/// each gap depends on the sections beyond it as well.
std::vector<SurfaceGap> surface_gaps(const std::vector<SurfaceSection>& sections, const std::vector<SurfaceGap>& before,
                                     Guide guide, bool curved);

/// How many layers of samples all gaps and sections have.
std::int64_t count_layers(const std::vector<SurfaceSection>& sections, double spacing_mm);

/// Takes over the samples of those gaps that are as in `before`; the others, to be made, are returned.
std::vector<int> keep_layers(std::vector<SurfaceGap>& gaps, const std::vector<SurfaceGap>& before);

/// Samples the gaps `to_make`, in parallel. Throws Cancelled.
void make_layers(const std::vector<SurfaceSection>& sections, const std::vector<int>& to_make,
                 const ContourLattice& lattice, bool curved, std::vector<SurfaceGap>& gaps, const Progress& progress);

}  // namespace fathom
