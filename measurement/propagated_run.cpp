#include "measurement/propagated_run.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "measurement/predicted_outline.h"

namespace fathom {

namespace {

constexpr double kMargin_px = 40.0;  // around the drawn outlines, where parts between them may reach
constexpr double kLeastSpread_blocks = 0.1;
constexpr double kBand_blocks = 8.0;  // beside an outline, where its errors and changes count
constexpr double kWindow_blocks = 6.0;
constexpr int kNeighbourhood_blocks = 17;  // in which a part is as thick as its deepest place

double overlap_fault(const cv::Mat& a, const cv::Mat& b) {
  const cv::Mat in_a = a > 0.0;
  const cv::Mat in_b = b > 0.0;
  const int sum = cv::countNonZero(in_a) + cv::countNonZero(in_b);
  return sum == 0 ? 0.0 : 1.0 - 2.0 * cv::countNonZero(in_a & in_b) / sum;
}

/// The mean of `values` around every block, as far as they lie near the outline of `distance`.
cv::Mat along_outline(const cv::Mat& values, const cv::Mat& distance) {
  cv::Mat near;
  cv::Mat(cv::abs(distance) < kBand_blocks).convertTo(near, CV_32F, 1.0 / 255.0);
  cv::Mat weight;
  cv::Mat sum;
  cv::GaussianBlur(near, weight, cv::Size(0, 0), kWindow_blocks);
  cv::GaussianBlur(near.mul(values), sum, cv::Size(0, 0), kWindow_blocks);
  cv::Mat mean;
  cv::divide(sum, cv::max(weight, 1e-3), mean);
  return mean;
}

std::vector<Polygon> outlines_of(const DrawnSection& first, const DrawnSection& second) {
  std::vector<Polygon> outlines = first.outlines_px;
  outlines.insert(outlines.end(), second.outlines_px.begin(), second.outlines_px.end());
  return outlines;
}

StackFrame stack_frame(const Recording& recording, int frame, const PixelGrid& grid, cv::Mat distance) {
  StackFrame result;
  const cv::Mat image = recording.image(frame);
  result.grey = block_means(image, grid);
  result.seen = blocks_seen(image.size(), grid);
  result.distance = std::move(distance);
  result.spread = cv::Mat::zeros(grid.size, CV_32FC1);
  return result;
}

/// What leads from one drawn section to the next.
class Crossing {
 public:
  /// `before` and `after` lie beyond them, the nearest first. At least one section has an area.
  Crossing(const DrawnSection& first, const DrawnSection& second, std::span<const DrawnSection* const> before,
           std::span<const DrawnSection* const> after, bool round_ends)
      : gap_(gap_between(first, second)) {
    if (!before.empty()) gap_before_.emplace(gap_between(*before.front(), first));
    if (!after.empty()) gap_after_.emplace(gap_between(second, *after.front()));
    curved_.emplace(gap_, gap_before_ ? &*gap_before_ : nullptr, gap_after_ ? &*gap_after_ : nullptr);
    if (!round_ends) return;
    if (first.outlines_px.empty()) end_ = tapered(first, second, after);
    if (second.outlines_px.empty()) end_ = tapered(second, first, before);
  }
  Crossing(const Crossing&) = delete;
  Crossing& operator=(const Crossing&) = delete;

  PredictedOutline predict(const CarriedPlane& place, const PixelGrid& grid) const {
    return predict_outline(gap_, *curved_, end_ ? &*end_ : nullptr, place, grid);
  }

 private:
  static SectionGap gap_between(const DrawnSection& a, const DrawnSection& b) {
    return {{a.place.plane, a.shape}, {b.place.plane, b.shape}, Guide::kDiscs};
  }

  static TaperedEnd tapered(const DrawnSection& end, const DrawnSection& nearest,
                            std::span<const DrawnSection* const> farther) {
    std::vector<PlacedSection> sections = {{nearest.place.plane, nearest.shape}};
    for (const DrawnSection* section : farther) {
      if (section->outlines_px.empty()) break;
      sections.push_back({section->place.plane, section->shape});
    }
    return {{end.place.plane, end.shape}, sections};
  }

  SectionGap gap_;
  std::optional<SectionGap> gap_before_;
  std::optional<SectionGap> gap_after_;
  std::optional<CurvedGap> curved_;
  std::optional<TaperedEnd> end_;
};

/// By how much the sections on either side of a drawn one mispredict it, along its outline; empty where one is missing.
std::optional<cv::Mat> misfit(std::span<const DrawnSection* const> before, const DrawnSection& drawn,
                              std::span<const DrawnSection* const> after, const cv::Mat& distance,
                              const PixelGrid& grid, bool round_ends) {
  if (before.empty() || after.empty() || drawn.outlines_px.empty()) return std::nullopt;
  const DrawnSection& first = *before.front();
  const DrawnSection& second = *after.front();
  if (first.outlines_px.empty() && second.outlines_px.empty()) return std::nullopt;
  const Crossing crossing(first, second, before.subspan(1), after.subspan(1), round_ends);
  return along_outline(cv::abs(crossing.predict(drawn.place, grid).distance - distance), distance);
}

/// A section and those beyond it.
std::vector<const DrawnSection*> from(const DrawnSection* section, const std::vector<const DrawnSection*>& beyond) {
  std::vector<const DrawnSection*> all = {section};
  all.insert(all.end(), beyond.begin(), beyond.end());
  return all;
}

/// Where a part comes or goes between the sections, 0 to 1: it moves by as much as it is thick, or more.
cv::Mat coming_or_going(const PredictedOutline& predicted) {
  cv::Mat thickness;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {kNeighbourhood_blocks, kNeighbourhood_blocks});
  cv::dilate(cv::max(predicted.depth, 1.0), thickness, disc);
  cv::Mat share;
  cv::divide(predicted.change, thickness, share);
  return cv::min(cv::max(2.0 * share - 1.0, 0.0), 1.0);
}

/// Standard deviation of the prediction's error around every block, pinned to 0 at the drawn sections.
cv::Mat spread_of(const PredictedOutline& predicted, const std::optional<cv::Mat>& first_misfit,
                  const std::optional<cv::Mat>& second_misfit, const PropagateOptions& options) {
  const double w = predicted.share;
  cv::Mat spread;
  if (first_misfit && second_misfit) {
    spread = options.spread_of_misfit * ((1.0 - w) * *first_misfit + w * *second_misfit);
  } else if (first_misfit || second_misfit) {
    spread = options.spread_of_misfit * (first_misfit ? *first_misfit : *second_misfit);
  }
  const cv::Mat change = options.spread_of_change * predicted.change;
  if (!predicted.doubt.empty()) {
    spread = along_outline(options.spread_of_end * predicted.doubt, predicted.distance);
  } else if (spread.empty()) {
    spread = along_outline(change, predicted.distance);
  } else {
    spread = cv::max(spread, along_outline(change.mul(coming_or_going(predicted)), predicted.distance));
  }
  return cv::max(spread * (2.0 * std::sqrt(w * (1.0 - w))), kLeastSpread_blocks);
}

}  // namespace

std::vector<FilledFrame> fill_run(const Recording& recording, const DrawnAround& drawn,
                                  std::span<const OpenFrame> frames, const PropagateOptions& options) {
  if (frames.empty()) return {};
  const DrawnSection& first = *drawn.first;
  const DrawnSection& second = *drawn.second;
  const PixelGrid grid = grid_around(outlines_of(first, second), kMargin_px);
  const Crossing crossing(first, second, drawn.before, drawn.after, options.round_ends);
  const double deepest_mm = std::max(first.shape->largest_inside_mm(), second.shape->largest_inside_mm());
  const auto drawn_distances = [&](const DrawnSection& section) {
    return section_distances(*section.shape, section.place, grid, deepest_mm / block_mm(section.place, grid));
  };

  const auto first_misfit =
      misfit(drawn.before, first, from(drawn.second, drawn.after), drawn_distances(first), grid, options.round_ends);
  const auto second_misfit =
      misfit(from(drawn.first, drawn.before), second, drawn.after, drawn_distances(second), grid, options.round_ends);
  std::vector<StackFrame> stack(frames.size() + 2);
  std::vector<FilledFrame> filled(frames.size());
  const int count = static_cast<int>(frames.size());
  cv::parallel_for_(cv::Range(-1, count + 1), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      StackFrame& to = stack[static_cast<std::size_t>(i + 1)];
      if (i == -1 || i == count) {
        const DrawnSection& section = i == -1 ? first : second;
        to = stack_frame(recording, section.frame, grid, drawn_distances(section));
        to.share = i == -1 ? 0.0 : 1.0;
        continue;
      }
      const OpenFrame& frame = frames[static_cast<std::size_t>(i)];
      const PredictedOutline predicted = crossing.predict(frame.place, grid);
      to = stack_frame(recording, frame.frame, grid, predicted.distance);
      to.spread = spread_of(predicted, first_misfit, second_misfit, options);
      to.share = predicted.share;
    }
  });

  std::vector<RefinedFrame> refined;
  if (options.pixels) refined = refine_stack(stack, options.refinement);
  const double change = overlap_fault(stack.front().distance, stack.back().distance);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    FilledFrame& to = filled[i];
    to.frame = frames[i].frame;
    to.grid = grid;
    to.distance = options.pixels ? refined[i].distance : stack[i + 1].distance;
    to.expected_error = options.pixels ? refined[i].expected_error : 0.0;
    to.moved = overlap_fault(to.distance, stack[i + 1].distance);
    to.change = change;
  }
  return filled;
}

}  // namespace fathom
