#include "registration/temporal_calibration.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/registration/coverage.h"
#include "tests/registration/hand_motion.h"

namespace fathom {
namespace {

std::string refusal(const Signals& signals, const TemporalOptions& options = {}) {
  try {
    find_latency(signals.image, signals.tracker, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TemporalCalibration, FindsLatenciesOfHalfASecondToTwoMilliseconds) {
  Random random(1);
  for (double latency = -0.48; latency < 0.5; latency += 0.06) {
    Recorded how;
    how.latency_s = latency;
    const Signals signals = recorded(how, HandMotion(random), random);
    const TemporalCalibration result = find_latency(signals.image, signals.tracker);
    EXPECT_NEAR(result.latency_s, latency, 0.002);
    EXPECT_NEAR(result.px_per_mm, -6.0, 0.1);
    EXPECT_GT(result.correlation, 0.99);
    EXPECT_LT(result.stddev_s, 0.002);
  }
}

TEST(TemporalCalibration, IsExactWithoutNoise) {
  Random random(2);
  Recorded how;
  how.latency_s = 0.1234;
  how.image_noise_px = 0.0;
  how.tracker_noise_mm = 0.0;
  const Signals signals = recorded(how, HandMotion(random), random);
  EXPECT_NEAR(find_latency(signals.image, signals.tracker).latency_s, 0.1234, 2e-4);
}

Coverage coverage(const Recorded& how, Random& random) {
  TemporalOptions options;
  options.max_latency_s = 0.1;
  Coverage result;
  Recorded run_of = how;
  for (int run = 0; run < 400; ++run) {
    run_of.latency_s = random.uniform(-0.05, 0.05);
    const Signals signals = recorded(run_of, HandMotion(random), random);
    const TemporalCalibration fit = find_latency(signals.image, signals.tracker, options);
    result.add(Eigen::VectorXd::Constant(1, fit.latency_s - run_of.latency_s),
               Eigen::VectorXd::Constant(1, fit.stddev_s));
  }
  return result;
}

TEST(TemporalCalibration, StandardDeviationsCoverNoiseOfImages) {
  Random random(3);
  Recorded how;
  how.image_noise_px = 4.0;
  how.tracker_noise_mm = 0.0;
  expect_covered(coverage(how, random));
}

TEST(TemporalCalibration, StandardDeviationsCoverNoiseOfTheTracker) {
  Random random(4);
  Recorded how;
  how.image_noise_px = 0.5;
  how.tracker_noise_mm = 0.5;
  expect_covered(coverage(how, random));
}

// Frames and poses stamped alike: the noise of the poses must not pull the latency to half-way between them.
TEST(TemporalCalibration, StandardDeviationsCoverRecordingsWithOneClock) {
  Random random(5);
  TemporalOptions options;
  options.max_latency_s = 0.1;
  Coverage result;
  double mean = 0.0;
  for (int run = 0; run < 400; ++run) {
    const HandMotion motion(random);
    Signals signals;
    for (int i = 0; i < 250; ++i) {
      const double time = 0.04 * i;
      signals.image.values.push_back({time, 100.0 + 6.0 * motion(time) + random.normal()});
      signals.tracker.values.push_back({time, motion(time - 0.01) + 0.5 * random.normal()});
    }
    const TemporalCalibration fit = find_latency(signals.image, signals.tracker, options);
    result.add(Eigen::VectorXd::Constant(1, fit.latency_s - 0.01), Eigen::VectorXd::Constant(1, fit.stddev_s));
    mean += (fit.latency_s - 0.01) / 400.0;
  }
  expect_covered(result);
  EXPECT_LT(std::abs(mean), 2e-4);
}

// A floor that is not quite flat and a probe that tilts: errors of a hand's speed, not of single frames.
TEST(TemporalCalibration, StandardDeviationsCoverErrorsThatHangTogether) {
  Random random(9);
  TemporalOptions options;
  options.max_latency_s = 0.1;
  Coverage result;
  Recorded how;
  how.duration_s = 20.0;
  for (int run = 0; run < 200; ++run) {
    Signals signals = recorded(how, HandMotion(random), random);
    double drift = 0.0;
    for (TimedValue& value : signals.image.values) {
      drift = 0.85 * drift + random.normal();  // counts together over 0.25 s
      value.value += drift;
    }
    const TemporalCalibration fit = find_latency(signals.image, signals.tracker, options);
    result.add(Eigen::VectorXd::Constant(1, fit.latency_s), Eigen::VectorXd::Constant(1, fit.stddev_s));
  }
  EXPECT_LT(result.spread(), 1.15);
  EXPECT_GT(result.spread(), 0.9);
}

TEST(TemporalCalibration, MistakenFloorsDoNotPull) {
  Random random(6);
  Recorded how;
  how.latency_s = 0.15;
  Signals signals = recorded(how, HandMotion(random), random);
  for (TimedValue& value : signals.image.values) {
    if (random.uniform() < 0.1) value.value = random.uniform(0.0, 480.0);
  }
  const TemporalCalibration result = find_latency(signals.image, signals.tracker);
  EXPECT_NEAR(result.latency_s, 0.15, 0.002);
  EXPECT_LT(result.frames_used, result.frames_seen);
}

TEST(TemporalCalibration, PeriodicMotionIsRefusedUntilTheRangeTells) {
  Random random(7);
  Recorded how;
  how.latency_s = 0.06;
  const auto regular = [](double time) { return 12.0 * std::sin(kTwoPi * 1.25 * time); };  // half a period is 0.4 s
  const Signals signals = recorded(how, regular, random);
  EXPECT_NE(refusal(signals).find("repeats itself"), std::string::npos) << refusal(signals);
  TemporalOptions narrow;
  narrow.max_latency_s = 0.15;
  EXPECT_NEAR(find_latency(signals.image, signals.tracker, narrow).latency_s, 0.06, 0.002);
}

// What people do: up and down, about once a second, never quite alike.
TEST(TemporalCalibration, AnUnsteadyRhythmIsEnough) {
  Random random(10);
  for (int run = 0; run < 20; ++run) {
    Recorded how;
    how.latency_s = random.uniform(-0.3, 0.3);
    const double phase = random.uniform(0.0, kTwoPi);
    const auto rhythm = [phase](double time) {
      const double wander = 0.9 * std::sin(0.8 * time + phase) + 0.5 * std::sin(2.1 * time);
      return (12.0 + 4.0 * std::sin(0.9 * time + 2.0 * phase)) * std::sin(kTwoPi * 0.9 * time + wander);
    };
    const Signals signals = recorded(how, rhythm, random);
    EXPECT_NEAR(find_latency(signals.image, signals.tracker).latency_s, how.latency_s, 0.002);
  }
}

TEST(TemporalCalibration, SaysWhyThereIsNoLatency) {
  Random random(8);
  const HandMotion motion(random);
  const auto none = [](double) { return 0.0; };
  EXPECT_NE(refusal(recorded({}, none, random)).find("did not move"), std::string::npos);
  Signals signals = recorded({}, motion, random);
  signals.image = recorded({}, none, random).image;
  EXPECT_NE(refusal(signals).find("floor does not move"), std::string::npos);

  signals = recorded({}, motion, random);
  signals.tracker = recorded({}, HandMotion(random), random).tracker;
  EXPECT_NE(refusal(signals).find("does not follow"), std::string::npos) << refusal(signals);

  signals = recorded({}, motion, random);
  for (TimedValue& value : signals.tracker.values) value.time_s += 3600.0;
  EXPECT_NE(refusal(signals).find("too little time"), std::string::npos);

  const auto one_way = [](double time) { return 4.0 * time; };
  EXPECT_NE(refusal(recorded({}, one_way, random)).find("up and down"), std::string::npos);

  Recorded late;
  late.latency_s = 0.8;
  const std::string beyond = refusal(recorded(late, motion, random));
  EXPECT_NE(beyond, "accepted");
}

}  // namespace
}  // namespace fathom
