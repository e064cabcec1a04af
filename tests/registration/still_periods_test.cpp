#include "registration/still_periods.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "tests/registration/coverage.h"
#include "tests/registration/poses.h"

namespace fathom {
namespace {

const Eigen::Vector3d kTip(5.0, -3.0, 140.0);
const std::vector<Eigen::Vector3d> kPlaces = {{0, 0, 0}, {80, 0, 10}, {70, 60, 0}, {-10, 50, 30}};

struct Pointing {
  double rest_s = 1.6;
  double move_s = 0.9;
  double noise_mm = 0.25;
  double rate_hz = 40.0;
};

// A pointer that rests on each of the places, turning all the time, and moves smoothly between them.
ProbePoses pointed(const Pointing& how, Random& random) {
  std::vector<std::optional<Eigen::Isometry3d>> poses;
  std::vector<double> times;
  const double leg_s = how.rest_s + how.move_s;
  const double end_s = leg_s * static_cast<double>(kPlaces.size()) - how.move_s;
  for (double time = 0.0; time < end_s; time += (0.7 + 0.6 * random.uniform()) / how.rate_hz) {
    const auto leg = static_cast<std::size_t>(time / leg_s);
    const double part = std::max(0.0, (time - leg_s * static_cast<double>(leg) - how.rest_s) / how.move_s);
    const double smooth = part * part * (3.0 - 2.0 * part);
    const Eigen::Vector3d next = kPlaces[std::min(leg + 1, kPlaces.size() - 1)];
    const Eigen::Vector3d tip = kPlaces[leg] + smooth * (next - kPlaces[leg]);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(0.3 * std::sin(2.0 * time), Eigen::Vector3d(1, 2, 0).normalized()).matrix();
    const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
    pose.translation() = tip - pose.linear() * kTip + how.noise_mm * noise;
    times.push_back(100.0 + time);
    if (random.uniform() < 0.05) {
      poses.emplace_back();
    } else {
      poses.emplace_back(pose);
    }
  }
  return {"test.mha", std::move(poses), std::move(times)};
}

TEST(StillPeriods, FindsThePlacesInTheirOrderWhateverTheNoise) {
  Random random(1);
  for (const double noise : {0.0, 0.05, 0.25, 0.6}) {
    Pointing how;
    how.noise_mm = noise;
    const auto periods = still_periods(pointed(how, random), kTip);
    ASSERT_EQ(periods.size(), kPlaces.size()) << noise;
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
      EXPECT_LT((periods[i].place_mm - kPlaces[i]).norm(), 0.05 + noise) << noise;
    }
  }
}

TEST(StillPeriods, StandardDeviationsOfPlacesCover) {
  Random random(2);
  Coverage coverage;
  for (int run = 0; run < 60; ++run) {
    const auto periods = still_periods(pointed({}, random), kTip);
    ASSERT_EQ(periods.size(), kPlaces.size());
    for (std::size_t i = 0; i < kPlaces.size(); ++i) coverage.add(periods[i].place_mm - kPlaces[i], periods[i].sd_mm);
  }
  expect_covered(coverage);
}

TEST(StillPeriods, APlaceTouchedAgainIsOnePlace) {
  Random random(3);
  const ProbePoses once = pointed({}, random);
  auto poses = once.poses();
  auto times = once.times_s();
  const double later = times.back() - times.front() + 0.9;
  const std::size_t count = poses.size();
  for (std::size_t i = 0; i < count; ++i) {
    poses.push_back(poses[i]);
    times.push_back(times[i] + later);
  }
  EXPECT_EQ(still_periods(ProbePoses("test.mha", poses, times), kTip).size(), kPlaces.size());
}

TEST(StillPeriods, RefusesATipThatNeverRestsOrNeverMoves) {
  Random random(4);
  Pointing restless;
  restless.rest_s = 0.0;
  EXPECT_THROW(still_periods(pointed(restless, random), kTip), Error);
  std::vector<std::optional<Eigen::Isometry3d>> still(200, Eigen::Isometry3d::Identity());
  std::vector<double> times;
  for (auto& pose : still) {
    pose->translation() = 0.3 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    times.push_back(0.025 * static_cast<double>(times.size()));
  }
  EXPECT_THROW(still_periods(ProbePoses("test.mha", still, times), kTip), Error);
  EXPECT_THROW(still_periods(ProbePoses("test.mha", still, {}), kTip), Error);
}

}  // namespace
}  // namespace fathom
