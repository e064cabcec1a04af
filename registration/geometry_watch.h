#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "acquisition/live/live_session.h"
#include "registration/image_shape.h"

namespace fathom {

struct GeometryWatchOptions {
  int first_frames = 30;   ///< from which the picture is learnt
  int window_frames = 30;  ///< that are looked at together
};

/// Watches that frames keep the geometry that the calibration is of. A change stops its use for good: a pose of pixels
/// at another depth would be wrong without looking so.
///
/// Seen are: another size or type of the pictures; a depth that the source states with its frames (a field whose name
/// contains "depth") and that differs from the first by 0.5 %; echoes where the scanner drew its frame before; scan
/// lines of a fan that meet elsewhere, by a depth 5 % larger; both ends of a rectangle's upper edge drawn in. The last
/// three must be so in two windows of frames in succession. A lifted probe and shadows leave all that as it is; a
/// picture that is dark or stands still proves nothing. Not seen is a depth that changes nothing of the shape, such as
/// that of a rectangle drawn as wide as before, where the source does not state it.
class GeometryWatch {
 public:
  explicit GeometryWatch(const GeometryWatchOptions& options = {}) : options_(options) {}

  /// Looks at the next frame; keeps no copy of it. Returns fault().
  const std::optional<std::string>& add(const LiveFrame& frame);

  /// Why the calibration is not to be used any more, for the user; empty while it may be.
  const std::optional<std::string>& fault() const { return fault_; }

  /// Time stamp of the first frame that may have the other geometry, where there is a fault(): that of the frame that
  /// states it, or the start of the last window that looked as before.
  double since_s() const { return since_s_; }

  /// What was learnt of the picture; empty before that, and where it moved too little.
  const std::optional<ImageShape>& shape() const { return shape_; }

 private:
  void check_fields(const LiveFrame& frame);
  void learn();
  bool differs();
  bool lit_around(const cv::Mat& largest) const;
  bool fan_moved(const std::optional<ImageShape>& now);
  bool face_drawn_in(const cv::Mat& largest) const;

  GeometryWatchOptions options_;
  std::optional<std::string> fault_;
  cv::Size size_;
  int type_ = 0;
  int frames_ = 0;
  std::map<std::string, double> depths_;
  std::optional<ImageShape> shape_;
  std::optional<double> moved_radius_px_;  // of the window before, where its fan differed
  cv::Mat inside_, around_;                // 255: within the shape; well outside
  cv::Mat background_;                     // the brightest of what was learnt, grey
  ImageShapeFinder window_;                // the frames of this window
  int windows_off_ = 0;
  std::array<double, 3> window_starts_s_ = {};  // time stamps: of the window before the last, the last, and this one
  double since_s_ = 0.0;
};

/// For SessionOptions::watch_geometry. The session's thread alone calls `watch` until the session has stopped.
std::function<std::optional<GeometryFault>(const LiveFrame&)> watching(std::shared_ptr<GeometryWatch> watch);

}  // namespace fathom
