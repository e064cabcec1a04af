#include "segmentation/threshold_recording.h"

#include <cstddef>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/error.h"

namespace fathom {

void ThresholdRecordingOptions::check() const {
  threshold.check();
  if (every < 1) throw Error("every: must be at least 1; 1 outlines all frames, 10 every tenth");
  if (const auto fault = name_fault(structure)) throw Error("name of the structure: " + *fault + "; choose another");
}

namespace {

bool image_valid(const Recording& recording, int frame) {
  return recording.header().frames[static_cast<std::size_t>(frame)].image_valid();
}

// Adds the contours of one frame. Returns whether there were any.
bool outline_frame(const Recording& recording, const ThresholdOptions& threshold, int frame, Structure& structure) {
  if (!image_valid(recording, frame)) return false;
  std::vector<Polygon> outlines = threshold_outlines(recording.image(frame), threshold);
  for (Polygon& outline : outlines) {
    Contour contour;
    contour.frame = frame;
    contour.points_px = std::move(outline);
    structure.contours.push_back(std::move(contour));
  }
  return !outlines.empty();
}

// From the outermost outlined frame outwards, the last frame that still shows the structure is outlined too. The
// next of the regular frames is known not to show it.
void outline_end(const Recording& recording, const ThresholdOptions& threshold, int every, bool front,
                 Structure& structure) {
  if (structure.contours.empty()) return;
  const int from = front ? structure.contours.front().frame : structure.contours.back().frame;
  const int step = front ? -1 : 1;
  Structure outermost;
  for (int i = 1; i < every; ++i) {
    const int frame = from + step * i;
    if (frame < 0 || frame >= recording.header().frame_count()) break;
    if (!image_valid(recording, frame)) continue;  // says nothing about where the structure ends
    Structure here;
    if (!outline_frame(recording, threshold, frame, here)) break;
    outermost = std::move(here);
  }
  auto& all = structure.contours;
  all.insert(front ? all.begin() : all.end(), std::make_move_iterator(outermost.contours.begin()),
             std::make_move_iterator(outermost.contours.end()));
}

}  // namespace

Structure segment_by_threshold(const Recording& recording, const ThresholdRecordingOptions& options,
                               const Progress& progress) {
  options.check();
  const RecordingHeader& header = recording.header();
  if (!header.has_images()) throw Error(recording.name() + ": has no images, only poses; give a recording with images");
  if (CV_MAT_CN(header.pixel_type) != 1) {
    throw Error(recording.name() + ": is in colour, and a threshold needs grey values; convert it to grey first");
  }
  Structure structure;
  structure.name = options.structure;
  const int count = header.frame_count();
  int frame = 0;
  while (frame < count && !image_valid(recording, frame)) ++frame;
  for (; frame < count; frame += options.every) {
    report(progress, static_cast<double>(frame) / count);
    outline_frame(recording, options.threshold, frame, structure);
    if (count - frame <= options.every) break;  // a large step must not overflow
  }
  if (options.ends) {
    outline_end(recording, options.threshold, options.every, true, structure);
    outline_end(recording, options.threshold, options.every, false, structure);
  }
  report(progress, 1.0);
  return structure;
}

int outlined_frames(const Structure& structure) {
  std::set<std::pair<int, int>> frames;
  for (const Contour& contour : structure.contours) frames.insert({contour.recording, contour.frame});
  return static_cast<int>(frames.size());
}

}  // namespace fathom
