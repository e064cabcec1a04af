#include "measurement/surface_section.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "measurement/cross_section.h"
#include "measurement/lost_frames.h"
#include "measurement/section_shape.h"

namespace fathom {

namespace {

// The sections' distance fields have this many cells for every lattice spacing; more are hardly seen by the samples.
constexpr double kCellsPerSpacing = 2.0;
// Planes that are nearer to each other than this share of the spacing all over the contours are one plane.
constexpr double kSamePlane = 0.01;
// Normals of successive sections that are more than 120 degrees apart have no average that leads from one to the other.
constexpr double kMinGapCosine = -0.5;
// Default spacing: so many layers through the largest extent.
constexpr double kDefaultLayers = 80.0;
// Of the mean distance of two planes: nearer than this they count as this near, so that no place has all the weight.
constexpr double kLeastDistance = 1e-3;

void extend(SurfaceBounds& bounds, const SurfaceSection& section) {
  for (const Polygon& outline : section.outlines_px) {
    for (const Eigen::Vector2d& point : outline) bounds.extend(section.place.ab_from_image * point);
  }
  if (section.extremity_px) bounds.extend(section.place.ab_from_image * *section.extremity_px);
}

// Sums over the sides of outlines.
struct AlongOutlines {
  double length_mm = 0.0;
  double logarithm = 0.0;
};

}  // namespace

bool SurfaceSection::marked_as(const FrameMarks& marks) const {
  const bool same_point = extremity_px.has_value() == (marks.extremity_px != nullptr) &&
                          (!extremity_px || *extremity_px == *marks.extremity_px);
  return frame == marks.frame && same_point &&
         std::equal(outlines_px.begin(), outlines_px.end(), marks.outlines.begin(), marks.outlines.end(),
                    [](const Polygon& mine, const Polygon* other) { return mine == *other; });
}

SurfaceBounds::SurfaceBounds()
    : low(Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity())),
      high(Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity())) {}

void SurfaceBounds::extend(const Eigen::Vector2d& point) {
  low = low.cwiseMin(point);
  high = high.cwiseMax(point);
}

SurfaceBounds bounds_of(const std::vector<SurfaceSection>& sections) {
  SurfaceBounds bounds;
  for (const SurfaceSection& section : sections) extend(bounds, section);
  return bounds;
}

SectionDistance distance_between(const SurfaceSection& first, const SurfaceSection& second) {
  const auto apart_mm = [&](const Eigen::Vector2d& ab) {
    return (second.place.plane.at(ab) - first.place.plane.at(ab)).norm();
  };
  SurfaceBounds bounds;
  extend(bounds, first);
  extend(bounds, second);
  if (!(bounds.low.x() <= bounds.high.x())) bounds.extend(Eigen::Vector2d::Zero());  // both are absent
  SectionDistance distance;
  for (const double a : {bounds.low.x(), bounds.high.x()}) {
    for (const double b : {bounds.low.y(), bounds.high.y()}) {
      const double here = apart_mm({a, b});
      distance.mean_mm += 0.25 * here;
      distance.largest_mm = std::max(distance.largest_mm, here);
    }
  }
  AlongOutlines along;
  for (const SurfaceSection* section : {&first, &second}) {
    for (const Polygon& outline : section->outlines_px) {
      Eigen::Vector2d from = section->place.ab_from_image * outline.back();
      for (const Eigen::Vector2d& point : outline) {
        const Eigen::Vector2d to = section->place.ab_from_image * point;
        const double length = (to - from).norm();
        along.length_mm += length;
        along.logarithm += length * std::log(std::max(apart_mm(0.5 * (from + to)), kLeastDistance * distance.mean_mm));
        from = to;
      }
    }
  }
  distance.lattice_mm =
      along.length_mm > 0.0 && distance.mean_mm > 0.0 ? std::exp(along.logarithm / along.length_mm) : distance.mean_mm;
  return distance;
}

std::vector<SurfaceSection> surface_sections(const Structure& structure, const FrameLocator& locator,
                                             const std::vector<std::optional<CarriedPlane>>& planes,
                                             const std::vector<SurfaceSection>& before, const std::string& owner,
                                             std::vector<std::string>& warnings) {
  std::vector<SurfaceSection> sections;
  std::vector<int> lost;
  int outlined = 0;
  bool any_area = false;
  for (const FrameMarks& marks : frame_marks(structure, locator)) {
    const auto& place = planes[static_cast<std::size_t>(marks.frame)];
    if (!place) {
      if (!marks.absent) lost.push_back(marks.frame);
      continue;
    }
    if (marks.absent && outlined == 0) continue;
    const auto same = std::find_if(before.begin(), before.end(),
                                   [&marks](const SurfaceSection& section) { return section.marked_as(marks); });
    if (same != before.end()) {
      sections.push_back(*same);
    } else {
      SurfaceSection section;
      section.frame = marks.frame;
      section.place = *place;
      for (const Polygon* outline : marks.outlines) section.outlines_px.push_back(*outline);
      if (marks.extremity_px) section.extremity_px = *marks.extremity_px;
      sections.push_back(std::move(section));
    }
    if (!marks.absent) ++outlined;
    any_area = any_area || even_odd_area(marks.outlines).area_px2 > 0.0;
  }
  while (!sections.empty() && sections.back().absent()) sections.pop_back();
  if (outlined < 2 || !any_area) {
    throw Error(owner + "outlines on at least two frames with a known position make a surface, and there are " +
                std::to_string(outlined) + (outlined >= 2 ? ", none of which encloses an area" : "") +
                "; outline more frames");
  }
  if (!lost.empty()) {
    warnings.push_back(lost_frames_warning(std::move(lost), sections.front().frame, sections.back().frame));
  }
  return sections;
}

double default_spacing_mm(const std::vector<SurfaceSection>& sections) {
  double path_mm = 0.0;
  for (std::size_t i = 1; i < sections.size(); ++i) path_mm += distance_between(sections[i - 1], sections[i]).mean_mm;
  const SurfaceBounds bounds = bounds_of(sections);
  return to_two_digits(std::max((bounds.high - bounds.low).maxCoeff(), path_mm) / kDefaultLayers);
}

void require_gaps(const std::vector<SurfaceSection>& sections, double spacing_mm, const std::string& owner) {
  for (std::size_t i = 1; i < sections.size(); ++i) {
    const SurfaceSection& first = sections[i - 1];
    const SurfaceSection& second = sections[i];
    const std::string frames = "frames " + std::to_string(first.frame) + " and " + std::to_string(second.frame);
    if (first.place.run != second.place.run ||
        first.place.plane.normal().dot(second.place.plane.normal()) < kMinGapCosine) {
      throw Error(owner + frames +
                  " are turned away from each other by more than 120 degrees, so there is no surface between them; "
                  "outline frames in between, or measure the two sweeps apart");
    }
    if (!first.absent() && !second.absent() && distance_between(first, second).largest_mm < kSamePlane * spacing_mm) {
      throw Error(owner + frames + " lie on the same plane; remove the outline of one of them");
    }
  }
}

void make_shapes(std::vector<SurfaceSection>& sections, double spacing_mm) {
  const double cell_mm = spacing_mm / kCellsPerSpacing;
  cv::parallel_for_(cv::Range(0, static_cast<int>(sections.size())), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      SurfaceSection& section = sections[static_cast<std::size_t>(i)];
      if (section.shape) continue;
      if (section.absent()) {
        section.shape = std::make_shared<SectionShape>();
        continue;
      }
      if (section.extremity_px) {
        section.shape = std::make_shared<SectionShape>(section.place.ab_from_image * *section.extremity_px, cell_mm);
        continue;
      }
      std::vector<Polygon> outlines_mm = section.outlines_px;
      for (Polygon& outline : outlines_mm) {
        for (Eigen::Vector2d& point : outline) point = section.place.ab_from_image * point;
      }
      const SectionRaster raster = section_raster(outlines_mm, cell_mm);
      section.shape = std::make_shared<SectionShape>(std::move(outlines_mm), raster);
    }
  });
}

double to_two_digits(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / unit) * unit;
}

}  // namespace fathom
