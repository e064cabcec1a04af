#include "registration/sweep_verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "acquisition/live/folder_names.h"
#include "core/error.h"
#include "core/numbers.h"
#include "core/statistics.h"
#include "registration/frame_locator.h"

namespace fathom {

namespace {

constexpr double kGapFactor = 2.5;  // of the usual interval: one frame lost, and the rest jitter

using Corners = std::vector<Eigen::Vector3d>;

Corners corners_of(const Eigen::AlignedBox3d& box) {
  Corners corners;
  for (int i = 0; i < 8; ++i) corners.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  return corners;
}

/// Goes through the frames once.
class Judge {
 public:
  Judge(const Recording& recording, const Calibration* calibration, const FrameNames& names,
        const VerdictOptions& options)
      : header_(recording.header()),
        calibrated_(calibration != nullptr),
        options_(options),
        locator_(recording, calibrated_ ? *calibration : Calibration{}, names) {
    verdict_.frames = header_.frame_count();
  }

  SweepVerdict run() {
    find_interval();
    for (int i = 0; i < header_.frame_count(); ++i) look_at(i);
    end_dropout(header_.frame_count() - 1);
    if (!steps_per_s_.empty()) verdict_.speed_mm_s = median(steps_per_s_);
    if (calibrated_ && options_.region_mm) see_region();
    return verdict_;
  }

 private:
  const FrameHeader& frame(int i) const { return header_.frames[static_cast<std::size_t>(i)]; }

  std::optional<double> interval_s(int i) const {
    if (i == 0 || !frame(i).time_s || !frame(i - 1).time_s) return std::nullopt;
    return *frame(i).time_s - *frame(i - 1).time_s;
  }

  bool same_sweep(int i) const { return i > 0 && sweep_of(frame(i)) == sweep_of(frame(i - 1)); }

  void find_interval() {
    std::vector<double> intervals_s;
    for (int i = 1; i < header_.frame_count(); ++i) {
      if (const auto interval = interval_s(i)) intervals_s.push_back(*interval);
    }
    max_interval_s_ = options_.max_interval_s.value_or(kGapFactor * median(std::move(intervals_s)));
  }

  void look_at(int i) {
    const auto interval = interval_s(i);
    if (same_sweep(i) && interval && *interval > max_interval_s_) {
      ++verdict_.gaps;
      verdict_.longest_gap_s = std::max(verdict_.longest_gap_s, *interval);
    }
    const auto place = frame(i).image_valid() ? locator_.reference_from_image(i) : std::nullopt;
    if (!place) {
      if (!dropout_) dropout_ = i;
      last_corners_.clear();
      return;
    }
    if (dropout_) end_dropout(i);
    ++verdict_.valid_frames;
    const Corners corners = image_corners(*place);
    if (!last_corners_.empty() && same_sweep(i)) take_step(corners, interval);
    last_corners_ = corners;
    if (options_.region_mm) see_corners(*place);
  }

  // The first frame behind a dropout, or the last frame of all.
  void end_dropout(int i) {
    if (!dropout_) return;
    ++verdict_.dropouts;
    const int before = std::max(0, *dropout_ - 1);
    if (frame(i).time_s && frame(before).time_s) {
      verdict_.longest_dropout_s = std::max(verdict_.longest_dropout_s, *frame(i).time_s - *frame(before).time_s);
    }
    dropout_.reset();
  }

  Corners image_corners(const Eigen::Affine3d& reference_from_image) const {
    if (!calibrated_) return {reference_from_image.translation()};
    Corners corners;
    for (const double x : {0.0, header_.width - 1.0}) {
      for (const double y : {0.0, header_.height - 1.0}) {
        corners.push_back(reference_from_image * Eigen::Vector3d(x, y, 0.0));
      }
    }
    return corners;
  }

  void take_step(const Corners& corners, const std::optional<double>& interval) {
    double step_mm = 0.0;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      step_mm = std::max(step_mm, (corners[c] - last_corners_[c]).norm());
    }
    verdict_.largest_step_mm = std::max(verdict_.largest_step_mm.value_or(0.0), step_mm);
    verdict_.too_fast += step_mm > options_.max_step_mm ? 1 : 0;
    if (interval && *interval > 0.0) steps_per_s_.push_back(step_mm / *interval);
  }

  // Which side of the region, whole, this frame's plane lies on.
  void see_corners(const Eigen::Affine3d& reference_from_image) {
    const Eigen::Vector3d normal = reference_from_image.linear().col(2);
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (const Eigen::Vector3d& corner : corners_of(*options_.region_mm)) {
      const double distance = normal.dot(corner - reference_from_image.translation());
      lowest = std::min(lowest, distance);
      highest = std::max(highest, distance);
    }
    if (!first_middle_) first_middle_ = lowest + highest;
    last_middle_ = lowest + highest;
    before_ = before_ || lowest >= 0.0;
    behind_ = behind_ || highest <= 0.0;
  }

  void see_region() {
    const bool forward = first_middle_.value_or(0.0) >= last_middle_;
    verdict_.passes_start = forward ? before_ : behind_;
    verdict_.passes_end = forward ? behind_ : before_;
  }

  const RecordingHeader& header_;
  bool calibrated_;
  const VerdictOptions& options_;
  FrameLocator locator_;
  SweepVerdict verdict_;
  double max_interval_s_ = 0.0;
  std::optional<int> dropout_;  // its first frame
  Corners last_corners_;
  std::vector<double> steps_per_s_;
  bool before_ = false;
  bool behind_ = false;
  std::optional<double> first_middle_;
  double last_middle_ = 0.0;
};

std::vector<TrackerSample> samples_of_frames(const Recording& recording, const FrameNames& names) {
  std::vector<TrackerSample> samples;
  const auto chain = default_pose_chain(recording, names);
  if (!chain) return samples;
  for (int i = 0; i < recording.header().frame_count(); ++i) {
    const auto time_s = recording.header().frames[static_cast<std::size_t>(i)].time_s;
    const auto pose = reference_from_probe(recording, *chain, i);
    if (time_s && pose) samples.push_back({"", {pose->matrix(), "OK"}, *time_s, *time_s, {}});
  }
  return samples;
}

void add_warnings(SweepVerdict& verdict, const VerdictOptions& options) {
  const auto warn_if = [&](bool condition, const std::string& text) {
    if (condition) verdict.warnings.push_back(text);
  };
  const auto text = [](double value, int decimals) { return format_rounded(value, decimals); };
  warn_if(verdict.valid_frames == 0, "no frame is valid: the tracker never saw the probe while its image was good");
  warn_if(verdict.gaps > 0, std::to_string(verdict.gaps) + " gaps between frames, the longest of " +
                                text(verdict.longest_gap_s, 2) + " s");
  warn_if(verdict.dropouts > 0 && verdict.valid_frames > 0, "the probe was lost " + std::to_string(verdict.dropouts) +
                                                                " times, for " + text(verdict.longest_dropout_s, 2) +
                                                                " s at the longest");
  warn_if(verdict.too_fast > 0, "too fast: " + std::to_string(verdict.too_fast) +
                                    " steps between frames of more than " + text(options.max_step_mm, 1) +
                                    " mm, the largest of " + text(verdict.largest_step_mm.value_or(0.0), 1) + " mm");
  const bool jitters = verdict.jitter && (verdict.jitter->position_mm > options.max_jitter_mm ||
                                          verdict.jitter->angle_deg > options.max_jitter_deg);
  warn_if(jitters, "the tracker is unsteady: " + text(verdict.jitter ? verdict.jitter->position_mm : 0.0, 2) +
                       " mm and " + text(verdict.jitter ? verdict.jitter->angle_deg : 0.0, 2) +
                       " degrees rms while the probe was held still");
  warn_if(verdict.passes_start == false, "the sweep begins within the region; begin before it");
  warn_if(verdict.passes_end == false, "the sweep ends within the region; go on past it");
}

}  // namespace

void VerdictOptions::check() const {
  const auto require = [](double value, const std::string& name) {
    if (!(value > 0.0) || !std::isfinite(value)) throw Error(name + " must be above 0");
  };
  if (max_interval_s) require(*max_interval_s, "the longest interval between frames (s)");
  require(max_step_mm, "the largest step between frames (mm)");
  require(max_jitter_mm, "the largest jitter (mm)");
  require(max_jitter_deg, "the largest jitter (degrees)");
}

SweepVerdict judge_sweep(const Recording& recording, const Calibration* calibration, const FrameNames& names,
                         std::span<const TrackerSample> samples, const VerdictOptions& options) {
  options.check();
  const RecordingHeader& header = recording.header();
  SweepVerdict verdict;
  verdict.frames = header.frame_count();
  const bool fits = calibration != nullptr &&
                    (!calibration->image_size || *calibration->image_size == cv::Size(header.width, header.height));
  if (!default_pose_chain(recording, names)) {
    verdict.warnings.push_back(
        "no transforms lead from the probe to the reference; --probe-frame and --reference-frame "
        "choose others");
    return verdict;
  }
  FrameNames chosen = names;
  if (calibration != nullptr && fits) {
    if (!chosen.probe) chosen.probe = calibration->probe_frame;
    if (!chosen.reference) chosen.reference = calibration->reference_frame;
  }
  verdict = Judge(recording, fits ? calibration : nullptr, chosen, options).run();
  const std::vector<TrackerSample> of_frames =
      samples.empty() ? samples_of_frames(recording, names) : std::vector<TrackerSample>();
  verdict.jitter = tracker_jitter(samples.empty() ? std::span<const TrackerSample>(of_frames) : samples);
  if (calibration != nullptr && !fits) {
    verdict.warnings.push_back("the calibration is for images of another size and was not used");
  }
  add_warnings(verdict, options);
  return verdict;
}

}  // namespace fathom
