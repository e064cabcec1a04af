#include "acquisition/live/video_module.h"

#include <cmath>
#include <cstdlib>
#include <exception>
#include <vector>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

namespace fathom {

namespace {

// What cannot be opened is said once, by this program.
const bool kQuiet = ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0) == 0;

constexpr int kNetwork_ms = 5000;  // to open a stream, and to wait for its next picture

class OpenCvCapture : public VideoCapture {
 public:
  OpenCvCapture(cv::VideoCapture capture, const VideoOptions& options)
      : captures_{std::move(capture)}, color_(options.color), can_wait_(capture_().getBackendName() == "V4L2") {}

  Outcome next(cv::Mat& picture, double longest_s) override {
    try {
      // A device can be waited for once it runs.
      if (can_wait_ && running_ && !wait(longest_s)) return Outcome::kNothingYet;
      if (!capture_().grab()) return Outcome::kNoMore;
      running_ = true;
      note_stamp();
      cv::Mat taken;
      if (!capture_().retrieve(taken) || taken.empty()) return Outcome::kNoMore;
      return convert(taken, picture) ? Outcome::kPicture : Outcome::kNoMore;
    } catch (const std::exception&) {
      return Outcome::kNoMore;
    }
  }

  std::optional<double> stamp_s() const override { return stamp_s_; }

  double rate_hz() const override {
    const double rate_hz = captures_.front().get(cv::CAP_PROP_FPS);
    return std::isfinite(rate_hz) && rate_hz > 0.0 ? rate_hz : 0.0;
  }

 private:
  cv::VideoCapture& capture_() { return captures_.front(); }

  bool wait(double longest_s) {
    std::vector<int> ready;
    try {
      return cv::VideoCapture::waitAny(captures_, ready, static_cast<int64_t>(longest_s * 1e9));
    } catch (const cv::Exception&) {
      can_wait_ = false;  // whether the device is gone shows when it is read
      return true;
    }
  }

  // What a device does not know is 0, or stays as it was.
  void note_stamp() {
    const double stamp_s = capture_().get(cv::CAP_PROP_POS_MSEC) / 1000.0;
    const bool advances = std::isfinite(stamp_s) && stamp_s >= 0.0 && (!last_stamp_s_ || stamp_s > *last_stamp_s_);
    stamp_s_ = advances ? std::optional(stamp_s) : std::nullopt;
    if (advances) last_stamp_s_ = stamp_s;
  }

  bool convert(const cv::Mat& taken, cv::Mat& picture) const {
    cv::Mat converted;  // what was given out before belongs to others
    if (taken.type() == CV_8UC3) {
      cv::cvtColor(taken, converted, color_ ? cv::COLOR_BGR2RGB : cv::COLOR_BGR2GRAY);
    } else if (taken.type() == CV_8UC1 || taken.type() == CV_16UC1) {
      converted = taken.clone();
    } else {
      return false;
    }
    picture = converted;
    return true;
  }

  std::vector<cv::VideoCapture> captures_;  // one: waitAny wants a list
  bool color_;
  bool can_wait_;
  bool running_ = false;
  std::optional<double> stamp_s_;
  std::optional<double> last_stamp_s_;
};

cv::VideoCapture open_capture(const std::string& address) {
  const std::vector<int> patience{cv::CAP_PROP_OPEN_TIMEOUT_MSEC, kNetwork_ms, cv::CAP_PROP_READ_TIMEOUT_MSEC,
                                  kNetwork_ms};
  switch (video_kind(address)) {
    case VideoKind::kDevice:
      if (address.starts_with('/')) return cv::VideoCapture(address, cv::CAP_V4L2);
      return cv::VideoCapture(std::stoi(address), cv::CAP_V4L2);
    case VideoKind::kStream:
      return cv::VideoCapture(address, cv::CAP_FFMPEG, patience);
    case VideoKind::kFile:
      break;
  }
  return cv::VideoCapture(address, cv::CAP_FFMPEG);
}

}  // namespace

}  // namespace fathom

fathom::VideoCapture* fathom_open_video(const std::string& address, const fathom::VideoOptions& options,
                                        std::string& why) {
  try {
    if (fathom::kQuiet) cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    cv::VideoCapture capture = fathom::open_capture(address);
    if (!capture.isOpened()) {
      why = "cannot be opened as a video; check that it is there, may be read, and is not in use";
      return nullptr;
    }
    if (options.width > 0) capture.set(cv::CAP_PROP_FRAME_WIDTH, options.width);
    if (options.height > 0) capture.set(cv::CAP_PROP_FRAME_HEIGHT, options.height);
    if (options.rate_hz > 0.0) capture.set(cv::CAP_PROP_FPS, options.rate_hz);
    return new fathom::OpenCvCapture(std::move(capture), options);
  } catch (const std::exception&) {
    why = "is no video that can be opened; check its address";
    return nullptr;
  }
}
