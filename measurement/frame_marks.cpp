#include "measurement/frame_marks.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "core/error.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

// Names the structure and the frame in what goes wrong.
class Complaint {
 public:
  Complaint(const Structure& structure, const std::string& recording, int frame_count)
      : structure_(structure), recording_(recording), frame_count_(frame_count) {}

  [[noreturn]] void about(int frame, const std::string& what) const {
    throw Error(recording_ + ": structure " + structure_.name + ", frame " + std::to_string(frame) + ": " + what);
  }

  void require_place(int frame, int recording) const {
    if (recording != 0) {
      about(frame, "stands on recording " + std::to_string(recording) +
                       " of an exam; give the contours that were drawn on this recording alone");
    }
    if (frame < 0 || frame >= frame_count_) {
      about(frame, "is not in the recording, which has " + std::to_string(frame_count_) +
                       " frames, numbered from 0; give the contours that were drawn on this recording");
    }
  }

 private:
  const Structure& structure_;
  const std::string& recording_;
  int frame_count_;
};

}  // namespace

std::vector<FrameMarks> frame_marks(const Structure& structure, const FrameLocator& locator) {
  return frame_marks(structure, locator.recording_name(), locator.frame_count());
}

std::vector<FrameMarks> frame_marks(const Structure& structure, const std::string& recording, int frame_count) {
  const Complaint complaint(structure, recording, frame_count);
  const std::size_t contours = structure.contours.size();
  const std::size_t extremities = structure.extremities.size();
  std::vector<std::pair<int, std::size_t>> order;  // frame and number: contours, then extremities, then absences
  order.reserve(contours + extremities + structure.absent.size());
  for (const Contour& contour : structure.contours) {
    complaint.require_place(contour.frame, contour.recording);
    if (!contour.closed) {
      complaint.about(contour.frame,
                      "its contour is open and encloses no area; close it, leave it out, or place dividing planes if "
                      "another sweep shows the rest");
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
  for (const AbsentMark& absent : structure.absent) {
    complaint.require_place(absent.frame, absent.recording);
    order.emplace_back(absent.frame, order.size());
  }
  std::sort(order.begin(), order.end());

  std::vector<FrameMarks> marks;
  for (const auto& [frame, number] : order) {
    const bool fresh = marks.empty() || marks.back().frame != frame;
    if (fresh) marks.push_back({frame, {}, nullptr, false});
    if (number < contours) {
      marks.back().outlines.push_back(&structure.contours[number].points_px);
    } else if (number < contours + extremities) {
      if (!fresh) {
        complaint.about(frame, "is marked as an extremity, but has something else too; keep one of them");
      }
      marks.back().extremity_px = &structure.extremities[number - contours].point_px;
    } else {
      if (!fresh && !marks.back().absent) {
        complaint.about(frame, "is marked as absent, but has something else too; keep one of them");
      }
      marks.back().absent = true;
    }
  }
  for (const FrameMarks& mark : marks) {
    if (const auto fault = outline_fault(mark.outlines)) {
      complaint.about(mark.frame, "its outline " + *fault + "; draw it again");
    }
  }
  return marks;
}

}  // namespace fathom
