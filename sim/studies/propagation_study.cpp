#include "sim/studies/propagation_study.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "measurement/cross_section.h"
#include "measurement/planimetry.h"
#include "sim/scan_path.h"
#include "sim/simulate.h"

namespace fathom {

namespace {

constexpr std::array kScenes = {"bladder", "bladder-prostate", "kidney", "ducts", "foetus"};
constexpr double kRight = 0.9;
constexpr double kHard = 0.92;

cv::Mat mask_of(const Structure& structure, int frame, cv::Size size) {
  constexpr int kShift = 4;
  std::vector<std::vector<cv::Point>> polygons;
  for (const Contour& contour : structure.contours) {
    if (contour.frame != frame) continue;
    polygons.emplace_back();
    for (const Eigen::Vector2d& point : contour.points_px) {
      polygons.back().emplace_back(static_cast<int>(std::lround(point.x() * (1 << kShift))),
                                   static_cast<int>(std::lround(point.y() * (1 << kShift))));
    }
  }
  cv::Mat mask(size, CV_8UC1, cv::Scalar(0));
  if (!polygons.empty()) cv::fillPoly(mask, polygons, cv::Scalar(255), cv::LINE_8, kShift);
  return mask;
}

/// Empty where neither shows anything.
std::optional<double> dice(const cv::Mat& a, const cv::Mat& b) {
  const int sum = cv::countNonZero(a) + cv::countNonZero(b);
  if (sum == 0) return std::nullopt;
  return 2.0 * cv::countNonZero(a & b) / sum;
}

Structure drawn_part(const Structure& truth, int every) {
  Structure drawn = truth;
  const auto skipped = [every](const auto& mark) { return mark.frame % every != 0; };
  std::erase_if(drawn.contours, skipped);
  std::erase_if(drawn.absent, skipped);
  std::erase_if(drawn.extremities, skipped);
  return drawn;
}

const Structure& named(const std::vector<Structure>& structures, const std::string& name) {
  return *std::find_if(structures.begin(), structures.end(), [&](const Structure& s) { return s.name == name; });
}

double volume_error_percent(const Structure& structure, const FrameLocator& locator, double true_ml) {
  const auto sections = cross_sections(structure, locator, nullptr);
  return 100.0 * (cubic_planimetry_ml(sections) / true_ml - 1.0);
}

SimulateOptions scan_of(const PropagationStudyOptions& options, int sweep) {
  const auto patterns = single_sweep_patterns();
  const auto scenes = static_cast<int>(kScenes.size());
  SimulateOptions scan;
  scan.object = kScenes[static_cast<std::size_t>(sweep % scenes)];
  scan.pattern = patterns[static_cast<std::size_t>(sweep / scenes) % patterns.size()];
  scan.frames = options.frames;
  scan.seed = options.first_seed + static_cast<std::uint64_t>(sweep);
  scan.jitter_mm = options.jitter_mm;
  scan.jitter_deg = options.jitter_deg;
  scan.speckle.emplace();
  return scan;
}

PropagationStudySweep score_sweep(const PropagationStudyOptions& options, int sweep) {
  const SimulateOptions scan_options = scan_of(options, sweep);
  const SimulatedScan scan = simulate(scan_options);
  const FrameLocator locator(*scan.recording, scan.calibration);
  std::vector<Structure> drawn;
  for (const Structure& truth : scan.outlines) drawn.push_back(drawn_part(truth, options.drawn_every));

  PropagateOptions image_free = options.propagate;
  image_free.pixels = false;
  image_free.round_ends = false;
  // Images are made before the clock starts.
  std::vector<cv::Mat> images;
  for (int frame = 0; frame < options.frames; ++frame) images.push_back(scan.recording->image(frame));
  const MemoryRecording recording(scan.recording->name(), scan.recording->header(), std::move(images));
  const auto start = std::chrono::steady_clock::now();
  const Propagation filled = propagate(recording, drawn, &locator, {}, options.propagate);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Propagation interpolated = propagate(recording, drawn, &locator, {}, image_free);

  PropagationStudySweep result{scan_options.object, scan_options.pattern, scan_options.seed, {}, 0.0, 0.0, {}, 0.0};
  result.seconds_per_frame = seconds / static_cast<double>(filled.frames.size());
  const cv::Size size(recording.header().width, recording.header().height);
  for (const PropagatedFrame& frame : filled.frames) {
    const cv::Mat truth = mask_of(named(scan.outlines, frame.structure), frame.frame, size);
    const auto score = dice(truth, mask_of(named(filled.structures, frame.structure), frame.frame, size));
    const auto baseline = dice(truth, mask_of(named(interpolated.structures, frame.structure), frame.frame, size));
    if (!score && !baseline) continue;
    result.scores.push_back({frame, score.value_or(1.0), baseline.value_or(1.0)});
    result.dice += result.scores.back().dice;
    result.image_free_dice += result.scores.back().image_free_dice;
  }
  result.dice /= static_cast<double>(result.scores.size());
  result.image_free_dice /= static_cast<double>(result.scores.size());
  for (const auto& truth : scan.truth.structures) {
    result.volume_errors_percent.push_back(
        volume_error_percent(named(filled.structures, truth.name), locator, truth.volume_ml));
  }
  return result;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / std::max(1.0, static_cast<double>(values.size()));
}

double fifth_percentile(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(0.05 * static_cast<double>(values.size()))];
}

}  // namespace

std::vector<PropagationStudySweep> propagation_study(const PropagationStudyOptions& options, const Progress& progress) {
  std::vector<PropagationStudySweep> sweeps;
  for (int i = 0; i < options.sweeps; ++i) {
    report(progress, static_cast<double>(i) / options.sweeps);
    sweeps.push_back(score_sweep(options, options.first_sweep + i));
  }
  return sweeps;
}

PropagationSummary summary_of(const std::vector<PropagationStudySweep>& sweeps) {
  PropagationSummary summary;
  std::vector<double> scores;
  std::vector<double> baseline;
  std::vector<double> volumes;
  std::vector<double> ratios;
  std::vector<double> seconds;
  std::vector<double> of_sweeps;
  int right = 0;
  int right_of_sure = 0;
  summary.worst_sweep_dice = 1.0;
  for (const PropagationStudySweep& sweep : sweeps) {
    for (const PropagatedScore& score : sweep.scores) {
      scores.push_back(score.dice);
      baseline.push_back(score.image_free_dice);
      right += score.dice >= kRight;
      if (score.frame.confidence < kSureContour) continue;
      ++summary.sure;
      right_of_sure += score.dice >= kRight;
    }
    for (const double error : sweep.volume_errors_percent) volumes.push_back(std::abs(error));
    if (sweep.image_free_dice <= kHard) ratios.push_back((1.0 - sweep.dice) / (1.0 - sweep.image_free_dice));
    summary.worst_sweep_dice = std::min(summary.worst_sweep_dice, sweep.dice);
    seconds.push_back(sweep.seconds_per_frame);
    of_sweeps.push_back(sweep.dice);
  }
  summary.contours = static_cast<int>(scores.size());
  summary.mean_dice = mean(scores);
  summary.fifth_percentile = fifth_percentile(scores);
  summary.fifth_percentile_of_sweeps = fifth_percentile(of_sweeps);
  summary.image_free_mean_dice = mean(baseline);
  summary.image_free_fifth_percentile = fifth_percentile(baseline);
  summary.mean_volume_error_percent = mean(volumes);
  summary.largest_volume_error_percent = volumes.empty() ? 0.0 : *std::max_element(volumes.begin(), volumes.end());
  summary.right = right / std::max(1.0, static_cast<double>(scores.size()));
  summary.right_of_sure = right_of_sure / std::max(1.0, static_cast<double>(summary.sure));
  summary.hard_sweeps = static_cast<int>(ratios.size());
  summary.mean_fault_ratio = mean(ratios);
  summary.largest_fault_ratio = ratios.empty() ? 0.0 : *std::max_element(ratios.begin(), ratios.end());
  summary.seconds_per_frame = mean(seconds);
  return summary;
}

}  // namespace fathom
