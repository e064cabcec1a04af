#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace fathom {

/// One frame of a run of frames between two drawn ones, on blocks of pixels; all matrices CV_32FC1 and of one size.
/// Distances are signed, positive inside, in blocks.
struct StackFrame {
  cv::Mat grey;        ///< mean of each block
  cv::Mat seen;        ///< 1 where the image shows something, else 0
  cv::Mat distance;    ///< from the outline: drawn on the first and last frame, predicted on the others
  cv::Mat spread;      ///< standard deviation of the prediction's error; 0 on the first and last frame
  double share = 0.0;  ///< of the way from the first to the last frame, 0 to 1
};

/// What the pixels made of a predicted frame.
struct RefinedFrame {
  cv::Mat distance;  ///< roughly: exact at the outline only
  double expected_error =
      0.0;  ///< area that may be wrong, as a share of twice the structure's own; for comparison only
};

struct StackRefinementOptions {
  double length_blocks = 8.0;   ///< along an outline, over which errors of the prediction are alike
  double window_blocks = 6.0;   ///< within which echoes on one side of the outline are alike
  double length_frames = 0.33;  ///< the same as the first, from frame to frame, as a share of the run
  double evidence = 0.4;        ///< weight of the pixels against the prediction
  int rounds = 24;

  /// Throws Error when a value is not positive and finite.
  void check() const;
};

/// Moves predicted outlines of frames between two drawn ones to where the pixels of the frames say they are.
///
/// How bright the two sides of the outline are, place by place, is learned from the drawn frames, so that neither sign
/// nor strength of an edge is assumed, and an outline that is not visible there pulls nowhere. The outline of all
/// frames together is the most probable one: grey values are normal about the mean of their side, with as many
/// independent ones as the texture's own correlation leaves; the prediction's errors are a Gaussian process of the
/// given spread, smooth along the outline and from frame to frame. Parts may merge, split, appear and vanish.
///
/// `frames` are at least three, the first and the last drawn; the result is for those between. Throws Error as
/// options.check.
std::vector<RefinedFrame> refine_stack(std::span<const StackFrame> frames, const StackRefinementOptions& options);

}  // namespace fathom
