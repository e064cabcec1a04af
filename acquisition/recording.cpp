#include "acquisition/recording.h"

#include <algorithm>

namespace fathom {

std::optional<std::size_t> RecordingHeader::transform_index(const std::string& name) const {
  const auto found = std::find(transforms.begin(), transforms.end(), name);
  if (found == transforms.end()) return std::nullopt;
  return static_cast<std::size_t>(found - transforms.begin());
}

void Recording::require_frame(int frame) const {
  if (!header_.has_images()) throw Error(name_ + ": has no images, only poses; give a recording with images");
  if (frame < 0 || frame >= header_.frame_count()) {
    throw Error(name_ + ": has no frame " + std::to_string(frame) + "; its frames are 0 to " +
                std::to_string(header_.frame_count() - 1));
  }
}

MemoryRecording::MemoryRecording(std::string name, RecordingHeader header, std::vector<cv::Mat> images)
    : Recording(std::move(name), std::move(header)), images_(std::move(images)) {}

cv::Mat MemoryRecording::image(int frame) const {
  require_frame(frame);
  return images_[static_cast<std::size_t>(frame)];
}

}  // namespace fathom
