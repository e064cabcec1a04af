#include "acquisition/recording.h"

#include <algorithm>

#include <opencv2/core.hpp>

#include "acquisition/header_text.h"
#include "core/error.h"

namespace fathom {

std::optional<std::size_t> RecordingHeader::transform_index(const std::string& name) const {
  const auto found = std::find(transforms.begin(), transforms.end(), name);
  if (found == transforms.end()) return std::nullopt;
  return static_cast<std::size_t>(found - transforms.begin());
}

void Recording::require_frame(int frame) const {
  if (!header_.has_images()) fail("has no images, only poses; give a recording with images");
  if (frame < 0 || frame >= header_.frame_count()) {
    fail("has no frame " + std::to_string(frame) + "; its frames are 0 to " +
         std::to_string(header_.frame_count() - 1));
  }
}

void Recording::fail(const std::string& what) const {
  constexpr std::size_t kLongestName = 300;
  throw Error(printable(name_, kLongestName) + ": " + what);
}

MemoryRecording::MemoryRecording(std::string name, RecordingHeader header, std::vector<cv::Mat> images)
    : Recording(std::move(name), std::move(header)), images_(std::move(images)) {
  for (std::size_t f = 0; f < header_.frames.size(); ++f) {
    if (header_.frames[f].poses.size() != header_.transforms.size()) {
      fail("frame " + std::to_string(f) + " has not one pose for each transform");
    }
  }
  if (images_.size() != (header_.has_images() ? header_.frames.size() : 0)) {
    fail("has " + std::to_string(images_.size()) + " images for " + std::to_string(header_.frames.size()) + " frames");
  }
  for (std::size_t f = 0; f < images_.size(); ++f) {
    if (images_[f].size() != cv::Size(header_.width, header_.height) || images_[f].type() != header_.pixel_type) {
      fail("the image of frame " + std::to_string(f) + " has another size or type than the recording");
    }
  }
}

cv::Mat MemoryRecording::image(int frame) const {
  require_frame(frame);
  return images_[static_cast<std::size_t>(frame)];
}

}  // namespace fathom
