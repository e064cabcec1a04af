#include "measurement/divided_interval.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "measurement/moved_section.h"
#include "measurement/partition_volume.h"
#include "measurement/planimetry.h"

namespace fathom {

namespace {

// Changes are taken over steps as large as the errors themselves, since the volume jumps where a section just leaves a
// part of space; never over less than is far above rounding.
constexpr double kStep_mm = 0.01;
constexpr double kStep_rad = 1e-4;

struct Region {
  std::size_t region = 0;
  std::size_t sweep = 0;
  std::vector<CrossSection> clipped;  // one for each section of the sweep
  std::vector<int> present;           // frames with a section in the region, ascending
  double volume_mm3 = 0.0;
};

double volume_mm3(std::span<const SectionOutline> sections, std::span<const CrossSection> clipped,
                  const SpacePartition& partition, std::size_t region) {
  const std::vector<CrossSection> inside = with_absences(sections, clipped, partition, region);
  if (inside.size() < 2) return 0.0;
  double sum = 0.0;
  for (const GapVolumes& gap : gap_volumes(inside)) sum += gap.quadric_mm3;
  return std::abs(sum);
}

class DividedVolume {
 public:
  DividedVolume(std::span<const PlacedSections> sweeps, const SpacePartition& partition) : partition_(partition) {
    for (const PlacedSections& sweep : sweeps) {
      bare_.emplace_back();
      for (const SectionOutline& section : sweep.sections) {
        bare_.back().push_back({section.whole, std::vector<Polygon3>(section.outlines.empty() ? 0 : 1)});
      }
    }
    for (std::size_t region = 0; region < partition.region_count(); ++region) {
      const auto sweep = partition.sweep_in(region);
      if (!sweep || *sweep >= sweeps.size()) continue;
      Region added{region, *sweep, clip_each(sweeps[*sweep].sections, partition, region), {}, 0.0};
      for (const CrossSection& section : present_in(bare_[*sweep], added.clipped, partition, region)) {
        added.present.push_back(section.frame);
      }
      added.volume_mm3 = volume_mm3(bare_[*sweep], added.clipped, partition, region);
      volume_mm3_ += added.volume_mm3;
      regions_.push_back(std::move(added));
    }
  }

  double whole_mm3() const { return volume_mm3_; }

  bool has_enough_sections() const {
    return std::all_of(regions_.begin(), regions_.end(), [&](const Region& region) {
      return region.volume_mm3 <= kNegligiblePart * volume_mm3_ || region.present.size() >= kFewestForInterval;
    });
  }

  // What the volume changes by with another section in the place of one of sweep `sweep`.
  double change_mm3(std::size_t sweep, std::size_t index, const SectionOutline& by) const {
    double change = 0.0;
    const std::vector<SectionOutline>& sections = bare_[sweep];
    for (const Region& region : regions_) {
      if (region.sweep != sweep) continue;
      std::vector<CrossSection> clipped = region.clipped;
      clipped[index] = clip_each(std::span(&by, 1), partition_, region.region).front();
      change += volume_mm3(sections, clipped, partition_, region.region) - region.volume_mm3;
    }
    return change;
  }

  // By unit of a change that is made both ways.
  template <typename Change>
  double slope(std::size_t sweep, std::size_t index, double step, Change change) const {
    return (change_mm3(sweep, index, change(step)) - change_mm3(sweep, index, change(-step))) / (2.0 * step);
  }

  // What the volume changes by without a section; nothing where that would open an end.
  double left_out_mm3(std::size_t sweep, std::size_t index) const {
    double change = 0.0;
    for (const Region& region : regions_) {
      if (region.sweep != sweep || !is_inner(region, region.clipped[index].frame)) continue;
      std::vector<SectionOutline> rest = bare_[sweep];
      std::vector<CrossSection> clipped = region.clipped;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(index));
      clipped.erase(clipped.begin() + static_cast<std::ptrdiff_t>(index));
      change += volume_mm3(rest, clipped, partition_, region.region) - region.volume_mm3;
    }
    return change;
  }

 private:
  static bool is_inner(const Region& region, int frame) {
    const auto& present = region.present;
    return std::binary_search(present.begin(), present.end(), frame) && frame != present.front() &&
           frame != present.back();
  }

  const SpacePartition& partition_;
  std::vector<std::vector<SectionOutline>> bare_;  // each sweep's, without the points of its outlines
  std::vector<Region> regions_;
  double volume_mm3_ = 0.0;
};

// The mean square of the changes by noise of the tracker. Root mean squares in space are shared by three axes.
double tracker_mm6(const DividedVolume& volume, std::size_t sweep, std::size_t index, const PlacedSections& of,
                   const MeasurementErrors& errors) {
  const double turn_rad = errors.tracker_deg * std::numbers::pi / 180.0;
  if (!(errors.tracker_mm > 0.0) && !(turn_rad > 0.0)) return 0.0;
  const double step_mm = std::max(kStep_mm, errors.tracker_mm);
  const double step_rad = std::max(kStep_rad, turn_rad);
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
    const double by_shift = volume.slope(sweep, index, step_mm, [&](double step) {
      return moved(of.sections[index], Eigen::Isometry3d(Eigen::Translation3d(step * along)));
    });
    const double by_turn = volume.slope(sweep, index, step_rad, [&](double step) {
      const Eigen::Translation3d probe(of.probes_mm[index]);
      return moved(of.sections[index], Eigen::Isometry3d(probe * Eigen::AngleAxisd(step, along) * probe.inverse()));
    });
    sum += by_shift * by_shift * errors.tracker_mm * errors.tracker_mm + by_turn * by_turn * turn_rad * turn_rad;
  }
  return sum / 3.0;
}

}  // namespace

PlacedSections placed_sections(const Structure& structure, const FrameLocator& locator, const Sweep& sweep,
                               const Calibration& calibration) {
  const Eigen::Affine3d image_from_probe = calibration.probe_from_image.inverse();
  PlacedSections placed{section_outlines(structure, locator, sweep), {}};
  for (const SectionOutline& section : placed.sections) {
    placed.probes_mm.emplace_back(
        (*locator.reference_from_image(section.whole.frame) * image_from_probe).translation());
  }
  return placed;
}

std::optional<VolumeInterval> divided_interval(std::span<const PlacedSections> sweeps, const SpacePartition& partition,
                                               const MeasurementErrors& errors, double calibration_ml,
                                               double missing_ml, const Progress& progress) {
  const DividedVolume volume(sweeps, partition);
  if (!(volume.whole_mm3() > 0.0) || !volume.has_enough_sections()) return std::nullopt;
  VolumeVariances found;
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    assert(sweeps[s].sections.size() == sweeps[s].probes_mm.size());
    for (std::size_t i = 0; i < sweeps[s].sections.size(); ++i) {
      report(progress, static_cast<double>(s) / static_cast<double>(sweeps.size()));
      const double left_out = volume.left_out_mm3(s, i);
      found.left_out_mm6 += left_out * left_out;
      if (const double outline_mm = errors.outline_mm.value_or(0.0); outline_mm > 0.0) {
        const double by_outline = outline_mm * volume.slope(s, i, std::max(kStep_mm, outline_mm), [&](double step) {
          return grown(sweeps[s].sections[i], step);
        });
        found.outlining_mm6 += by_outline * by_outline;
      }
      found.tracker_mm6 += tracker_mm6(volume, s, i, sweeps[s], errors);
    }
  }
  VolumeInterval interval =
      interval_about(volume.whole_mm3() / 1000.0, found, errors.outline_mm.has_value(), calibration_ml);
  interval.high_ml += missing_ml;
  return interval;
}

}  // namespace fathom
