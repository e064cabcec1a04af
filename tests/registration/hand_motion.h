#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "registration/temporal_signals.h"

namespace fathom {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// A hand's way up and down, in mm: never quite the same again.
struct HandMotion {
  std::array<double, 5> phase{};
  explicit HandMotion(Random& random) {
    for (double& value : phase) value = random.uniform(0.0, kTwoPi);
  }
  double operator()(double time) const {
    constexpr std::array<double, 5> kHertz = {0.23, 0.47, 0.71, 1.13, 1.61};
    constexpr std::array<double, 5> kMm = {6.0, 7.0, 5.0, 3.0, 1.5};
    double place = 0.0;
    for (std::size_t i = 0; i < phase.size(); ++i) place += kMm[i] * std::sin(kTwoPi * kHertz[i] * time + phase[i]);
    return place;
  }
};

/// How it is recorded.
struct Recorded {
  double latency_s = 0.0;
  double duration_s = 10.0;
  double image_hz = 25.0;
  double tracker_hz = 40.0;
  double irregular = 0.3;  ///< of a frame's time
  double missing = 0.1;    ///< share of frames and of poses
  double image_noise_px = 1.0;
  double tracker_noise_mm = 0.3;
  double px_per_mm = -6.0;
};

struct Signals {
  Signal image{"image.mha", {}};
  Signal tracker{"tracker.mha", {}};
};

/// `motion` as images and a tracker see it.
inline Signals recorded(const Recorded& how, const std::function<double(double)>& motion, Random& random) {
  const auto times = [&](double hz, double missing) {
    std::vector<double> result;
    for (double time = random.uniform() / hz; time < how.duration_s; time += 1.0 / hz) {
      if (random.uniform() < missing) continue;
      result.push_back(100.0 + time + how.irregular * (random.uniform() - 0.5) / hz);
    }
    return result;
  };
  Signals signals;
  for (const double time : times(how.image_hz, how.missing)) {
    signals.image.values.push_back({time, 210.0 + how.px_per_mm * motion(time) + how.image_noise_px * random.normal()});
  }
  for (const double time : times(how.tracker_hz, how.missing)) {
    signals.tracker.values.push_back({time, motion(time - how.latency_s) + how.tracker_noise_mm * random.normal()});
  }
  return signals;
}

}  // namespace fathom
