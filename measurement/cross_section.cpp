#include "measurement/cross_section.h"

#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

#include "measurement/frame_marks.h"
#include "measurement/lost_frames.h"
#include "measurement/marked_sections.h"
#include "segmentation/frame_list.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

// Signed area and its first moments about `origin_px`.
struct Moments {
  double area = 0.0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
};

Moments shoelace(const Polygon& polygon, const Eigen::Vector2d& origin_px) {
  Moments moments;
  Eigen::Vector2d before = polygon.back() - origin_px;
  for (const Eigen::Vector2d& point : polygon) {
    const Eigen::Vector2d now = point - origin_px;
    const double twice = before.x() * now.y() - before.y() * now.x();
    moments.area += 0.5 * twice;
    moments.first += twice / 6.0 * (before + now);
    before = now;
  }
  return moments;
}

Eigen::Vector2d mean_point(const std::vector<const Polygon*>& polygons) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  std::size_t count = 0;
  for (const Polygon* polygon : polygons) {
    for (const Eigen::Vector2d& point : *polygon) sum += point;
    count += polygon->size();
  }
  return sum / static_cast<double>(count);
}

}  // namespace

void measure_way(std::vector<CrossSection>& sections, const FrameLocator& locator) {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  for (const CrossSection& section : sections) pixel += section.centroid_px;
  pixel /= std::max(1.0, static_cast<double>(sections.size()));
  std::optional<Eigen::Vector3d> before;
  double along_mm = 0.0;
  for (CrossSection& section : sections) {
    const Eigen::Vector3d here =
        *locator.reference_from_image(section.frame) * Eigen::Vector3d(pixel.x(), pixel.y(), 0.0);
    if (before) along_mm += (here - *before).norm();
    section.along_mm = along_mm;
    before = here;
  }
}

PlaneArea even_odd_area(const std::vector<const Polygon*>& polygons) {
  PlaneArea result;
  if (polygons.empty()) return result;
  const std::vector<Nesting> nested = nesting(polygons);
  // About a point of the outline: moments about a far origin lose digits.
  const Eigen::Vector2d origin = polygons.front()->front();
  Moments sum;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (nested[i] == Nesting::kCoincident) continue;
    const Moments moments = shoelace(*polygons[i], origin);
    const double sign = (nested[i] == Nesting::kHole) == (moments.area < 0.0) ? 1.0 : -1.0;
    sum.area += sign * moments.area;
    sum.first += sign * moments.first;
  }
  if (!(sum.area > 0.0)) {
    result.centroid_px = mean_point(polygons);
    return result;
  }
  result.area_px2 = sum.area;
  result.centroid_px = origin + sum.first / sum.area;
  return result;
}

std::vector<CrossSection> cross_sections(const Structure& structure, const FrameLocator& locator,
                                         std::vector<std::string>* warnings) {
  return cross_sections(frame_marks(structure, locator), locator, warnings);
}

std::vector<CrossSection> cross_sections(std::span<const FrameMarks> all, const FrameLocator& locator,
                                         std::vector<std::string>* warnings) {
  std::vector<CrossSection> sections;
  std::vector<int> lost;
  std::vector<int> absent;
  for (const FrameMarks& marks : all) {
    if (marks.absent) {
      absent.push_back(marks.frame);
      continue;
    }
    PlaneArea area;
    if (marks.extremity_px) {
      area.centroid_px = *marks.extremity_px;
    } else {
      area = even_odd_area(marks.outlines);
    }
    const auto reference_from_image = locator.reference_from_image(marks.frame);
    if (!reference_from_image) {
      lost.push_back(marks.frame);
      continue;
    }
    // The area of one square pixel, along the frame's own normal, whichever way the contour was drawn.
    const Eigen::Vector3d pixel = reference_from_image->linear().col(0).cross(reference_from_image->linear().col(1));
    CrossSection section;
    section.frame = marks.frame;
    section.normal = pixel.normalized();
    section.vector_area_mm2 = area.area_px2 * pixel;
    section.centroid_mm = *reference_from_image * Eigen::Vector3d(area.centroid_px.x(), area.centroid_px.y(), 0.0);
    section.centroid_px = area.centroid_px;
    sections.push_back(section);
  }
  measure_way(sections, locator);
  if (!lost.empty() && warnings) {
    // Where no frame is left at all, none lies before the first.
    const int first = sections.empty() ? lost.front() : sections.front().frame;
    const int last = sections.empty() ? lost.back() : sections.back().frame;
    warnings->push_back(lost_frames_warning(std::move(lost), first, last));
  }
  std::erase_if(absent, [&](int frame) {
    return sections.empty() || frame < sections.front().frame || frame > sections.back().frame;
  });
  if (!absent.empty() && warnings) {
    warnings->push_back(frame_list(std::move(absent)) +
                        " marked as absent between outlines: planimetry measures on across them, a surface does not");
  }
  return sections;
}

}  // namespace fathom
