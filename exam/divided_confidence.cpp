#include "exam/divided_confidence.h"

#include "measurement/calibration_spread.h"
#include "measurement/divided_interval.h"
#include "measurement/partition_volume.h"

namespace fathom {

namespace {

std::vector<FrameLocator> locators_with(const Scan& scan, const Calibration& calibration) {
  std::vector<FrameLocator> locators;
  for (const auto& recording : scan.recordings) locators.emplace_back(*recording, calibration, scan.names);
  return locators;
}

}  // namespace

Confidence divided_confidence(const Structure& structure, const Scan& scan, const Division& division,
                              const MeasurementErrors& errors, const Progress& progress) {
  const auto measured = [&](std::span<const FrameLocator> locators) {
    return measure_partitions(structure, locators, division.sweeps, division.partition);
  };
  const PartitionedVolume volume = measured(scan.locators);
  Confidence result;
  if (!volume.total.quadric_ml) return result;
  double missing_ml = 0.0;
  for (const PartitionVolume& part : volume.partitions) missing_ml += part.missing_ml;
  const auto volume_ml = [&](const Calibration& with) { return measured(locators_with(scan, with)).total.quadric_ml; };
  const auto calibration_ml = calibration_spread_ml(scan.calibration, volume_ml, part_of(progress, 0.0, 0.5));
  std::vector<PlacedSections> sweeps;
  for (const Sweep& sweep : division.sweeps) {
    sweeps.push_back(placed_sections(structure, scan.locators[sweep.recording], sweep, scan.calibration));
  }
  result.interval = divided_interval(sweeps, division.partition, errors, calibration_ml.value_or(0.0), missing_ml,
                                     part_of(progress, 0.5, 1.0));
  return result;
}

}  // namespace fathom
