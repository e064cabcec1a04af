#include "measurement/cross_section.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

#include "core/error.h"
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

// What a structure has on one frame: outlines, or the point of an extremity.
struct FrameMarks {
  int frame = 0;
  std::vector<const Polygon*> outlines;
  const Eigen::Vector2d* extremity_px = nullptr;
};

// Names the structure and the frame in what goes wrong.
class Complaint {
 public:
  Complaint(const Structure& structure, const FrameLocator& locator) : structure_(structure), locator_(locator) {}

  [[noreturn]] void about(int frame, const std::string& what) const {
    throw Error(locator_.recording_name() + ": structure " + structure_.name + ", frame " + std::to_string(frame) +
                ": " + what);
  }

  void require_place(int frame, int recording) const {
    if (recording != 0) {
      about(frame, "stands on recording " + std::to_string(recording) +
                       " of an exam; give the contours that were drawn on this recording alone");
    }
    if (frame < 0 || frame >= locator_.frame_count()) {
      about(frame, "is not in the recording, which has " + std::to_string(locator_.frame_count()) +
                       " frames, numbered from 0; give the contours that were drawn on this recording");
    }
  }

 private:
  const Structure& structure_;
  const FrameLocator& locator_;
};

// Frames ascending.
std::vector<FrameMarks> marks_by_frame(const Structure& structure, const Complaint& complaint) {
  std::vector<std::pair<int, std::size_t>> order;  // frame and number: contours first, then extremities
  order.reserve(structure.contours.size() + structure.extremities.size());
  for (const Contour& contour : structure.contours) {
    complaint.require_place(contour.frame, contour.recording);
    if (!contour.closed) {
      complaint.about(contour.frame, "its contour is open and encloses no area; close it, or leave it out");
    }
    if (contour.points_px.size() < 3) {
      complaint.about(contour.frame, "its contour has fewer than three points; draw it again");
    }
    order.emplace_back(contour.frame, order.size());
  }
  for (const Extremity& extremity : structure.extremities) {
    complaint.require_place(extremity.frame, extremity.recording);
    order.emplace_back(extremity.frame, order.size());
  }
  std::sort(order.begin(), order.end());

  std::vector<FrameMarks> marks;
  for (const auto& [frame, number] : order) {
    const bool fresh = marks.empty() || marks.back().frame != frame;
    if (fresh) marks.push_back({frame, {}, nullptr});
    if (number < structure.contours.size()) {
      marks.back().outlines.push_back(&structure.contours[number].points_px);
    } else if (fresh) {
      marks.back().extremity_px = &structure.extremities[number - structure.contours.size()].point_px;
    } else {
      complaint.about(frame, "is marked as an extremity, but has something else too; keep one of them");
    }
  }
  return marks;
}

// Frames lost on the way are made good by their neighbours; at the ends nothing stands for them.
std::string lost_warning(const std::vector<CrossSection>& sections, std::vector<int> lost) {
  const bool start = !sections.empty() && lost.front() < sections.front().frame;
  const bool end = !sections.empty() && lost.back() > sections.back().frame;
  std::string text = frame_list(std::move(lost)) + " left out: no valid position is known there";
  if (start || end) text += ", so the organ is not measured";
  if (start) text += " before frame " + std::to_string(sections.front().frame);
  if (end) text += std::string(start ? " nor" : "") + " beyond frame " + std::to_string(sections.back().frame);
  return text;
}

}  // namespace

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
  const Complaint complaint(structure, locator);
  std::vector<CrossSection> sections;
  std::vector<int> lost;
  for (const FrameMarks& marks : marks_by_frame(structure, complaint)) {
    PlaneArea area;
    if (marks.extremity_px) {
      area.centroid_px = *marks.extremity_px;
    } else {
      if (const auto fault = outline_fault(marks.outlines)) {
        complaint.about(marks.frame, "its outline " + *fault + "; draw it again");
      }
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
    sections.push_back(section);
  }
  if (!lost.empty() && warnings) {
    warnings->push_back(lost_warning(sections, std::move(lost)));
  }
  return sections;
}

}  // namespace fathom
