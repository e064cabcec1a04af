#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/recording.h"

namespace fathom {

/// What a peer sends and a test expects: a recording's frames, over and over, or "WIDTHxHEIGHT" of noise that differs
/// in every frame, with a pose that differs too.
class PeerFrames {
 public:
  explicit PeerFrames(const std::string& what);

  cv::Mat image(int frame) const;

  struct NamedMatrix {
    std::string name;
    Eigen::Matrix4d matrix;
  };
  /// Poses that can be sent: valid ones that a tracker may have measured.
  std::vector<NamedMatrix> poses(int frame) const;

 private:
  std::unique_ptr<Recording> recording_;
  cv::Size size_;
  std::vector<std::uint8_t> noise_;
};

}  // namespace fathom
