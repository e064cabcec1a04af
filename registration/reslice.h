#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/progress.h"
#include "registration/fan_mask.h"
#include "registration/frame_locator.h"
#include "registration/partition.h"
#include "registration/reslice_frames.h"
#include "registration/reslice_surface.h"
#include "registration/sweep.h"

namespace fathom {

/// What a pixel of a picture shows.
enum class ResliceMode {
  kNearest,  ///< the pixel of the nearer of the two frames around it; across a slab as kMean
  kLinear,   ///< bilinear in both frames, weighted by the distances from them; across a slab as kMean
  kMean,     ///< the mean of the linear values across a slab
  kMax,      ///< the largest of the nearest pixels across a slab
};

/// What may be used of the frames. Fixed for a Reslicer.
struct ReslicerOptions {
  std::optional<cv::Rect> clip;  ///< the part of the images that is used; all of it where empty
  std::optional<Fan> fan;        ///< of that, what a curved probe shows; all of it where empty
  /// Between two frames that are farther apart nothing is shown. By default four times the distance within which half
  /// of the sweep's way lies: the hand may hurry, but what it left out stays a hole.
  std::optional<double> max_gap_mm;
  double max_frame_bytes = 64.0 * (1 << 20);  ///< of decoded frames that are held at once; at least two are

  /// Throws Error when a number is out of its range.
  void check() const;
};

struct ResliceOptions {
  static constexpr int kMaxLayers = 4096;

  ResliceMode mode = ResliceMode::kNearest;
  /// Of a slab about the surface. It is cut into layers no farther apart than pixels, and the picture shows what they
  /// have on average, or at most. 0: the surface alone.
  double thickness_mm = 0.0;

  /// Throws Error when the thickness is negative or takes more than kMaxLayers.
  void check(double spacing_mm) const;
};

/// A picture, and which of its pixels show something. The others are 0: nothing is made up between frames too far
/// apart, outside of the images, before the first frame or after the last.
struct Resliced {
  cv::Mat picture;  ///< of the recording's pixel type
  cv::Mat covered;  ///< CV_8U, of the same size: 255 where there is a value, else 0

  double covered_share() const;
};

/// Pictures of any plane or surface through a recording, straight from its B-scans: every pixel is interpolated once,
/// from the two frames of a sweep that enclose it, on each of which it is projected. Treece 2000, section 1.3.
///
/// A pixel lies between two successive frames where its signed distances to their planes differ in sign, their normals
/// turned to one side. It is shown where it projects into both images. Where several pairs of frames enclose it, the
/// pair with the smallest sum of distances is taken. A pixel that no pair encloses, but that lies within half a pixel
/// of a frame's plane, shows that frame: so a picture in the plane of a frame is that frame, the first and last too.
class Reslicer {
 public:
  /// `recording` is kept by reference, `locator` is its. Each of `sweeps` is used by itself. Throws Error for images
  /// that are not grey integers of 8 or 16 bits, sweeps that are not in the recording or have no valid frame, options
  /// that are out of range, and a clip rectangle that leaves nothing.
  Reslicer(const Recording& recording, const FrameLocator& locator, const std::vector<Sweep>& sweeps,
           const ReslicerOptions& options = {});

  /// With `partition`, which has the same sweeps, every pixel is taken from the sweep of its part of space; without,
  /// from the sweep whose frames are closest about it. The same bytes for any number of threads. Frames are read in
  /// their order, those that are needed, once for every 16 layers of a slab. Throws Error as the checks of its
  /// arguments and Recording::image;
  /// Cancelled.
  Resliced reslice(const ResliceSurface& surface, const ResliceOptions& options = {},
                   const SpacePartition* partition = nullptr, const Progress& progress = {}) const;

  /// The frames of all sweeps.
  const ResliceFrames& frames() const { return frames_; }

 private:
  const Recording& recording_;
  ResliceFrames frames_;
  double max_frame_bytes_;
};

}  // namespace fathom
