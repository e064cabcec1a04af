#include "segmentation/stack_refinement.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string>

#include <opencv2/imgproc.hpp>

#include "core/error.h"

namespace fathom {

namespace {

constexpr double kBandOfWindow = 1.5;  // how far from an outline its sides are looked at, in windows
constexpr double kFewBlocks = 0.08;    // share of a window that counts as much as what is known of the whole outline
constexpr double kClip = 2.5;          // standard deviations: brighter and darker echoes say no more than this
constexpr double kFirstBlur_blocks = 5.0;  // the outline is looked for from coarse to fine
constexpr double kLastBlur_blocks = 1.2;
constexpr double kLargestMove_blocks = 0.6;  // of an outline in one round
constexpr double kGain = 0.5;                // of the way to where a round's evidence points
constexpr double kContrastOfBorder = 0.6;    // of the learned contrast: an outline that has less is at no border
constexpr int kCorrelationReach = 5;         // blocks, beyond which speckle is not alike

cv::Mat blurred(const cv::Mat& values, double sigma) {
  cv::Mat result;
  cv::GaussianBlur(values, result, cv::Size(0, 0), sigma, sigma, cv::BORDER_CONSTANT);
  return result;
}

/// Mean grey of each side of an outline around every block, and how much there is of it (0 to 1).
struct Sides {
  cv::Mat inside, outside, inside_weight, outside_weight;
};

Sides sides_of(const StackFrame& frame, const cv::Mat& distance, double window) {
  cv::Mat in(distance.size(), CV_32FC1);
  cv::Mat out(distance.size(), CV_32FC1);
  const auto band = static_cast<float>(kBandOfWindow * window);
  for (int y = 0; y < distance.rows; ++y) {
    for (int x = 0; x < distance.cols; ++x) {
      const float d = distance.at<float>(y, x);
      const float seen = frame.seen.at<float>(y, x) * (std::abs(d) < band ? 1.0F : 0.0F);
      const float part = std::clamp(0.5F + 0.5F * d, 0.0F, 1.0F);
      in.at<float>(y, x) = seen * part;
      out.at<float>(y, x) = seen * (1.0F - part);
    }
  }
  Sides sides;
  sides.inside_weight = blurred(in, window);
  sides.outside_weight = blurred(out, window);
  cv::divide(blurred(in.mul(frame.grey), window), cv::max(sides.inside_weight, 1e-6), sides.inside);
  cv::divide(blurred(out.mul(frame.grey), window), cv::max(sides.outside_weight, 1e-6), sides.outside);
  return sides;
}

/// What a drawn frame teaches.
struct Lesson {
  bool any_inside = false;
  cv::Mat contrast;       ///< inside less outside around every block, grey values
  double variance = 0.0;  ///< of the grey values about the mean of their side
  double alike = 1.0;     ///< blocks that vary together
};

/// Sum of the correlations of `residual` over neighbouring blocks: how many of them count as one.
double correlated_blocks(const cv::Mat& residual, const cv::Mat& mask) {
  const double own = residual.dot(residual) / std::max(1.0, mask.dot(mask));
  if (own <= 0.0) return 1.0;
  double sum = 0.0;
  for (int dy = -kCorrelationReach; dy <= kCorrelationReach; ++dy) {
    for (int dx = -kCorrelationReach; dx <= kCorrelationReach; ++dx) {
      const cv::Rect here(std::max(0, dx), std::max(0, dy), residual.cols - std::abs(dx), residual.rows - std::abs(dy));
      if (here.width <= 0 || here.height <= 0) continue;
      const cv::Rect there(here.x - dx, here.y - dy, here.width, here.height);
      const double count = mask(here).dot(mask(there));
      if (count < 1.0) continue;
      sum += std::max(0.0, residual(here).dot(residual(there)) / count / own);
    }
  }
  return std::max(1.0, sum);
}

Lesson lesson_of(const StackFrame& frame, double window) {
  const Sides sides = sides_of(frame, frame.distance, window);
  const cv::Size size = frame.distance.size();
  const auto band = static_cast<float>(kBandOfWindow * window);
  cv::Mat residual(size, CV_32FC1, cv::Scalar(0));
  cv::Mat mask(size, CV_32FC1, cv::Scalar(0));
  double inside = 0.0;
  double outside = 0.0;
  double weights = 1e-9;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float d = frame.distance.at<float>(y, x);
      if (std::abs(d) >= band || frame.seen.at<float>(y, x) == 0.0F) continue;
      mask.at<float>(y, x) = 1.0F;
      const cv::Mat& mean = d > 0.0F ? sides.inside : sides.outside;
      residual.at<float>(y, x) = frame.grey.at<float>(y, x) - mean.at<float>(y, x);
      const double weight = std::min(sides.inside_weight.at<float>(y, x), sides.outside_weight.at<float>(y, x));
      inside += weight * sides.inside.at<float>(y, x);
      outside += weight * sides.outside.at<float>(y, x);
      weights += weight;
    }
  }
  Lesson lesson;
  lesson.any_inside = cv::countNonZero((frame.distance > 0.0F) & (frame.seen > 0.0F)) > 0;
  lesson.variance = residual.dot(residual) / std::max(1.0, mask.dot(mask));
  lesson.alike = correlated_blocks(residual, mask);
  const double whole = (inside - outside) / weights;
  lesson.contrast.create(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double weight = std::min(sides.inside_weight.at<float>(y, x), sides.outside_weight.at<float>(y, x));
      const double here = static_cast<double>(sides.inside.at<float>(y, x)) - sides.outside.at<float>(y, x);
      lesson.contrast.at<float>(y, x) =
          static_cast<float>((weight * here + kFewBlocks * whole) / (weight + kFewBlocks));
    }
  }
  return lesson;
}

/// What is known of one frame between, and what is found.
struct Working {
  const StackFrame* frame = nullptr;
  cv::Mat contrast;
  cv::Mat evidence;  ///< log of how much more probable inside is than outside, per block
  cv::Mat white;     ///< the displacement, whitened
  cv::Mat distance;
};

class Refinement {
 public:
  Refinement(std::span<const StackFrame> frames, const StackRefinementOptions& options) : options_(options) {
    const Lesson first = lesson_of(frames.front(), options.window_blocks);
    const Lesson last = lesson_of(frames.back(), options.window_blocks);
    variance_ = std::max(1e-3, 0.5 * (first.variance + last.variance));
    alike_ = 0.5 * (first.alike + last.alike);
    for (const StackFrame& frame : frames.subspan(1, frames.size() - 2)) {
      Working work;
      work.frame = &frame;
      // A frame without the structure teaches nothing.
      const double share = !first.any_inside ? 1.0 : !last.any_inside ? 0.0 : frame.share;
      cv::addWeighted(first.contrast, 1.0 - share, last.contrast, share, 0.0, work.contrast);
      work.white = cv::Mat::zeros(frame.distance.size(), CV_32FC1);
      work.distance = frame.distance.clone();
      frames_.push_back(std::move(work));
    }
    length_frames_ = std::max(0.4, options.length_frames * static_cast<double>(frames.size() - 1));
  }

  std::vector<RefinedFrame> run() {
    for (int round = 0; round < options_.rounds; ++round) {
      const double done = static_cast<double>(round) / std::max(1, options_.rounds - 1);
      const double blur = kFirstBlur_blocks * std::pow(kLastBlur_blocks / kFirstBlur_blocks, std::min(1.0, 1.3 * done));
      if (round % 5 == 0) {
        for (Working& work : frames_) weigh(work);
      }
      move(blur);
    }
    std::vector<RefinedFrame> result;
    for (const Working& work : frames_) result.push_back({work.distance, expected_error(work)});
    return result;
  }

 private:
  void weigh(Working& work) const {
    const Sides sides = sides_of(*work.frame, work.distance, options_.window_blocks);
    const cv::Size size = work.distance.size();
    work.evidence.create(size, CV_32FC1);
    const double clip = kClip * std::sqrt(variance_);
    const double scale = options_.evidence / (variance_ * alike_);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const double contrast = work.contrast.at<float>(y, x);
        const double w_in = sides.inside_weight.at<float>(y, x);
        const double w_out = sides.outside_weight.at<float>(y, x);
        // Half-way between the sides, as each of them tells it.
        const double middle = (w_in * (sides.inside.at<float>(y, x) - 0.5 * contrast) +
                               w_out * (sides.outside.at<float>(y, x) + 0.5 * contrast)) /
                              std::max(1e-6, w_in + w_out);
        const double off = std::clamp(work.frame->grey.at<float>(y, x) - middle, -clip, clip);
        const double known = work.frame->seen.at<float>(y, x) * (w_in + w_out > 1e-4 ? 1.0 : 0.0);
        work.evidence.at<float>(y, x) = static_cast<float>(known * scale * contrast * off);
      }
    }
  }

  /// Convolution with the root of the displacement's correlation, which has the value 1 at no distance.
  std::vector<cv::Mat> rooted(const std::vector<cv::Mat>& fields) const {
    const double sigma = options_.length_blocks / std::numbers::sqrt2;
    const double gain = 2.0 * std::sqrt(std::numbers::pi) * sigma;  // so that twice has 1 in the middle
    std::vector<cv::Mat> in_plane;
    for (const cv::Mat& field : fields) in_plane.push_back(blurred(field, sigma) * gain);
    const double sigma_frames = length_frames_ / std::numbers::sqrt2;
    std::vector<double> kernel;
    double squares = 0.0;
    for (int k = 0; k <= static_cast<int>(std::ceil(3.0 * sigma_frames)); ++k) {
      kernel.push_back(std::exp(-0.5 * k * k / (sigma_frames * sigma_frames)));
      squares += (k == 0 ? 1.0 : 2.0) * kernel.back() * kernel.back();
    }
    std::vector<cv::Mat> result;
    const int count = static_cast<int>(fields.size());
    for (int i = 0; i < count; ++i) {
      cv::Mat sum = cv::Mat::zeros(fields.front().size(), CV_32FC1);
      for (int k = 0; k < count; ++k) {
        const auto apart = static_cast<std::size_t>(std::abs(k - i));
        if (apart >= kernel.size()) continue;
        cv::scaleAdd(in_plane[static_cast<std::size_t>(k)], kernel[apart] / std::sqrt(squares), sum, sum);
      }
      result.push_back(sum);
    }
    return result;
  }

  void move(double blur) {
    std::vector<cv::Mat> pulls;
    for (const Working& work : frames_) {
      cv::Mat pull(work.distance.size(), CV_32FC1);
      const double norm = 1.0 / (blur * std::sqrt(2.0 * std::numbers::pi));
      for (int y = 0; y < pull.rows; ++y) {
        for (int x = 0; x < pull.cols; ++x) {
          const double d = work.distance.at<float>(y, x) / blur;
          const double near = d * d < 16.0 ? norm * std::exp(-0.5 * d * d) : 0.0;
          pull.at<float>(y, x) =
              static_cast<float>(near * work.evidence.at<float>(y, x) * work.frame->spread.at<float>(y, x));
        }
      }
      pulls.push_back(std::move(pull));
    }
    std::vector<cv::Mat> steps = rooted(pulls);
    for (std::size_t i = 0; i < frames_.size(); ++i) steps[i] -= frames_[i].white;
    const std::vector<cv::Mat> moves = rooted(steps);
    double farthest = 1e-9;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      farthest = std::max(farthest, cv::norm(moves[i].mul(frames_[i].frame->spread), cv::NORM_INF));
    }
    const double share = std::min(kGain, kLargestMove_blocks / farthest);
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      Working& work = frames_[i];
      cv::scaleAdd(steps[i], share, work.white, work.white);
      cv::scaleAdd(moves[i].mul(work.frame->spread), share, work.distance, work.distance);
    }
  }

  /// How much of the contrast that was learned is there across the outline that was found, 0 to 1.
  double found_contrast(const Working& work) const {
    const Sides sides = sides_of(*work.frame, work.distance, options_.window_blocks);
    double found = 0.0;
    double learned = 1e-9;
    for (int y = 0; y < work.distance.rows; ++y) {
      for (int x = 0; x < work.distance.cols; ++x) {
        if (std::abs(work.distance.at<float>(y, x)) >= 1.0F) continue;
        const double contrast = work.contrast.at<float>(y, x);
        const double weight = std::min(sides.inside_weight.at<float>(y, x), sides.outside_weight.at<float>(y, x));
        found +=
            weight * contrast * (static_cast<double>(sides.inside.at<float>(y, x)) - sides.outside.at<float>(y, x));
        learned += weight * contrast * contrast;
      }
    }
    return std::clamp(found / learned, 0.0, 1.0);
  }

  /// Along the outline, what prediction and pixels together leave open. Where the contrast of the drawn outlines is not
  /// there the pixels have not shown the border, however clear they are.
  double expected_error(const Working& work) const {
    const double shown = std::min(1.0, found_contrast(work) / kContrastOfBorder);
    double area = 0.0;
    double wrong = 0.0;
    const double strip = 2.0 * options_.length_blocks;  // blocks along the outline that move together
    for (int y = 0; y < work.distance.rows; ++y) {
      for (int x = 0; x < work.distance.cols; ++x) {
        const double d = work.distance.at<float>(y, x);
        if (d > 0.0) area += 1.0;
        if (std::abs(d) >= 1.0) continue;  // two blocks wide
        const double spread = work.frame->spread.at<float>(y, x);
        const double contrast = work.contrast.at<float>(y, x);
        const double evidence =
            shown * shown * strip * contrast * contrast / (2.0 * variance_ * alike_) * work.frame->seen.at<float>(y, x);
        wrong += 0.5 / (1.0 / std::max(spread, 1e-3) + evidence);
      }
    }
    return wrong / std::max(1.0, 2.0 * area);
  }

  StackRefinementOptions options_;
  std::vector<Working> frames_;
  double variance_ = 1.0;
  double alike_ = 1.0;
  double length_frames_ = 1.0;
};

}  // namespace

void StackRefinementOptions::check() const {
  for (const double value : {length_blocks, window_blocks, length_frames, evidence, static_cast<double>(rounds)}) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw Error("propagation: the lengths, the weight of the pixels and the rounds must be positive");
    }
  }
}

std::vector<RefinedFrame> refine_stack(std::span<const StackFrame> frames, const StackRefinementOptions& options) {
  options.check();
  assert(frames.size() >= 3);
  return Refinement(frames, options).run();
}

}  // namespace fathom
