#include "acquisition/live/replay_source.h"

#include <gtest/gtest.h>

#include "acquisition/live/default_sources.h"
#include "acquisition/rigid.h"
#include "core/error.h"
#include "tests/acquisition/live/heard.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

// What a source from text says when it cannot be made or started.
std::string complaint(const std::string& source) {
  Heard heard;
  try {
    const auto made = default_sources().make(source);
    made->start(heard);
    made->stop();
  } catch (const Error& error) {
    return error.what();
  }
  return "no complaint";
}

// Plays to the end.
void play(LiveSource& source, Heard& heard) {
  source.start(heard);
  EXPECT_TRUE(heard.wait_for_state(SourceState::kEnded));
  source.stop();
}

TEST(ReplaySource, DeliversAllThatTheRecordingHolds) {
  const TestFolder folder;
  const MemoryRecording recording = sample_recording();
  write_recording(recording, folder / "sample.mha");
  Heard heard;
  const auto source = default_sources().make("replay:" + (folder / "sample.mha").string() + "?speed=40");
  play(*source, heard);
  ASSERT_EQ(heard.frames.size(), 11u);
  std::size_t next = 0;
  for (std::size_t f = 0; f < heard.frames.size(); ++f) {
    SCOPED_TRACE(f);
    const LiveFrame& frame = heard.frames[f];
    const FrameHeader& expected = recording.header().frames[f];
    EXPECT_EQ(frame.number, f);
    EXPECT_EQ(frame.device_time_s, expected.time_s);
    EXPECT_EQ(frame.status, expected.image_status);
    EXPECT_EQ(frame.fields.size(), expected.fields.size());
    EXPECT_TRUE(same_pixels(frame.image, recording.image(static_cast<int>(f))));
    EXPECT_GE(frame.arrival_s, frame.time_s);
    for (std::size_t t = 0; t < expected.poses.size(); ++t) {
      if (!expected.poses[t] || (expected.poses[t]->valid() && !is_rigid(expected.poses[t]->matrix))) continue;
      ASSERT_LT(next, heard.samples.size());
      const TrackerSample& sample = heard.samples[next++];
      EXPECT_EQ(sample.transform, recording.header().transforms[t]);
      EXPECT_EQ(sample.pose, *expected.poses[t]);
      EXPECT_EQ(sample.time_s, frame.time_s);
    }
  }
  EXPECT_EQ(next, heard.samples.size());
  EXPECT_TRUE(heard.was_told("ImageToProbe is not rigid"));
}

TEST(ReplaySource, KeepsTheRecordingsTimeDividedByTheSpeed) {
  Heard heard;
  const double speed = 25.0;
  const MemoryRecording recording = sample_recording();
  play(*make_replay("sample", std::make_unique<MemoryRecording>(recording), {.speed = speed}), heard);
  ASSERT_EQ(heard.frames.size(), 11u);
  const double first_s = *recording.header().frames[0].time_s;
  for (const LiveFrame& frame : heard.frames) {
    if (!frame.device_time_s) continue;
    EXPECT_NEAR(frame.time_s - heard.frames[0].time_s, (*frame.device_time_s - first_s) / speed, 1e-9);
  }
  // The frame without a stamp comes in the middle between its neighbours.
  EXPECT_NEAR(heard.frames[3].time_s, (heard.frames[2].time_s + heard.frames[4].time_s) / 2.0, 1e-9);
}

TEST(ReplaySource, OfRecordingsWithoutStampsOrImagesSaysSoAndPlaysOn) {
  SampleOptions options;
  options.width = options.height = 0;
  const MemoryRecording poses = sample_recording(options);
  RecordingHeader header = poses.header();
  for (FrameHeader& frame : header.frames) frame.time_s.reset();
  Heard heard;
  play(*make_replay("poses", std::make_unique<MemoryRecording>("poses", header, std::vector<cv::Mat>()),
                    {.speed = 50.0}),
       heard);
  EXPECT_TRUE(heard.frames.empty());
  ASSERT_GT(heard.samples.size(), 20u);
  EXPECT_TRUE(heard.was_told("no time stamps"));
  EXPECT_NEAR(heard.samples.back().time_s - heard.samples.front().time_s, 10 / 25.0 / 50.0, 1e-9);
}

TEST(ReplaySource, LoopsUntilStoppedAndCountsOn) {
  Heard heard;
  const auto source =
      make_replay("sample", std::make_unique<MemoryRecording>(sample_recording()), {.speed = 500.0, .loop = true});
  source->start(heard);
  EXPECT_TRUE(heard.wait_for_frames(40));
  source->stop();
  source->stop();
  const std::size_t count = heard.frames.size();
  for (std::size_t f = 0; f < count; ++f) {
    EXPECT_EQ(heard.frames[f].number, f);
    EXPECT_TRUE(f == 0 || heard.frames[f].time_s > heard.frames[f - 1].time_s);
  }
  EXPECT_EQ(heard.frames[12].device_time_s, heard.frames[1].device_time_s);
}

TEST(ReplaySource, LosesADamagedFrameAndSaysSo) {
  const TestFolder folder;
  write_recording(sample_recording(), folder / "sample.mha", {.compress = true});
  std::string bytes = read_bytes(folder / "sample.mha");
  bytes[bytes.size() - 600] ^= 0x55;  // in the last frame
  folder.write("sample.mha", bytes);
  Heard heard;
  play(*default_sources().make("replay:" + (folder / "sample.mha").string() + "?speed=100"), heard);
  EXPECT_LT(heard.frames.size(), 11u);
  EXPECT_GT(heard.frames.size(), 0u);
  EXPECT_TRUE(heard.was_told("is lost"));
}

TEST(ReplaySource, StopsAtOnceInTheMiddleOfALongWait) {
  Heard heard;
  const auto source = make_replay("slow", std::make_unique<MemoryRecording>(sample_recording()), {.speed = 1e-3});
  source->stop();
  source->start(heard);
  EXPECT_TRUE(heard.wait_for_frames(1));
  source->stop();  // else the test's time limit ends it: the next frame is due in five minutes
  EXPECT_EQ(heard.frames.size(), 1u);
}

TEST(SourceAddresses, ThatAreWrongAreRefusedWithWhatToDo) {
  EXPECT_NE(complaint("replay").find("give one of: "), std::string::npos);
  EXPECT_NE(complaint("banana:x").find("replay:FILE"), std::string::npos);
  EXPECT_NE(complaint("replay:").find("names nothing"), std::string::npos);
  EXPECT_NE(complaint("replay:missing.mha").find("missing.mha"), std::string::npos);
  EXPECT_NE(complaint("replay:a.mha?speed=0").find("from 0.001 to 1000"), std::string::npos);
  EXPECT_NE(complaint("replay:a.mha?speed=nan").find("cannot be 'nan'"), std::string::npos);
  EXPECT_NE(complaint("replay:a.mha?loop=2").find("loop"), std::string::npos);
  EXPECT_NE(complaint("replay:a.mha?sped=1").find("no option 'sped'"), std::string::npos);
  EXPECT_NE(complaint("replay:a.mha?speed=1&speed=1").find("twice"), std::string::npos);
  EXPECT_NE(complaint("replay:what?.mha").find("what?.mha"), std::string::npos);
}

}  // namespace
}  // namespace fathom
