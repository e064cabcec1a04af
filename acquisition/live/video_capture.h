#pragma once

#include <memory>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

namespace fathom {

/// What is asked of a camera or frame grabber; a clip has its own. 0: as it is.
struct VideoOptions {
  int width = 0;
  int height = 0;
  double rate_hz = 0.0;
  bool color = false;  ///< RGB; else grey, as B-scans are
};

/// Pictures one after another, from OpenCV's VideoCapture.
///
/// OpenCV's library brings a hundred others for films of all kinds, and takes as long to load as all else of the
/// program. So it is used by a module that is loaded where a video is opened, live/video_module.cpp, and seen through
/// this interface only.
class VideoCapture {
 public:
  virtual ~VideoCapture() = default;

  enum class Outcome { kPicture, kNothingYet, kNoMore };

  /// Takes the next picture, 8 or 16 bits grey or 8 bits RGB, in memory of its own. Waits for it, where the device can
  /// be waited for at most `longest_s`, else as long as OpenCV does. kNoMore: the clip is at its end, the stream cut,
  /// the device gone. Does not throw.
  virtual Outcome next(cv::Mat& picture, double longest_s) = 0;

  /// When the last picture was taken, on the device's clock or in the clip; empty where that is not known.
  virtual std::optional<double> stamp_s() const = 0;

  /// Pictures a second, as stated; 0 where that is not known.
  virtual double rate_hz() const = 0;
};

/// What a video's address names.
enum class VideoKind { kDevice, kFile, kStream };

/// "/dev/video0" and "0" are devices, what has "://" is a stream, all else a file.
inline VideoKind video_kind(const std::string& address) {
  const bool number = address.find_first_not_of("0123456789") == std::string::npos;
  if (number || address.starts_with("/dev/")) return VideoKind::kDevice;
  return address.find("://") != std::string::npos ? VideoKind::kStream : VideoKind::kFile;
}

/// Opens a device, file or stream. Throws Error, beginning with `name`, when that is not possible.
std::unique_ptr<VideoCapture> open_video(const std::string& name, const std::string& address,
                                         const VideoOptions& options);

}  // namespace fathom
