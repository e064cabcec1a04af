#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measurement/planimetry.h"
#include "measurement/section_outline.h"
#include "registration/partition.h"
#include "registration/sweep.h"
#include "segmentation/contours.h"

namespace fathom {

/// Of the whole volume: a part of space with less may do without a volume of its own, and without an interval.
inline constexpr double kNegligiblePart = 0.01;

/// The volume of a structure in one region of a partition, or in one sweep where nothing divides space.
struct PartitionVolume {
  std::size_t region = 0;
  std::size_t sweep = 0;
  VolumeMeasurement measurement;
  double gap_mm = 0.0;      ///< how far the sections stop short of the planes, the largest at either end
  double missing_ml = 0.0;  ///< estimate of what is lost there: the end sections carried on to the plane
  std::string loss;         ///< the same in words; empty where nothing worth saying is missing
};

/// Volumes in the regions in which the structure has sections, and their sums.
struct PartitionedVolume {
  std::vector<PartitionVolume> partitions;
  PlanimetryVolumes total;            ///< empty where a region of more than 1 % has no volume; without what is missing
  std::vector<std::string> warnings;  ///< with one in words for every loss
};

/// `sweeps` are those of the partition, in its order; `locators` those of the recordings that they are of. Throws Error
/// as section_outlines, and when there are several sweeps but no dividing planes: then `measure_sweeps` is for them.
/// Treece 2000, section 4.2.4.
PartitionedVolume measure_partitions(const Structure& structure, std::span<const FrameLocator> locators,
                                     std::span<const Sweep> sweeps, const SpacePartition& partition);

/// The cross-sections of a structure in one sweep, as section_outlines makes them.
struct SweepSections {
  std::vector<SectionOutline> sections;
  std::vector<std::string> warnings;
};

/// The same from sections that are there already, one for each sweep: for who keeps those of frames that did not
/// change.
PartitionedVolume measure_partitions(const Structure& structure, std::span<const FrameLocator> locators,
                                     std::span<const Sweep> sweeps, const SpacePartition& partition,
                                     std::span<const SweepSections> sections);

/// Every sweep by itself, which needs no planes. Where several have sections they have no sum, since they may have seen
/// the same part of the structure, and a warning says so. Throws Error as section_outlines.
PartitionedVolume measure_sweeps(const Structure& structure, std::span<const FrameLocator> locators,
                                 std::span<const Sweep> sweeps);

/// What the user must know of outlines and extremities that no sweep has; empty where every one is in a sweep.
std::optional<std::string> unused_outlines_warning(const Structure& structure, std::span<const Sweep> sweeps);

/// Whether a line on a frame of sweep `sweep` stays open: both its ends lie where another sweep is used. Else it is to
/// be closed. Treece 2000, section 4.2.3.
bool stays_open(const Polygon& line_px, const Eigen::Affine3d& reference_from_image, std::size_t sweep,
                const SpacePartition& partition);

}  // namespace fathom
