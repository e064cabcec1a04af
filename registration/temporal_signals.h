#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/recording.h"
#include "registration/probe_poses.h"
#include "registration/wall_detection.h"

namespace fathom {

/// One value of something that was followed over time.
struct TimedValue {
  double time_s = 0.0;
  double value = 0.0;
};

/// In order of time, no time twice. `source` is of the recording, for messages.
struct Signal {
  std::string source;
  std::vector<TimedValue> values;
};

/// How deep a flat floor lies in the image, in pixels, at the middle column. Frames without time stamp or a stamp that
/// does not come after those before are left out. Throws Error when none is left.
Signal floor_signal(const Recording& recording, const std::vector<WallLine>& floor);

/// Where the probe was along the line that it moved along most, in mm about the mean. Throws Error when the recording
/// has no time stamps or fewer than two valid poses.
Signal motion_signal(const ProbePoses& poses);

/// Standard deviation of its values; 0 where there are fewer than two.
double spread(const Signal& signal);

/// A smooth curve through noisy samples at any times: a polynomial of second degree, fitted around every time with
/// weights that fall off to both sides. Unlike interpolation between samples, it does not have less noise half-way
/// between them, which would pull a latency there.
class SmoothSignal {
 public:
  explicit SmoothSignal(Signal signal);

  struct At {
    double value = 0.0;
    double slope = 0.0;  ///< per second
  };
  /// Empty outside, and where samples are too far apart.
  std::optional<At> at(double time_s) const;

  /// How much each sample counts in at(time_s).value: pairs of index and weight. Empty where that is.
  std::vector<std::pair<std::size_t, double>> weights_at(double time_s) const;

  /// Standard deviation of a sample about the curve, for errors that are independent.
  double noise() const { return noise_; }
  std::size_t sample_count() const { return signal_.values.size(); }

  /// Straight between smoothed values at the samples: quick, for a search.
  std::optional<double> roughly_at(double time_s) const;

  /// The time over which samples count together.
  double width_s() const { return 2.0 * reach_s_; }
  double first_time_s() const { return signal_.values.front().time_s; }
  double last_time_s() const { return signal_.values.back().time_s; }

 private:
  struct Window;
  std::optional<Window> window_at(double time_s) const;
  bool is_gap(std::size_t before) const;

  Signal signal_;
  std::vector<std::optional<double>> smoothed_;
  double reach_s_ = 0.0;
  double max_gap_s_ = 0.0;
  double noise_ = 0.0;
};

}  // namespace fathom
