#include "measurement/partition_volume.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/error.h"
#include "measurement/frame_marks.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
constexpr double kSmallestShare = 1e-9;  // of a section's area: less comes from rounding
constexpr double kWorthSaying_ml = 0.005;
constexpr double kParallel = 1e-3;  // cosine: a section that stands on the plane never reaches it

double signed_area_px(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - polygon[0];
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - polygon[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

// Area along the normal, and the moment about `origin`.
struct Moments {
  double area = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
};

void add_moments(const Polygon3& polygon, const Eigen::Vector3d& origin, const Eigen::Vector3d& normal, Moments& sum) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Eigen::Vector3d a = polygon[0] - origin;
    const Eigen::Vector3d b = polygon[i - 1] - origin;
    const Eigen::Vector3d c = polygon[i] - origin;
    const double area = 0.5 * (b - a).cross(c - a).dot(normal);
    sum.area += area;
    sum.first += area / 3.0 * (a + b + c);
  }
}

bool touches_region(const CrossSection& section, const SpacePartition& partition, std::size_t region) {
  const std::uint32_t sides = partition.sides_at(section.centroid_mm);
  return std::any_of(partition.cells().begin(), partition.cells().end(),
                     [&](const auto& cell) { return cell.sides == sides && cell.region == region; });
}

CrossSection clip_section(const SectionOutline& section, const SpacePartition& partition, std::size_t region) {
  CrossSection part = section.whole;
  if (section.outlines.empty()) return part;  // an extremity: `touches_region` decides
  const Eigen::Vector3d origin = section.whole.centroid_mm;
  Moments sum;
  for (const SpacePartition::Cell& cell : partition.cells()) {
    if (cell.region != region) continue;
    const std::vector<DividingPlane> bounds = partition.bounds(cell);
    for (const Polygon3& outline : section.outlines) {
      add_moments(clip_polygon(outline, bounds), origin, section.whole.normal, sum);
    }
  }
  if (!(sum.area > kSmallestShare * section.whole.vector_area_mm2.norm())) {
    part.vector_area_mm2.setZero();
    return part;
  }
  part.vector_area_mm2 = sum.area * section.whole.normal;
  part.centroid_mm = origin + sum.first / sum.area;
  return part;
}

// One for every section; of zero area where nothing of it is in the region.
std::vector<CrossSection> clip_each(std::span<const SectionOutline> sections, const SpacePartition& partition,
                                    std::size_t region) {
  std::vector<CrossSection> clipped;
  for (const SectionOutline& section : sections) clipped.push_back(clip_section(section, partition, region));
  return clipped;
}

// Those of `clipped` that are in the region, extremities included.
std::vector<CrossSection> present(std::span<const SectionOutline> sections, std::span<const CrossSection> clipped,
                                  const SpacePartition& partition, std::size_t region) {
  std::vector<CrossSection> inside;
  for (std::size_t i = 0; i < clipped.size(); ++i) {
    const bool is_extremity = sections[i].outlines.empty();
    if (is_extremity ? touches_region(clipped[i], partition, region) : clipped[i].vector_area_mm2.norm() > 0.0) {
      inside.push_back(clipped[i]);
    }
  }
  return inside;
}

// How far a section lies from where a line through its centroid, along the way to `next`, leaves the region.
double way_to_end_mm(const CrossSection& end, const CrossSection& next, const SpacePartition& partition,
                     std::size_t region) {
  Eigen::Vector3d way = end.normal;
  if (way.dot(next.centroid_mm - end.centroid_mm) < 0.0) way = -way;
  const double farthest_mm = way.dot(next.centroid_mm - end.centroid_mm);
  double reach_mm = 0.0;
  for (const SpacePartition::Cell& cell : partition.cells()) {
    if (cell.region != region) continue;
    double leave_mm = farthest_mm;
    for (const DividingPlane& plane : partition.bounds(cell)) {
      const double slope = plane.normal().dot(way);
      if (slope > -kParallel) continue;
      leave_mm = std::min(leave_mm, plane.signedDistance(end.centroid_mm) / -slope);
    }
    reach_mm = std::max(reach_mm, leave_mm);
  }
  return reach_mm;
}

std::string loss_warning(const PartitionVolume& part) {
  char text[160];
  std::snprintf(text, sizeof text, "the sections of sweep %zu stop %.2g mm short of the plane: about %.2g ml missing",
                part.sweep + 1, part.gap_mm, part.missing_ml);
  return text;
}

// Where the structure goes on beyond the last section that the region has, part of it lies between section and plane.
void estimate_loss(std::span<const SectionOutline> sections, std::span<const CrossSection> clipped,
                   const SpacePartition& partition, PartitionVolume& part) {
  const auto has_part = [](const CrossSection& section) { return section.vector_area_mm2.norm() > 0.0; };
  for (std::size_t i = 0; i + 1 < clipped.size(); ++i) {
    for (const auto& [end, next] : {std::pair(i, i + 1), std::pair(i + 1, i)}) {
      if (!has_part(clipped[end]) || has_part(clipped[next]) || !has_part(sections[next].whole)) continue;
      const double gap_mm = way_to_end_mm(clipped[end], sections[next].whole, partition, part.region);
      part.gap_mm = std::max(part.gap_mm, gap_mm);
      part.missing_ml += gap_mm * clipped[end].vector_area_mm2.norm() / kMm3PerMl;
    }
  }
}

void add_to(std::optional<double>& total, const std::optional<double>& volume) {
  if (total) total = volume ? std::optional(*total + *volume) : std::nullopt;
}

}  // namespace

std::vector<SectionOutline> section_outlines(const Structure& structure, const FrameLocator& locator,
                                             const Sweep& sweep) {
  Structure here;
  here.name = structure.name;
  for (Contour contour : structure.contours) {
    if (contour.recording != static_cast<int>(sweep.recording) || !contains(sweep, contour.frame)) continue;
    contour.closed = true;
    here.contours.push_back(std::move(contour));
  }
  for (const Extremity& extremity : structure.extremities) {
    if (extremity.recording == static_cast<int>(sweep.recording) && contains(sweep, extremity.frame))
      here.extremities.push_back(extremity);
  }
  std::vector<SectionOutline> sections;
  const std::vector<CrossSection> wholes = cross_sections(here, locator, nullptr);
  for (const FrameMarks& marks : frame_marks(here, locator)) {
    const auto whole = std::find_if(wholes.begin(), wholes.end(),
                                    [&](const CrossSection& section) { return section.frame == marks.frame; });
    const auto reference_from_image = locator.reference_from_image(marks.frame);
    if (whole == wholes.end() || !reference_from_image) continue;
    SectionOutline section{*whole, {}};
    const std::vector<Nesting> nested = nesting(marks.outlines);
    for (std::size_t i = 0; i < marks.outlines.size(); ++i) {
      if (nested[i] == Nesting::kCoincident) continue;
      Polygon3 outline;
      for (const Eigen::Vector2d& point : *marks.outlines[i]) {
        outline.push_back(*reference_from_image * Eigen::Vector3d(point.x(), point.y(), 0.0));
      }
      const bool backward = signed_area_px(*marks.outlines[i]) < 0.0;
      if (backward != (nested[i] == Nesting::kHole)) std::reverse(outline.begin(), outline.end());
      section.outlines.push_back(std::move(outline));
    }
    sections.push_back(std::move(section));
  }
  return sections;
}

std::vector<CrossSection> clip_sections(std::span<const SectionOutline> sections, const SpacePartition& partition,
                                        std::size_t region) {
  return present(sections, clip_each(sections, partition, region), partition, region);
}

PartitionedVolume measure_partitions(const Structure& structure, const FrameLocator& locator,
                                     std::span<const Sweep> sweeps, const SpacePartition& partition) {
  if (sweeps.size() > 1 && partition.planes().empty()) {
    throw Error(locator.recording_name() + ": has " + std::to_string(sweeps.size()) +
                " sweeps and no dividing planes, so that their volumes have no sum; add a plane, or measure one sweep");
  }
  PartitionedVolume result;
  std::vector<std::vector<SectionOutline>> sections;
  for (const Sweep& sweep : sweeps) sections.push_back(section_outlines(structure, locator, sweep));
  result.total = {0.0, 0.0, 0.0};
  for (std::size_t region = 0; region < partition.region_count(); ++region) {
    const auto cell = std::find_if(partition.cells().begin(), partition.cells().end(),
                                   [&](const auto& candidate) { return candidate.region == region; });
    if (cell == partition.cells().end() || !cell->sweep || *cell->sweep >= sections.size()) continue;
    const std::vector<CrossSection> clipped = clip_each(sections[*cell->sweep], partition, region);
    const std::vector<CrossSection> inside = present(sections[*cell->sweep], clipped, partition, region);
    if (inside.empty()) continue;
    PartitionVolume part;
    part.region = region;
    part.sweep = *cell->sweep;
    part.measurement = measure_planimetry(inside);
    estimate_loss(sections[part.sweep], clipped, partition, part);
    if (part.missing_ml > kWorthSaying_ml) result.warnings.push_back(loss_warning(part));
    for (const std::string& warning : part.measurement.warnings) {
      result.warnings.push_back("sweep " + std::to_string(part.sweep + 1) + ": " + warning);
    }
    add_to(result.total.linear_ml, part.measurement.volumes.linear_ml);
    add_to(result.total.cubic_ml, part.measurement.volumes.cubic_ml);
    add_to(result.total.cubic_3d_ml, part.measurement.volumes.cubic_3d_ml);
    result.partitions.push_back(std::move(part));
  }
  if (result.partitions.empty()) result.total = {};
  return result;
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
