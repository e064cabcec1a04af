#include "measurement/section_outline.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "measurement/frame_marks.h"
#include "measurement/marked_sections.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

constexpr double kSmallestShare = 1e-9;  // of a section's area: less comes from rounding

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

std::vector<std::size_t> present_indices(std::span<const SectionOutline> sections,
                                         std::span<const CrossSection> clipped, const SpacePartition& partition,
                                         std::size_t region) {
  std::vector<std::size_t> present;
  for (std::size_t i = 0; i < clipped.size(); ++i) {
    const bool is_extremity = sections[i].outlines.empty();
    if (is_extremity ? touches_region(clipped[i], partition, region) : clipped[i].vector_area_mm2.norm() > 0.0) {
      present.push_back(i);
    }
  }
  return present;
}

// Where the way from one centroid to the other crosses the plane of `section`, or half-way where it does not.
CrossSection empty_between(const CrossSection& section, const CrossSection& before, const CrossSection& after) {
  const Eigen::Vector3d way_mm = after.centroid_mm - before.centroid_mm;
  const double along = section.normal.dot(way_mm);
  const double share = section.normal.dot(section.centroid_mm - before.centroid_mm) / along;
  CrossSection empty = section;
  empty.vector_area_mm2.setZero();
  empty.centroid_mm = before.centroid_mm + (share >= 0.0 && share <= 1.0 ? share : 0.5) * way_mm;
  return empty;
}

}  // namespace

Structure part_in_sweep(const Structure& structure, const Sweep& sweep) {
  const auto has = [&](const auto& item) {
    return item.recording == static_cast<int>(sweep.recording) && contains(sweep, item.frame);
  };
  const auto take = [&](const auto& from, auto& to) {
    for (auto item : from) {
      if (!has(item)) continue;
      item.recording = 0;
      to.push_back(std::move(item));
    }
  };
  Structure here;
  here.name = structure.name;
  here.color = structure.color;
  take(structure.contours, here.contours);
  take(structure.extremities, here.extremities);
  take(structure.absent, here.absent);
  for (Contour& contour : here.contours) contour.closed = true;
  return here;
}

std::vector<SectionOutline> section_outlines(const Structure& structure, const FrameLocator& locator,
                                             const Sweep& sweep, std::vector<std::string>* warnings) {
  const Structure here = part_in_sweep(structure, sweep);
  std::vector<SectionOutline> sections;
  const std::vector<FrameMarks> all = frame_marks(here, locator);
  const std::vector<CrossSection> wholes = cross_sections(all, locator, warnings);
  for (const FrameMarks& marks : all) {
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

std::vector<CrossSection> clip_each(std::span<const SectionOutline> sections, const SpacePartition& partition,
                                    std::size_t region) {
  std::vector<CrossSection> clipped;
  for (const SectionOutline& section : sections) clipped.push_back(clip_section(section, partition, region));
  return clipped;
}

std::vector<CrossSection> present_in(std::span<const SectionOutline> sections, std::span<const CrossSection> clipped,
                                     const SpacePartition& partition, std::size_t region) {
  std::vector<CrossSection> inside;
  for (const std::size_t i : present_indices(sections, clipped, partition, region)) inside.push_back(clipped[i]);
  return inside;
}

std::vector<CrossSection> with_absences(std::span<const SectionOutline> sections, std::span<const CrossSection> clipped,
                                        const SpacePartition& partition, std::size_t region) {
  std::vector<CrossSection> inside;
  std::optional<std::size_t> before;
  for (const std::size_t i : present_indices(sections, clipped, partition, region)) {
    for (std::size_t absent = before ? *before + 1 : i; absent < i; ++absent) {
      inside.push_back(empty_between(sections[absent].whole, clipped[*before], clipped[i]));
    }
    inside.push_back(clipped[i]);
    before = i;
  }
  return inside;
}

std::vector<CrossSection> clip_sections(std::span<const SectionOutline> sections, const SpacePartition& partition,
                                        std::size_t region) {
  return present_in(sections, clip_each(sections, partition, region), partition, region);
}

}  // namespace fathom
