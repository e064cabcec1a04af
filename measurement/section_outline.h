#pragma once

#include <span>
#include <string>
#include <vector>

#include "measurement/cross_section.h"
#include "registration/partition.h"
#include "registration/sweep.h"
#include "segmentation/contours.h"

namespace fathom {

/// One cross-section as polygons in space, so that planes can cut it.
struct SectionOutline {
  CrossSection whole;              ///< nothing cut off
  std::vector<Polygon3> outlines;  ///< oriented so that their vector areas add up: outer ones along the normal
};

/// What a structure has in one sweep, as if the sweep's recording were the only one. Open contours are closed by the
/// straight line between their ends.
Structure part_in_sweep(const Structure& structure, const Sweep& sweep);

/// The outlined cross-sections of a structure in one sweep, in the order of its frames, from part_in_sweep. `locator`
/// is that of the sweep's recording. Throws Error as frame_marks; frames without a pose are left out, and named in
/// `warnings`, if any.
std::vector<SectionOutline> section_outlines(const Structure& structure, const FrameLocator& locator,
                                             const Sweep& sweep, std::vector<std::string>* warnings = nullptr);

/// What lies in one region of a partition: one for every section, of zero area where nothing of it is in the region.
std::vector<CrossSection> clip_each(std::span<const SectionOutline> sections, const SpacePartition& partition,
                                    std::size_t region);

/// Those of `clipped`, made by clip_each, that are in the region, extremities included.
std::vector<CrossSection> present_in(std::span<const SectionOutline> sections, std::span<const CrossSection> clipped,
                                     const SpacePartition& partition, std::size_t region);

/// The same, and sections without an area for those that are not in the region though sections before and after them
/// are: there the structure left the region and came back.
std::vector<CrossSection> with_absences(std::span<const SectionOutline> sections, std::span<const CrossSection> clipped,
                                        const SpacePartition& partition, std::size_t region);

/// What lies in one region of a partition. A section without a part in the region is left out.
std::vector<CrossSection> clip_sections(std::span<const SectionOutline> sections, const SpacePartition& partition,
                                        std::size_t region);

}  // namespace fathom
