#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <opencv2/core/mat.hpp>

#include "exam/scan.h"

namespace fathom {

/// Reads frames beside the window's loop, so that no frame waits for a disk. Only the one asked for last is read.
class FrameLoader {
 public:
  struct Frame {
    std::size_t recording = 0;
    int number = 0;
    cv::Mat image;
    std::string error;  ///< why there is no image; empty where there is one
  };

  /// `wake` is called on the reading thread when a frame is there.
  explicit FrameLoader(std::function<void()> wake);
  ~FrameLoader();
  FrameLoader(const FrameLoader&) = delete;
  FrameLoader& operator=(const FrameLoader&) = delete;

  void ask(std::shared_ptr<const Scan> scan, std::size_t recording, int frame);
  /// What was read since.
  std::optional<Frame> take();
  bool busy() const;

 private:
  void run();

  std::function<void()> wake_main_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::shared_ptr<const Scan> scan_;  // of the frame asked for; null: none is
  std::size_t recording_ = 0;
  int frame_ = 0;
  std::optional<Frame> ready_;
  bool reading_ = false;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace fathom
