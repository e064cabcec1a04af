#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/progress.h"
#include "measurement/section_outline.h"
#include "measurement/volume_interval.h"
#include "registration/calibration.h"
#include "registration/partition.h"

namespace fathom {

/// The sections of one sweep in the order of its frames, and where the probe's sensor was in each, in reference
/// coordinates.
struct PlacedSections {
  std::vector<SectionOutline> sections;
  std::vector<Eigen::Vector3d> probes_mm;
};

/// Those of a structure, as section_outlines makes them. `locator` is that of the sweep's recording, `calibration` the
/// locator's. Throws Error as section_outlines.
PlacedSections placed_sections(const Structure& structure, const FrameLocator& locator, const Sweep& sweep,
                               const Calibration& calibration);

/// The interval about the sum of quadric planimetry over the regions of a partition, as measure_partitions
/// (measurement/partition_volume.h) has it; `sweeps` are those of the partition, in its order. The same as
/// volume_interval where there is one sweep, with what planes cut off: a section that moves or grows shares its area
/// anew among the regions. `calibration_ml` is the standard deviation that the calibration brings in; `missing_ml`,
/// which the sections are estimated to stop short of the planes, is added to the upper end.
///
/// Empty where a region with more than 1 % of the volume has fewer than four sections. Throws Cancelled.
std::optional<VolumeInterval> divided_interval(std::span<const PlacedSections> sweeps, const SpacePartition& partition,
                                               const MeasurementErrors& errors, double calibration_ml,
                                               double missing_ml, const Progress& progress = {});

}  // namespace fathom
