#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "acquisition/recording.h"
#include "core/progress.h"
#include "registration/bright_spots.h"
#include "registration/wire_identification.h"
#include "registration/wire_phantom.h"

namespace fathom {

struct WireDetectionOptions {
  BrightSpotOptions spots;
  WireMatchOptions match;
  /// Width and height of a pixel where they are known beforehand; else they are taken from the pattern.
  std::optional<Eigen::Vector2d> pixel_mm;
  /// Whether wire 0 of every pattern is on the left of the images. Empty: seen from the pattern, if it tells.
  std::optional<bool> wire_0_left;
  int first = 0;                ///< frame
  std::optional<int> last;      ///< frame, inclusive; empty: the last one of the recording
  int orientation_frames = 40;  ///< spread over the recording, that decide on orientation and scale
  /// Throws Error when a value is out of range.
  void check() const;
};

/// What became of a frame.
enum class FrameWires {
  kFound,
  kNoImage,      ///< its image is marked invalid
  kTooFewSpots,  ///< fewer bright spots than the phantom has wires
  kNoMatch,      ///< no spots that could be the phantom's wires
};
inline constexpr std::array kFrameWires = {FrameWires::kFound, FrameWires::kNoImage, FrameWires::kTooFewSpots,
                                           FrameWires::kNoMatch};

/// Wires of a recording, and how they were found.
struct WireDetection {
  std::vector<WirePoint> points;                       ///< in order of frames, patterns and wires
  int first = 0;                                       ///< frame to which `frames[0]` belongs
  std::vector<FrameWires> frames;                      ///< every frame looked at
  Eigen::Vector2d pixel_mm = Eigen::Vector2d::Zero();  ///< width and height, as given or seen from the pattern
  bool wire_0_left = false;                            ///< in the images
  /// The phantom looks the same from both sides, so that the images do not tell which wire of an N is wire 0:
  /// swapping wires 0 and 2 of all points is as good. With a phantom whose place is known, only one of the two is true.
  bool side_unknown = false;

  int count(FrameWires outcome) const;
  int frames_with_wires() const { return count(FrameWires::kFound); }
};

/// Finds the wires of a phantom in every frame of a recording: bright spots, then which spot is which wire.
///
/// Orientation and pixel size are decided from frames spread over the recording, and then hold for all, as a probe does
/// not turn round within a sweep. A frame counts when at least two patterns (all, where there are fewer than three) are
/// whole and every spot agrees with one image plane; spots that are cut off by the edge of the scanned area are left
/// out of `points`. Frames are searched in parallel; the result does not depend on the number of threads.
/// Throws Error for a phantom that is not usable, when no frame shows the phantom, and when the images are upside down
/// or turned by a right angle (the wires are then seen, but not where MF orientation has them); Cancelled.
WireDetection find_wires(const Recording& recording, const WirePhantom& phantom,
                         const WireDetectionOptions& options = {}, const Progress& progress = {});

/// The points of find_wires alone.
std::vector<WirePoint> detect_wires(const Recording& recording, const WirePhantom& phantom,
                                    const WireDetectionOptions& options = {}, const Progress& progress = {});

/// The wires in one image, upright, by itself: `frame` of the points is 0. Empty where they are not found. With a
/// phantom that looks the same from both sides wire 0 is taken to be on the right unless the options say otherwise.
std::vector<WirePoint> detect_wires_in_image(const cv::Mat& image, const WirePhantom& phantom,
                                             const WireDetectionOptions& options = {});

/// For messages and verdicts: "184 of 190 frames show the wires; 4 have too few bright spots; 2 do not fit the
/// phantom".
std::string summary(const WireDetection& detection);

}  // namespace fathom
