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

std::vector<PlacedSections> placed_sections(const Structure& structure, const Scan& scan, const Division& division) {
  const Eigen::Affine3d image_from_probe = scan.calibration.probe_from_image.inverse();
  std::vector<PlacedSections> sweeps;
  for (const Sweep& sweep : division.sweeps) {
    const FrameLocator& locator = scan.locators[sweep.recording];
    PlacedSections placed{section_outlines(structure, locator, sweep), {}};
    for (const SectionOutline& section : placed.sections) {
      placed.probes_mm.emplace_back(
          (*locator.reference_from_image(section.whole.frame) * image_from_probe).translation());
    }
    sweeps.push_back(std::move(placed));
  }
  return sweeps;
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
  const auto calibration_ml = calibration_spread_ml(scan.calibration, [&](const Calibration& calibration) {
    report(progress, 0.0);
    return measured(locators_with(scan, calibration)).total.quadric_ml;
  });
  result.interval = divided_interval(placed_sections(structure, scan, division), division.partition, errors,
                                     calibration_ml.value_or(0.0), missing_ml, progress);
  return result;
}

}  // namespace fathom
