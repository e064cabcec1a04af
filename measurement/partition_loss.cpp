#include "measurement/partition_loss.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "registration/way_out.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
constexpr double kUncut = 1.0 - 1e-6;  // share of a section's area: what is more is the whole

double area_mm2(const CrossSection& section) { return section.vector_area_mm2.norm(); }

// How far it is from a section's centroid along `way` to where the region ends, at most `farthest_mm`.
double way_to_end_mm(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& way, double farthest_mm,
                     const SpacePartition& partition, std::size_t region) {
  double reach_mm = 0.0;
  for (const SpacePartition::Cell& cell : partition.cells()) {
    if (cell.region != region) continue;
    const auto out = way_out(from_mm, way, partition.bounds(cell));
    reach_mm = std::max(reach_mm, out ? std::min(out->way_mm, farthest_mm) : farthest_mm);
  }
  return reach_mm;
}

// The sections of one region, and what is lost at its ends.
class Ends {
 public:
  Ends(std::span<const SectionOutline> sections, std::span<const CrossSection> clipped, const SpacePartition& partition,
       std::size_t region)
      : sections_(sections), clipped_(clipped), partition_(partition), region_(region) {}

  bool has_part(std::size_t i) const { return area_mm2(clipped_[i]) > 0.0; }
  bool is_whole(std::size_t i) const { return area_mm2(clipped_[i]) >= kUncut * area_mm2(sections_[i].whole); }

  // Between section `end` and the next one, which lies beyond the plane.
  void add_before(std::size_t end, std::size_t next, PartitionLoss& loss) const {
    const Eigen::Vector3d way = away_from_mm(end, sections_[next].whole.centroid_mm, -1.0);
    const double distance_mm = way.dot(sections_[next].whole.centroid_mm - clipped_[end].centroid_mm);
    const double slope = is_whole(end) && distance_mm > 0.0
                             ? (area_mm2(sections_[next].whole) - area_mm2(clipped_[end])) / distance_mm
                             : 0.0;
    add(end, way_to_end_mm(clipped_[end].centroid_mm, way, distance_mm, partition_, region_), slope, loss);
  }

  // Beyond section `end`, the outermost of all, away from section `inner`. Returns whether a plane lies there.
  bool add_beyond(std::size_t end, std::optional<std::size_t> inner, double sign, PartitionLoss& loss) const {
    const Eigen::Vector3d& from_mm = clipped_[end].centroid_mm;
    const Eigen::Vector3d way =
        inner ? away_from_mm(end, clipped_[*inner].centroid_mm, 1.0) : Eigen::Vector3d(sign * clipped_[end].normal);
    const double farthest_mm = std::max(length_mm(), std::sqrt(area_mm2(clipped_[end])));
    const double gap_mm = way_to_end_mm(from_mm, way, farthest_mm, partition_, region_);
    if (gap_mm >= farthest_mm) return false;
    double slope = 0.0;
    if (inner && is_whole(end) && is_whole(*inner)) {
      const double step_mm = way.dot(from_mm - clipped_[*inner].centroid_mm);
      if (step_mm > 0.0) slope = (area_mm2(clipped_[end]) - area_mm2(clipped_[*inner])) / step_mm;
    }
    if (area_mm2(clipped_[end]) + slope * gap_mm <= 0.0) return false;
    add(end, gap_mm, slope, loss);
    return true;
  }

 private:
  Eigen::Vector3d away_from_mm(std::size_t end, const Eigen::Vector3d& other_mm, double sense) const {
    const Eigen::Vector3d way = clipped_[end].normal;
    return sense * way.dot(clipped_[end].centroid_mm - other_mm) < 0.0 ? Eigen::Vector3d(-way) : way;
  }

  void add(std::size_t end, double gap_mm, double slope_mm, PartitionLoss& loss) const {
    const double area = area_mm2(clipped_[end]);
    loss.gap_mm = std::max(loss.gap_mm, gap_mm);
    // What grows is not trusted to do so for long.
    loss.missing_ml += gap_mm * std::clamp(area + 0.5 * slope_mm * gap_mm, 0.0, 2.0 * area) / kMm3PerMl;
  }

  double length_mm() const {
    double length_mm = 0.0;
    const CrossSection* before = nullptr;
    for (std::size_t i = 0; i < clipped_.size(); ++i) {
      if (!has_part(i)) continue;
      if (before != nullptr) length_mm += (clipped_[i].centroid_mm - before->centroid_mm).norm();
      before = &clipped_[i];
    }
    return length_mm;
  }

  std::span<const SectionOutline> sections_;
  std::span<const CrossSection> clipped_;
  const SpacePartition& partition_;
  std::size_t region_;
};

}  // namespace

PartitionLoss estimate_loss(std::span<const SectionOutline> sections, std::span<const CrossSection> clipped,
                            std::span<const int> absent, const SpacePartition& partition, std::size_t region) {
  PartitionLoss loss;
  const Ends ends(sections, clipped, partition, region);
  std::optional<std::size_t> first;
  std::size_t last = 0;
  for (std::size_t i = 0; i < clipped.size(); ++i) {
    if (!ends.has_part(i)) continue;
    if (!first) first = i;
    last = i;
  }
  if (!first) return loss;
  const auto goes_on = [&](std::size_t i) { return area_mm2(sections[i].whole) > 0.0; };
  for (std::size_t i = *first; i <= last; ++i) {
    if (!ends.has_part(i)) continue;
    if (i > 0 && !ends.has_part(i - 1) && goes_on(i - 1)) {
      ends.add_before(i, i - 1, loss);
      loss.first_cut = loss.first_cut || i == *first;
    }
    if (i + 1 < clipped.size() && !ends.has_part(i + 1) && goes_on(i + 1)) {
      ends.add_before(i, i + 1, loss);
      loss.last_cut = loss.last_cut || i == last;
    }
  }
  const auto inner = [&](std::size_t i) { return ends.has_part(i) ? std::optional(i) : std::nullopt; };
  const bool seen_before =
      std::any_of(absent.begin(), absent.end(), [&](int frame) { return frame < sections.front().whole.frame; });
  const bool seen_behind =
      std::any_of(absent.begin(), absent.end(), [&](int frame) { return frame > sections.back().whole.frame; });
  const bool alone = clipped.size() == 1;
  if (*first == 0 && !seen_before) {
    loss.first_cut = ends.add_beyond(0, alone ? std::nullopt : inner(1), -1.0, loss);
  }
  if (last + 1 == clipped.size() && !seen_behind) {
    loss.last_cut = ends.add_beyond(last, alone ? std::nullopt : inner(last - 1), 1.0, loss);
  }
  return loss;
}

}  // namespace fathom
