#include "measurement/partition_volume.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <optional>
#include <utility>

#include "core/error.h"
#include "measurement/partition_loss.h"
#include "segmentation/frame_list.h"

namespace fathom {

namespace {

constexpr double kWorthSaying_ml = 0.005;
constexpr int kLookAlong = 64;  // places along the line that closes an open outline

constexpr std::array<std::optional<double> PlanimetryVolumes::*, 4> kMethods{
    &PlanimetryVolumes::linear_ml, &PlanimetryVolumes::cubic_ml, &PlanimetryVolumes::cubic_3d_ml,
    &PlanimetryVolumes::quadric_ml};

std::string sweep_name(std::size_t sweep) { return "sweep " + std::to_string(sweep + 1); }

std::string loss_in_words(const PartitionVolume& part) {
  if (!(part.missing_ml > kWorthSaying_ml)) return {};
  char text[160];
  std::snprintf(text, sizeof text, "the sections of sweep %zu stop %.2g mm short of the plane: about %.2g ml missing",
                part.sweep + 1, part.gap_mm, part.missing_ml);
  return text;
}

void add_warnings(std::vector<std::string> from, const std::string& before, std::vector<std::string>& to) {
  for (const std::string& warning : from) to.push_back(before + warning);
}

// Outlines that are open although their ends do not both lie where another sweep is used.
void warn_of_closed(const Structure& structure, const FrameLocator& locator, const Sweep& sweep, std::size_t number,
                    const SpacePartition& partition, std::vector<std::string>& warnings) {
  std::vector<int> frames;
  for (const Contour& contour : structure.contours) {
    if (contour.closed || contour.recording != static_cast<int>(sweep.recording)) continue;
    if (!contains(sweep, contour.frame) || contour.frame >= locator.frame_count()) continue;
    const auto map = locator.reference_from_image(contour.frame);
    if (!map) continue;
    // The line between the ends must be out of sight as well.
    const Eigen::Vector2d from = contour.points_px.back();
    const Eigen::Vector2d way = contour.points_px.front() - from;
    bool unseen = true;
    for (int i = 0; i <= kLookAlong && unseen; ++i) {
      unseen = stays_open({from + way * i / kLookAlong}, *map, number, partition);
    }
    if (!unseen) frames.push_back(contour.frame);
  }
  if (frames.empty()) return;
  const bool one = frames.size() == 1;
  warnings.push_back(frame_list(std::move(frames)) + (one ? ": its open outline was" : ": their open outlines were") +
                     " closed by a straight line, which this sweep is used for");
}

// The largest volume that another sweep shows in a region in which the sweep to use has no section.
std::optional<PartitionVolume> unseen(const std::vector<std::span<const SectionOutline>>& sections,
                                      const SpacePartition& partition, std::size_t region, std::size_t sweep) {
  PartitionVolume part;
  part.region = region;
  part.sweep = sweep;
  std::size_t other = 0;
  for (std::size_t s = 0; s < sections.size(); ++s) {
    if (s == sweep) continue;
    const auto shown = measure_planimetry(clip_sections(sections[s], partition, region)).volumes.linear_ml;
    if (!shown || *shown <= part.missing_ml) continue;
    part.missing_ml = *shown;
    other = s;
  }
  if (!(part.missing_ml > kWorthSaying_ml)) return std::nullopt;
  char text[200];
  std::snprintf(text, sizeof text,
                "%s is to be used where it has no outline, while %s shows the structure there: about %.2g ml missing",
                sweep_name(sweep).c_str(), sweep_name(other).c_str(), part.missing_ml);
  part.loss = text;
  return part;
}

// Sums over the parts. One without a volume leaves none, unless it is too small to matter.
PlanimetryVolumes sum_of(const std::vector<PartitionVolume>& partitions) {
  PlanimetryVolumes total;
  for (const auto method : kMethods) {
    double sum = 0.0;
    double lacking = 0.0;
    bool any = false;
    bool known = true;
    for (const PartitionVolume& part : partitions) {
      const auto& volume = part.measurement.volumes.*method;
      any = any || volume;
      sum += volume.value_or(0.0);
      if (volume) continue;
      lacking += part.missing_ml;
      // A rotational sweep has no estimate, nor has one section that no plane cuts off.
      known = known && part.measurement.sections < 2 && part.missing_ml > 0.0;
    }
    if (any && known && lacking <= kNegligiblePart * sum) total.*method = sum;
  }
  return total;
}

std::vector<int> absent_frames(const Structure& structure, const Sweep& sweep) {
  std::vector<int> frames;
  for (const AbsentMark& mark : part_in_sweep(structure, sweep).absent) frames.push_back(mark.frame);
  return frames;
}

const FrameLocator& locator_of(std::span<const FrameLocator> locators, const Sweep& sweep) {
  if (sweep.recording < locators.size()) return locators[sweep.recording];
  throw Error("a sweep is of recording " + std::to_string(sweep.recording) + ", which is not open; name its exam");
}

void require_planes(std::span<const Sweep> sweeps, const SpacePartition& partition) {
  if (sweeps.size() < 2 || !partition.planes().empty()) return;
  throw Error("there are " + std::to_string(sweeps.size()) +
              " sweeps and no dividing planes, so that their volumes have no sum; add a plane, or measure one sweep");
}

}  // namespace

PartitionedVolume measure_partitions(const Structure& structure, std::span<const FrameLocator> locators,
                                     std::span<const Sweep> sweeps, const SpacePartition& partition) {
  require_planes(sweeps, partition);
  std::vector<SweepSections> sections(sweeps.size());
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    sections[s].sections =
        section_outlines(structure, locator_of(locators, sweeps[s]), sweeps[s], &sections[s].warnings);
  }
  return measure_partitions(structure, locators, sweeps, partition, sections);
}

PartitionedVolume measure_partitions(const Structure& structure, std::span<const FrameLocator> locators,
                                     std::span<const Sweep> sweeps, const SpacePartition& partition,
                                     std::span<const SweepSections> made) {
  require_planes(sweeps, partition);
  PartitionedVolume result;
  if (auto unused = unused_outlines_warning(structure, sweeps)) result.warnings.push_back(std::move(*unused));
  std::vector<std::span<const SectionOutline>> sections;
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    std::vector<std::string> warnings = made[s].warnings;
    sections.emplace_back(made[s].sections);
    warn_of_closed(structure, locator_of(locators, sweeps[s]), sweeps[s], s, partition, warnings);
    add_warnings(std::move(warnings), sweep_name(s) + ": ", result.warnings);
  }
  for (std::size_t region = 0; region < partition.region_count(); ++region) {
    const auto used = partition.sweep_in(region);
    if (!used || *used >= sections.size()) continue;
    const std::size_t sweep = *used;
    const std::vector<CrossSection> clipped = clip_each(sections[sweep], partition, region);
    const std::vector<CrossSection> inside = present_in(sections[sweep], clipped, partition, region);
    if (inside.empty()) {
      if (auto part = unseen(sections, partition, region, sweep)) {
        result.warnings.push_back(part->loss);
        result.partitions.push_back(std::move(*part));
      }
      continue;
    }
    const PartitionLoss loss =
        estimate_loss(sections[sweep], clipped, absent_frames(structure, sweeps[sweep]), partition, region);
    const std::vector<CrossSection> all = with_absences(sections[sweep], clipped, partition, region);
    PartitionVolume part{region,      sweep,           measure_planimetry(all, {loss.first_cut, loss.last_cut}),
                         loss.gap_mm, loss.missing_ml, {}};
    part.measurement.sections = static_cast<int>(inside.size());
    part.loss = loss_in_words(part);
    if (!part.loss.empty()) result.warnings.push_back(part.loss);
    add_warnings(part.measurement.warnings, sweep_name(sweep) + ": ", result.warnings);
    result.partitions.push_back(std::move(part));
  }
  for (std::size_t s = 0; s < sections.size(); ++s) {
    const bool used = std::any_of(result.partitions.begin(), result.partitions.end(), [&](const PartitionVolume& part) {
      return part.sweep == s && part.measurement.sections > 0;
    });
    if (used || sections[s].empty()) continue;
    result.warnings.push_back(sweep_name(s) + ": the planes leave all of its outlines to other sweeps: not used");
  }
  result.total = sum_of(result.partitions);
  return result;
}

PartitionedVolume measure_sweeps(const Structure& structure, std::span<const FrameLocator> locators,
                                 std::span<const Sweep> sweeps) {
  PartitionedVolume result;
  if (auto unused = unused_outlines_warning(structure, sweeps)) result.warnings.push_back(std::move(*unused));
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    std::vector<std::string> warnings;
    std::vector<CrossSection> sections;
    for (const SectionOutline& section :
         section_outlines(structure, locator_of(locators, sweeps[s]), sweeps[s], &warnings)) {
      sections.push_back(section.whole);
    }
    if (!sections.empty()) {
      PartitionVolume part{s, s, measure_planimetry(sections), 0.0, 0.0, {}};
      warnings.insert(warnings.end(), part.measurement.warnings.begin(), part.measurement.warnings.end());
      result.partitions.push_back(std::move(part));
    }
    add_warnings(std::move(warnings), sweep_name(s) + ": ", result.warnings);
  }
  if (result.partitions.size() == 1) result.total = result.partitions.front().measurement.volumes;
  if (result.partitions.size() > 1) {
    result.warnings.insert(
        result.warnings.begin(),
        "outlined in " + std::to_string(result.partitions.size()) +
            " sweeps with no dividing planes: each has its volume, and they have no sum, as they may "
            "show the same part twice; place planes (fathom planes), or outline one sweep");
  }
  return result;
}

std::optional<std::string> unused_outlines_warning(const Structure& structure, std::span<const Sweep> sweeps) {
  std::map<int, std::vector<int>> frames;  // by recording
  const auto look = [&](const auto& items) {
    for (const auto& item : items) {
      const bool used = std::any_of(sweeps.begin(), sweeps.end(), [&](const Sweep& sweep) {
        return static_cast<int>(sweep.recording) == item.recording && contains(sweep, item.frame);
      });
      if (!used) frames[item.recording].push_back(item.frame);
    }
  };
  look(structure.contours);
  look(structure.extremities);
  if (frames.empty()) return std::nullopt;
  std::string text;
  for (auto& [recording, of_it] : frames) {
    text += (text.empty() ? "" : "; ") + frame_list(std::move(of_it));
    if (recording > 0) text += " of recording " + std::to_string(recording) + ", counted from 0,";
  }
  return text + " lie in no sweep: not used";
}

bool stays_open(const Polygon& line_px, const Eigen::Affine3d& reference_from_image, std::size_t sweep,
                const SpacePartition& partition) {
  if (line_px.empty()) return false;
  const auto is_hatched = [&](const Eigen::Vector2d& point) {
    const auto used = partition.sweep_at(reference_from_image * Eigen::Vector3d(point.x(), point.y(), 0.0));
    return used && *used != sweep;
  };
  return is_hatched(line_px.front()) && is_hatched(line_px.back());
}

}  // namespace fathom
