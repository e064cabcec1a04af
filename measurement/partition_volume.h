#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measurement/planimetry.h"
#include "registration/partition.h"
#include "registration/sweep.h"
#include "segmentation/contours.h"

namespace fathom {

/// One cross-section as polygons in space, so that planes can cut it.
struct SectionOutline {
  CrossSection whole;              ///< nothing cut off
  std::vector<Polygon3> outlines;  ///< oriented so that their vector areas add up: outer ones along the normal
};

/// The outlined cross-sections of a structure in one sweep, in the order of its frames. Open contours are closed by the
/// straight line between their ends. Throws Error as frame_marks; frames without a pose are left out.
std::vector<SectionOutline> section_outlines(const Structure& structure, const FrameLocator& locator,
                                             const Sweep& sweep);

/// What lies in one region of a partition. A section without a part in the region is left out.
std::vector<CrossSection> clip_sections(std::span<const SectionOutline> sections, const SpacePartition& partition,
                                        std::size_t region);

/// The volume of a structure in one region.
struct PartitionVolume {
  std::size_t region = 0;
  std::size_t sweep = 0;
  VolumeMeasurement measurement;
  double gap_mm = 0.0;      ///< how far the sections stop short of the planes, the largest at either end
  double missing_ml = 0.0;  ///< estimate of what is lost there: the end sections carried on to the plane
};

/// Volumes in the regions in which the structure has sections, and their sums.
struct PartitionedVolume {
  std::vector<PartitionVolume> partitions;
  PlanimetryVolumes total;            ///< empty where a region has no volume; without what is missing
  std::vector<std::string> warnings;  ///< with one in words for every loss
};

/// `sweeps` are those of the partition, in its order. Throws Error as section_outlines, and when there are several
/// sweeps but no dividing planes: each sweep then has a volume, and there is no sum.
/// Treece 2000, section 4.2.4.
PartitionedVolume measure_partitions(const Structure& structure, const FrameLocator& locator,
                                     std::span<const Sweep> sweeps, const SpacePartition& partition);

/// Whether a line on a frame of sweep `sweep` stays open: both its ends lie where another sweep is used. Else it is to
/// be closed. Treece 2000, section 4.2.3.
bool stays_open(const Polygon& line_px, const Eigen::Affine3d& reference_from_image, std::size_t sweep,
                const SpacePartition& partition);

}  // namespace fathom
