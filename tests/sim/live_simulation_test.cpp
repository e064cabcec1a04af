#include "sim/live_simulation.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "tests/acquisition/live/heard.h"

namespace fathom {
namespace {

SourceRegistry simulations() {
  SourceRegistry registry;
  add_simulated_sources(registry);
  return registry;
}

void play(const std::string& text, Heard& heard) {
  const auto source = simulations().make(text);
  source->start(heard);
  EXPECT_TRUE(heard.wait_for_state(SourceState::kEnded));
  source->stop();
}

std::vector<TrackerSample> probe_samples(const Heard& heard) {
  std::vector<TrackerSample> samples;
  std::copy_if(heard.samples.begin(), heard.samples.end(), std::back_inserter(samples),
               [](const TrackerSample& sample) { return sample.transform == "ProbeToTracker"; });
  return samples;
}

TEST(LiveSimulation, ShowsTheScanOfSimulateWithPosesInBetween) {
  SimulateOptions options;
  options.frames = 10;
  const SimulatedScan scan = simulate(options);
  Heard heard;
  play("sim:sphere/linear?frames=10&rate=100&tracker_rate=400&loop=0", heard);
  ASSERT_EQ(heard.frames.size(), 10u);
  const auto samples = probe_samples(heard);
  ASSERT_EQ(samples.size(), 39u);  // the last half a frame after the last image
  for (std::size_t f = 0; f < heard.frames.size(); ++f) {
    EXPECT_EQ(heard.frames[f].number, f);
    EXPECT_EQ(cv::norm(heard.frames[f].image, scan.recording->image(static_cast<int>(f)), cv::NORM_INF), 0.0);
    EXPECT_NEAR(samples[4 * f].time_s, heard.frames[f].time_s, 1e-9);
    const Eigen::Matrix4d& expected = scan.recording->header().frames[f].poses[0]->matrix;
    EXPECT_TRUE(samples[4 * f].pose.matrix.isApprox(expected, 1e-9)) << f;
    if (f == 9) continue;
    const Eigen::Matrix4d& next = scan.recording->header().frames[f + 1].poses[0]->matrix;
    EXPECT_TRUE(samples[4 * f + 2].pose.matrix.isApprox((expected + next) / 2.0, 1e-9)) << f;
  }
}

TEST(LiveSimulation, TheTrackersStampsAreLateByTheLatency) {
  Heard prompt;
  Heard late;
  play("sim:sphere/linear?frames=10&rate=100&tracker_rate=100&loop=0", prompt);
  play("sim:sphere/linear?frames=10&rate=100&tracker_rate=100&loop=0&latency_s=0.03", late);
  const auto true_poses = probe_samples(prompt);
  const auto late_poses = probe_samples(late);
  ASSERT_EQ(late_poses.size(), 10u);
  for (std::size_t i = 3; i < 10; ++i) {
    EXPECT_TRUE(late_poses[i].pose.matrix.isApprox(true_poses[i - 3].pose.matrix, 1e-9)) << i;
  }
}

TEST(LiveSimulation, GoesToAndFroUntilStopped) {
  Heard heard;
  const auto source = simulations().make("sim:sphere/linear?frames=5&rate=500");
  source->start(heard);
  EXPECT_TRUE(heard.wait_for_frames(12));
  source->stop();
  for (const auto& [frame, same] : {std::pair{5, 3}, {8, 0}, {9, 1}}) {
    EXPECT_EQ(heard.frames[static_cast<std::size_t>(frame)].image.data,
              heard.frames[static_cast<std::size_t>(same)].image.data);  // not even copied
  }
}

TEST(LiveSimulation, LosesTheProbeBetweenSweeps) {
  Heard heard;
  play("sim:sphere/sweeps-a?frames=8&rate=200&tracker_rate=200&loop=0", heard);
  const auto samples = probe_samples(heard);
  const auto lost =
      std::count_if(samples.begin(), samples.end(), [](const TrackerSample& s) { return !s.pose.valid(); });
  EXPECT_GT(lost, 10);
  EXPECT_LT(lost, static_cast<std::ptrdiff_t>(samples.size()));
  const auto black = std::count_if(heard.frames.begin(), heard.frames.end(),
                                   [](const LiveFrame& frame) { return cv::countNonZero(frame.image) == 0; });
  EXPECT_GE(black, lost - 1);
}

TEST(LiveSimulation, RefusesWhatThereIsNot) {
  for (const char* text : {"sim:sphere", "sim:banana/linear", "sim:sphere/zigzag", "sim:sphere/linear?rate=0",
                           "sim:sphere/linear?frames=0", "sim:sphere/linear?noise_mm=-1", "sim:"}) {
    EXPECT_THROW(simulations().make(text), Error) << text;
  }
}

}  // namespace
}  // namespace fathom
