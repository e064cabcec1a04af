#include "registration/frame_geometry.h"

#include <string>

#include "core/error.h"

namespace fathom {

std::vector<PlacedFrame> placed_frames(const Recording& recording, const FrameLocator& locator, const Sweep& sweep) {
  const RecordingHeader& header = recording.header();
  if (sweep.first < 0 || sweep.last < sweep.first || sweep.last >= header.frame_count()) {
    throw Error(recording.name() + ": has no sweep from frame " + std::to_string(sweep.first) + " to " +
                std::to_string(sweep.last) + "; its frames are 0 to " + std::to_string(header.frame_count() - 1));
  }
  std::vector<PlacedFrame> frames;
  for (int f = sweep.first; f <= sweep.last; ++f) {
    if (!header.frames[static_cast<std::size_t>(f)].image_valid()) continue;
    if (const auto placed = locator.reference_from_image(f)) frames.push_back({f, *placed});
  }
  return frames;
}

std::vector<PlacedFrame> placed_frames(const Recording& recording, const FrameLocator& locator) {
  if (recording.header().frame_count() == 0) return {};
  return placed_frames(recording, locator, {0, 0, recording.header().frame_count() - 1});
}

void require_grey_integers(const Recording& recording) {
  const RecordingHeader& header = recording.header();
  if (!header.has_images()) throw Error(recording.name() + ": has no images, only poses; give a recording with images");
  if (CV_MAT_CN(header.pixel_type) != 1) {
    throw Error(recording.name() + ": is in colour, and this needs grey values; convert it to grey first");
  }
  if (CV_MAT_DEPTH(header.pixel_type) > CV_16S) {
    throw Error(recording.name() + ": its pixels are not integers of 8 or 16 bits; convert it to 16 bits first");
  }
}

Eigen::Vector3d frame_normal(const Eigen::Affine3d& reference_from_image) {
  return reference_from_image.linear().col(0).cross(reference_from_image.linear().col(1)).normalized();
}

double pixel_size_mm(const Eigen::Affine3d& reference_from_image) {
  return 0.5 * (reference_from_image.linear().col(0).norm() + reference_from_image.linear().col(1).norm());
}

Eigen::AlignedBox3d box_around(const std::vector<PlacedFrame>& frames, cv::Point first, cv::Point last) {
  Eigen::AlignedBox3d box;
  for (const PlacedFrame& frame : frames) {
    for (const int x : {first.x, last.x}) {
      for (const int y : {first.y, last.y}) box.extend(frame.reference_from_image * Eigen::Vector3d(x, y, 0.0));
    }
  }
  return box;
}

}  // namespace fathom
