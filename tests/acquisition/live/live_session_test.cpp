#include "acquisition/live/live_session.h"

#include <chrono>
#include <limits>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "acquisition/live/frame_matcher.h"
#include "core/error.h"
#include "tests/acquisition/live/scripted_source.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

class Listener : public SessionListener {
 public:
  void on_frame(const SharedFrame& frame) override {
    const std::lock_guard lock(mutex_);
    frames_.push_back(frame);
  }
  void on_sample(const TrackerSample& sample) override {
    const std::lock_guard lock(mutex_);
    samples_.push_back(sample);
  }
  void on_event(const SessionEvent& event) override {
    const std::lock_guard lock(mutex_);
    events_.push_back(event);
  }
  std::vector<SharedFrame> frames() const {
    const std::lock_guard lock(mutex_);
    return frames_;
  }
  std::vector<TrackerSample> samples() const {
    const std::lock_guard lock(mutex_);
    return samples_;
  }
  int warnings(const std::string& text) const {
    const std::lock_guard lock(mutex_);
    int count = 0;
    for (const SessionEvent& event : events_) {
      count += event.warning && event.message.find(text) != std::string::npos ? 1 : 0;
    }
    return count;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<SharedFrame> frames_;
  std::vector<TrackerSample> samples_;
  std::vector<SessionEvent> events_;
};

/// A session of two scripted sources and a listener.
class Scripted {
 public:
  explicit Scripted(const SessionOptions& options = {}) {
    auto first = std::make_unique<ScriptedSource>("images");
    auto second = std::make_unique<ScriptedSource>("tracker");
    images = first.get();
    tracker = second.get();
    session = std::make_unique<LiveSession>(std::move(first), std::move(second), options);
    session->add(listener);
    session->start();
  }
  ~Scripted() { session->stop(); }

  Listener listener;
  ScriptedSource* images;
  ScriptedSource* tracker;
  std::unique_ptr<LiveSession> session;
  double now_s = live_clock_s() - 1.0;
};

const Pose& pose_of(const SharedFrame& frame) { return frame->poses.at(0).pose; }

TEST(PoseInterpolator, IsExactAtSamplesAndForScrewMotionsBetweenThem) {
  PoseInterpolator poses(0.2);
  for (int i = 0; i <= 5; ++i) poses.add({"T", {shifted(3.0 * i, 0.3 * i), "OK"}, 0.1 * i, 0.0, {}});
  EXPECT_EQ(poses.at({0.1 * 2, {}}).matrix, shifted(6.0, 0.6));
  for (const double time : {0.03, 0.17, 0.2501, 0.499}) {
    const Pose pose = poses.at({time, {}});
    EXPECT_TRUE(pose.valid());
    EXPECT_LT((pose.matrix - shifted(30.0 * time, 3.0 * time)).norm(), 1e-12) << time;
  }
  EXPECT_EQ(poses.at({-0.01, {}}).status, "MISSING");
  EXPECT_EQ(poses.at({0.51, {}}).status, "MISSING");
}

TEST(PoseInterpolator, HasNoPoseBesideAnInvalidSampleOrInALongGap) {
  PoseInterpolator poses(0.15);
  poses.add({"T", {shifted(0), "OK"}, 0.0, 0.0, {}});
  poses.add({"T", {shifted(1), "OUT_OF_VIEW"}, 0.1, 0.0, {}});
  poses.add({"T", {shifted(2), "OK"}, 0.2, 0.0, {}});
  poses.add({"T", {shifted(4), "OK"}, 0.4, 0.0, {}});
  for (const double time : {0.05, 0.1, 0.15}) EXPECT_EQ(poses.at({time, {}}).status, "OUT_OF_VIEW") << time;
  EXPECT_TRUE(poses.at({0.2, {}}).valid());
  EXPECT_EQ(poses.at({0.3, {}}).status, "MISSING");
  EXPECT_EQ(poses.at({0.3, {}}).matrix, Eigen::Matrix4d(Eigen::Matrix4d::Identity()));
  EXPECT_FALSE(poses.add({"T", {shifted(4), "OK"}, 0.4, 0.0, {}}));
}

TEST(FrameMatcher, WaitsForTheSampleBehindAFrameButNotForEver) {
  FrameMatcher matcher(SessionOptions{.max_gap_s = 0.2, .max_wait_s = 0.3}, false);
  const auto frame_at = [&](double time_s) {
    LiveFrame frame;
    frame.time_s = frame.arrival_s = time_s;
    matcher.add(std::move(frame));
  };
  const auto sample_at = [&](double time_s) {
    TrackerSample sample{"ProbeToTracker", {shifted(10 * time_s), "OK"}, time_s, time_s, {}};
    return matcher.add(sample);
  };
  sample_at(1.0);
  frame_at(1.05);
  EXPECT_FALSE(matcher.next(1.06));
  sample_at(1.1);
  const SharedFrame first = matcher.next(1.1);
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->valid());
  EXPECT_NEAR(first->poses.at(0).pose.matrix(0, 3), 10.5, 1e-12);
  frame_at(1.15);
  EXPECT_FALSE(matcher.next(1.44));
  const SharedFrame late = matcher.next(1.46);
  ASSERT_TRUE(late);
  EXPECT_FALSE(late->tracked);
}

TEST(FrameMatcher, TakesStampsThatCannotBeForNothing) {
  FrameMatcher matcher(SessionOptions{}, false);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  double last = 0.0;
  const double stamps[] = {10.0, 10.1, 3.0, 50.0, nan, 10.05, 10.4};
  const bool accepted[] = {true, true, false, false, false, false, true};
  for (int i = 0; i < 7; ++i) {
    LiveFrame frame;
    frame.time_s = stamps[i];
    frame.arrival_s = 10.05 + 0.06 * i;
    EXPECT_EQ(matcher.add(std::move(frame)), accepted[i]) << stamps[i];
    const SharedFrame out = matcher.next(100.0);
    ASSERT_TRUE(out);
    EXPECT_GT(out->frame.time_s, last);
    EXPECT_EQ(out->frame.status.empty(), accepted[i]);
    last = out->frame.time_s;
  }
}

TEST(FrameMatcher, NeedsOnlyTheTransformsThatPlaceTheProbe) {
  FrameMatcher matcher(SessionOptions{}, false);
  const auto sample = [&](const char* transform, const char* status) {
    TrackerSample one{transform, {shifted(1), status}, 1.0, 1.0, {}};
    matcher.add(one);
  };
  sample("StylusToTracker", "OUT_OF_VIEW");
  sample("ProbeToTracker", "OK");
  sample("ReferenceToTracker", "OK");
  LiveFrame frame;
  frame.time_s = frame.arrival_s = 1.0;
  matcher.add(frame);
  EXPECT_TRUE(matcher.next(1.0)->tracked);
  FrameMatcher strict(SessionOptions{.required_transforms = {"NeedleToTracker"}}, false);
  strict.add(frame);
  EXPECT_FALSE(strict.next(9.0)->tracked);
}

TEST(LiveSession, GivesFramesPosesOfTheirOwnTimeAndSharesPixels) {
  Scripted live;
  const cv::Mat image = numbered_image(1);
  live.tracker->sample(live.now_s, shifted(0));
  live.images->frame(live.now_s + 0.03, image);
  live.tracker->sample(live.now_s + 0.1, shifted(10));
  live.session->stop();
  const auto frames = live.listener.frames();
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0]->frame.image.data, image.data);
  EXPECT_TRUE(frames[0]->valid());
  EXPECT_NEAR(pose_of(frames[0]).matrix(0, 3), 3.0, 1e-6);
  EXPECT_EQ(live.listener.samples().size(), 2u);
  EXPECT_EQ(live.session->latest_frame(), frames[0]);
  EXPECT_EQ(live.session->statistics().transforms.at(0).samples, 2u);
}

TEST(LiveSession, SaysOnceThatTheTrackerLostTheProbeAndUsesNoPoseThatCannotBe) {
  Scripted live;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 6; ++i) {
    Eigen::Matrix4d pose = shifted(i);
    if (i == 2) pose(1, 1) = nan;
    if (i == 4) pose(1, 1) = 3.0;
    live.tracker->sample(live.now_s + 0.05 * i, pose);
    live.images->frame(live.now_s + 0.05 * i + 0.01, numbered_image(i));
  }
  live.session->stop();
  const auto frames = live.listener.frames();
  ASSERT_EQ(frames.size(), 6u);
  const bool valid[] = {true, false, false, false, false, false};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(frames[i]->valid(), valid[i]) << i;
  EXPECT_EQ(live.listener.warnings("has lost the probe (ProbeToTracker is NOT_FINITE)"), 1);
  EXPECT_EQ(live.listener.warnings("not a rotation and a shift"), 1);
  EXPECT_EQ(live.session->statistics().invalid_frames, 5u);
  EXPECT_EQ(live.session->statistics().transforms.at(0).not_valid, 2u);
}

TEST(LiveSession, TakesPosesOfTheImagesOwnDeviceTimeBitForBit) {
  auto both = std::make_unique<ScriptedSource>("both");
  ScriptedSource* source = both.get();
  LiveSession session(std::move(both), nullptr);
  Listener listener;
  session.add(listener);
  session.start();
  const double now_s = live_clock_s() - 1.0;
  for (int i = 0; i < 20; ++i) {
    // The two messages of one moment are mapped a little apart.
    source->frame(now_s + 0.02 * i + 0.001, numbered_image(i), 100.0 + 0.02 * i);
    source->sample(now_s + 0.02 * i, shifted(i, 0.1 * i), "OK", "ProbeToTracker", 100.0 + 0.02 * i);
  }
  session.stop();
  const auto frames = listener.frames();
  ASSERT_EQ(frames.size(), 20u);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(pose_of(frames[static_cast<std::size_t>(i)]).matrix, shifted(i, 0.1 * i));
}

TEST(LiveSession, DropsCountsAndTellsWhereAListenerIsTooSlow) {
  class Slow : public SessionListener {
   public:
    void on_frame(const SharedFrame&) override { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }
  } slow;
  Scripted live(SessionOptions{.max_waiting_frames = 4});
  live.session->add(slow);
  live.tracker->sample(live.now_s, shifted(0));
  live.tracker->sample(live.now_s + 0.1, shifted(1));
  for (int i = 0; i < 40; ++i) live.images->frame(live.now_s + 0.001 * (i + 1), numbered_image(i));
  live.session->stop();
  const SessionStatistics stats = live.session->statistics();
  EXPECT_GT(stats.images.dropped, 0u);
  EXPECT_EQ(stats.images.received, 40u);
  EXPECT_EQ(stats.frames + stats.images.dropped, 40u);
  EXPECT_EQ(stats.waiting, 0u);
  EXPECT_EQ(live.listener.warnings("some are dropped"), 1);
}

TEST(LiveSession, EndsWithItsImagesAndSaysThatTheirFormatHasChanged) {
  Scripted live;
  live.tracker->event(SourceState::kEnded, "ended");
  live.images->frame(live.now_s, numbered_image(0));
  live.images->frame(live.now_s + 0.1, numbered_image(1, {20, 10}));
  EXPECT_FALSE(live.session->ended());
  live.images->event(SourceState::kEnded, "ended");
  for (int i = 0; i < 200 && !live.session->ended(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(live.session->ended());
  EXPECT_EQ(live.listener.frames().size(), 2u);
  EXPECT_EQ(live.session->statistics().format_changes, 1u);
  EXPECT_EQ(live.listener.warnings("a calibration made for the former ones does not hold"), 1);
}

TEST(SessionOptions, RefusesWhatCannotBe) {
  EXPECT_NE(message_of<Error>([] { SessionOptions{.max_gap_s = 0.0}.check(); }), "");
  EXPECT_NE(message_of<Error>([] { SessionOptions{.max_wait_s = -1.0}.check(); }), "");
  EXPECT_NE(message_of<Error>([] { SessionOptions{.max_waiting_frames = 0}.check(); }), "");
}

}  // namespace
}  // namespace fathom
