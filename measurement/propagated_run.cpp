#include "measurement/propagated_run.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "measurement/outline_crossing.h"

namespace fathom {

namespace {

constexpr double kMargin_px = 40.0;  // around the drawn outlines, where parts between them may reach
constexpr double kLeastSpread_blocks = 0.1;
constexpr double kBand_blocks = 8.0;  // beside an outline, where its errors and changes count
constexpr double kWindow_blocks = 6.0;
constexpr double kUntoldWithoutPoses = 0.4;  // 1 - Dice: how far apart the drawn frames are is not known
constexpr int kNeighbourhood_blocks = 17;    // in which a part is as thick as its deepest place

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

StackFrame stack_frame(const Recording& recording, int frame, const PixelGrid& grid) {
  StackFrame result;
  const cv::Mat image = recording.image(frame);
  result.grey = block_means(image, grid);
  result.seen = blocks_seen(image.size(), grid);
  result.spread = cv::Mat::zeros(grid.size, CV_32FC1);
  return result;
}

CrossedSection crossed(const DrawnSection& section) { return {section.place, section.shape}; }

std::vector<CrossedSection> crossed(std::span<const DrawnSection* const> sections) {
  std::vector<CrossedSection> all;
  for (const DrawnSection* section : sections) all.push_back(crossed(*section));
  return all;
}

/// By how much the sections on either side of a drawn one mispredict it, along its outline; empty where one is missing.
std::optional<cv::Mat> misfit(std::span<const DrawnSection* const> before, const DrawnSection& drawn,
                              std::span<const DrawnSection* const> after, const cv::Mat& distance,
                              const PixelGrid& grid, bool round_ends) {
  if (before.empty() || after.empty() || drawn.outlines_px.empty()) return std::nullopt;
  const DrawnSection& first = *before.front();
  const DrawnSection& second = *after.front();
  if (first.outlines_px.empty() && second.outlines_px.empty()) return std::nullopt;
  const OutlineCrossing crossing(crossed(first), crossed(second), crossed(before.subspan(1)), crossed(after.subspan(1)),
                                 round_ends);
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

/// How far the outlined place of one section is from the other's plane.
double way_mm(const DrawnSection& from, const DrawnSection& to) {
  Eigen::Vector2d sum_px = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (const Polygon& outline : from.outlines_px) {
    for (const Eigen::Vector2d& point : outline) sum_px += point;
    count += static_cast<double>(outline.size());
  }
  const Eigen::Vector3d place_mm =
      from.place.plane.at(from.place.ab_from_image * Eigen::Vector2d(sum_px / std::max(count, 1.0)));
  return std::abs(to.place.plane.normal().dot(place_mm - to.place.plane.origin_mm));
}

/// 1 - Dice of an outline and the same one moved outward by `blocks` everywhere.
double fault_of_growth(const cv::Mat& distance, double blocks) {
  const double area = cv::countNonZero(distance > 0.0);
  const double perimeter = 0.5 * cv::countNonZero(cv::abs(distance) < 1.0);
  return perimeter * blocks / std::max(1.0, 2.0 * area + perimeter * blocks);
}

/// Standard deviation of the prediction's error around every block, pinned to 0 at the drawn sections.
cv::Mat spread_of(const PredictedOutline& predicted, const std::optional<cv::Mat>& first_misfit,
                  const std::optional<cv::Mat>& second_misfit, double way_blocks, const PropagateOptions& options) {
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
    spread = cv::max(along_outline(change, predicted.distance), options.spread_of_gap * way_blocks);
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
  OutlineCrossing crossing(crossed(first), crossed(second), crossed(drawn.before), crossed(drawn.after),
                           options.round_ends);
  const double deepest_mm = std::max(first.shape->largest_inside_mm(), second.shape->largest_inside_mm());
  const auto drawn_distances = [&](const DrawnSection& section) {
    return section_distances(*section.shape, section.place, grid, deepest_mm / block_mm(section.place, grid));
  };

  const auto first_misfit =
      misfit(drawn.before, first, from(drawn.second, drawn.after), drawn_distances(first), grid, options.round_ends);
  const auto second_misfit =
      misfit(from(drawn.first, drawn.before), second, drawn.after, drawn_distances(second), grid, options.round_ends);
  const double way_blocks = std::min(way_mm(first, second), way_mm(second, first)) / block_mm(first.place, grid);
  std::vector<StackFrame> stack(frames.size() + 2);
  std::vector<FilledFrame> filled(frames.size());
  const int count = static_cast<int>(frames.size());
  const cv::Range all(-1, count + 1);
  const auto place_of = [&](int i) -> const CarriedPlane& {
    return i == -1 ? first.place : i == count ? second.place : frames[static_cast<std::size_t>(i)].place;
  };
  cv::parallel_for_(all, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const int frame = i == -1 ? first.frame : i == count ? second.frame : frames[static_cast<std::size_t>(i)].frame;
      stack[static_cast<std::size_t>(i + 1)] = stack_frame(recording, frame, grid);
    }
  });
  if (options.pixels) {
    std::vector<CrossedFrame> seen;
    for (int i = all.start; i < all.end; ++i) {
      const StackFrame& frame = stack[static_cast<std::size_t>(i + 1)];
      seen.push_back({frame.grey, frame.seen, place_of(i)});
    }
    crossing.find_tips(seen, grid);
  }
  cv::parallel_for_(all, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      StackFrame& to = stack[static_cast<std::size_t>(i + 1)];
      if (i == -1 || i == count) {
        to.distance = drawn_distances(i == -1 ? first : second);
        to.share = i == -1 ? 0.0 : 1.0;
        continue;
      }
      const PredictedOutline predicted = crossing.predict(place_of(i), grid);
      to.distance = predicted.distance;
      to.spread = spread_of(predicted, first_misfit, second_misfit, way_blocks, options);
      to.share = predicted.share;
    }
  });

  std::vector<RefinedFrame> refined;
  if (options.pixels) refined = refine_stack(stack, options.refinement);
  double change = overlap_fault(stack.front().distance, stack.back().distance);
  // That two outlines are alike says nothing of what lies between them unless a third one shows how the structure runs.
  // Pixels find the border only from nearby, so that they do not make up for it.
  double untold = 0.0;
  if (!first_misfit && !second_misfit && !first.outlines_px.empty() && !second.outlines_px.empty()) {
    untold = fault_of_growth(stack.front().distance, options.spread_of_gap * way_blocks);
    if (!drawn.placed) untold = std::max(untold, kUntoldWithoutPoses);
    change = std::max(change, untold);
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    FilledFrame& to = filled[i];
    to.frame = frames[i].frame;
    to.grid = grid;
    to.distance = options.pixels ? refined[i].distance : stack[i + 1].distance;
    const double w = stack[i + 1].share;
    to.expected_error = std::max(options.pixels ? refined[i].expected_error : 0.0, untold * std::sqrt(w * (1.0 - w)));
    to.moved = overlap_fault(to.distance, stack[i + 1].distance);
    to.change = change;
  }
  return filled;
}

}  // namespace fathom
