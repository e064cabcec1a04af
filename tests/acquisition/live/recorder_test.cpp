#include "acquisition/live/recorder.h"

#include <chrono>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "core/error.h"
#include "tests/acquisition/live/scripted_source.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

std::string field(const Recording& recording, const std::string& name) {
  for (const auto& [known, value] : recording.header().fields) {
    if (known == name) return value;
  }
  return "none";
}

std::string frame_field(const Recording& recording, std::size_t frame, const std::string& name) {
  for (const auto& [known, value] : recording.header().frames.at(frame).fields) {
    if (known == name) return value;
  }
  return "none";
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

void wait_for_frames(const Recorder& recorder, std::uint64_t frames) {
  for (int i = 0; i < 400 && recorder.status().frames < frames; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

/// Frame i at 10 + i/50 s, i mm along x.
std::vector<SharedFrame> frames_of(int count, cv::Size size = {16, 12}, int type = CV_8UC1) {
  std::vector<SharedFrame> frames;
  for (int i = 0; i < count; ++i) frames.push_back(tracked_frame(10.0 + 0.02 * i, numbered_image(i, size, type), i));
  return frames;
}

TEST(Recorder, WritesARecordingThatIsReadBackToTheLastBit) {
  for (const int type : {CV_8UC1, CV_16SC1, CV_32FC1, CV_8UC3}) {
    const ScratchFolder scratch;
    const cv::Mat large = numbered_image(9, {40, 30}, type);
    auto frames = frames_of(5, {16, 12}, type);
    // A cropped image is a view of a larger one.
    frames.push_back(tracked_frame(11.0, large(cv::Rect(3, 4, 16, 12)), 0.1, "OUT_OF_VIEW"));
    Recorder recorder(scratch / "scan", {.fields = {{"ImageSource", "test"}}});
    recorder.record();
    recorder.on_sample({"ProbeToTracker", {shifted(1), "OK"}, 9.9, 9.9, 3.25});
    for (const SharedFrame& frame : frames) recorder.on_frame(frame);
    const FinishedRecording finished = recorder.finish();
    EXPECT_EQ(finished.frames, 6u);
    EXPECT_EQ(finished.invalid_frames, 1u);
    EXPECT_DOUBLE_EQ(finished.duration_s, 1.0);
    EXPECT_EQ(finished.lost_bytes, 0u);

    const auto recording = open_recording(scratch / "scan");
    ASSERT_EQ(recording->header().frame_count(), 6);
    EXPECT_EQ(field(*recording, "latency_applied_s"), "0");
    EXPECT_EQ(field(*recording, "ImageSource"), "test");
    for (int i = 0; i < 6; ++i) {
      const auto index = static_cast<std::size_t>(i);
      EXPECT_TRUE(equal(recording->image(i), frames[index]->frame.image)) << i;
      const FrameHeader& header = recording->header().frames[index];
      EXPECT_EQ(header.time_s, frames[index]->frame.time_s);
      EXPECT_EQ(header.poses.at(0), frames[index]->poses[0].pose);
    }
    std::vector<TrackerSample> samples;
    for_each_sample(scratch / "scan", [&](const TrackerSample& sample) { samples.push_back(sample); });
    ASSERT_EQ(samples.size(), 1u);
    EXPECT_EQ(samples[0].pose.matrix, shifted(1));
    EXPECT_EQ(samples[0].device_time_s, 3.25);
  }
}

TEST(Recorder, OverwritesNothingAndSaysWhereItCannotRecord) {
  const ScratchFolder scratch;
  std::filesystem::create_directory(scratch / "scan");
  put(scratch / "scan" / "sweep.raw", "kept");
  const auto message = [&](const std::string& name) {
    return message_of<Error>([&] { Recorder recorder(scratch / name); });
  };
  EXPECT_NE(message("scan").find("choose another name, nothing was overwritten"), std::string::npos);
  EXPECT_NE(message("scan/sweep.raw").find("nothing was overwritten"), std::string::npos);
  EXPECT_NE(message("no/such").find("create the folder above it first"), std::string::npos);
  EXPECT_EQ(content_of(scratch / "scan" / "sweep.raw"), "kept");
  Recorder recorder(scratch / "empty");
  recorder.record();
  EXPECT_NE(message_of<Error>([&] { recorder.finish(); }).find("no frame was recorded"), std::string::npos);
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"scan"});
}

TEST(Recorder, PausesBeginsSweepsAndMarksThemInvalid) {
  const ScratchFolder scratch;
  const auto frames = frames_of(12);
  Recorder recorder(scratch / "scan");
  const auto send = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) recorder.on_frame(frames[i]);
  };
  send(0, 1);
  EXPECT_EQ(recorder.status().state, RecorderState::kPaused);
  recorder.record();
  send(1, 4);
  recorder.new_sweep();
  recorder.new_sweep();  // nothing between: one sweep
  send(4, 6);
  recorder.mark_invalid();
  send(6, 8);
  recorder.pause();
  send(8, 10);
  recorder.record();
  send(10, 11);
  recorder.end();
  send(11, 12);
  EXPECT_EQ(recorder.finish().invalid_frames, 2u);
  EXPECT_EQ(recorder.status().invalid_frames, 2u);
  const auto recording = open_recording(scratch / "scan");
  const int number[] = {1, 2, 3, 4, 5, 6, 7, 10};
  ASSERT_EQ(recording->header().frame_count(), 8);
  for (int i = 0; i < 8; ++i) {
    const auto index = static_cast<std::size_t>(i);
    EXPECT_EQ(recording->image(i).at<std::uint8_t>(0, 0), number[i]);
    EXPECT_EQ(frame_field(*recording, index, "Sweep"), i < 3 ? "0" : i < 7 ? "1" : "2");
    EXPECT_EQ(recording->header().frames[index].image_valid(), i != 3 && i != 4);
  }
}

TEST(Recorder, IsGatedByAProbeThatIsHeldStill) {
  const ScratchFolder scratch;
  Recorder recorder(scratch / "scan", {.gate = HoldStillOptions{.duration_s = 0.5}});
  recorder.record();
  // Moves for 1 s, rests for 1 s, sweeps 100 mm for 2 s, rests for 2 s, moves away.
  const auto x_mm = [](double t) {
    return t < 1 ? 50 * t : t < 2 ? 50.0 : t < 4 ? 50 + 50 * (t - 2) : t < 6 ? 150.0 : 150 - 50 * (t - 6);
  };
  for (int i = 0; i < 350; ++i) {
    const double time_s = 0.02 * i;
    recorder.on_frame(tracked_frame(100.0 + time_s, numbered_image(i), x_mm(time_s) + 0.2 * (i % 2)));
    if (i == 60) {
      EXPECT_EQ(recorder.status().state, RecorderState::kWaiting);
    }
    if (i == 90) {
      EXPECT_EQ(recorder.status().gate, GateState::kReady);
    }
    if (i == 150) {
      EXPECT_EQ(recorder.status().gate, GateState::kSweeping);
    }
    if (i == 250) {
      EXPECT_EQ(recorder.status().state, RecorderState::kPaused);
    }
  }
  EXPECT_EQ(recorder.status().gate, GateState::kClosed);
  recorder.finish();
  const auto recording = open_recording(scratch / "scan");
  // All of the sweep, and of the rests no more than half a second, and the way that counts as still.
  EXPECT_NEAR(*recording->header().frames.front().time_s, 101.5, 0.05);
  EXPECT_NEAR(*recording->header().frames.back().time_s, 104.5, 0.05);
}

TEST(Recorder, EndsBeforeImagesOfAnotherSizeAndKeepsWhatThereIs) {
  const ScratchFolder scratch;
  Recorder recorder(scratch / "scan");
  recorder.record();
  for (const SharedFrame& frame : frames_of(4)) recorder.on_frame(frame);
  recorder.on_frame(tracked_frame(20.0, numbered_image(0, {16, 13}), 0));
  for (int i = 0; i < 400 && recorder.status().state != RecorderState::kEnded; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(recorder.status().state, RecorderState::kEnded);
  EXPECT_NE(recorder.status().message.find("changed to 16 x 13 pixels"), std::string::npos);
  EXPECT_EQ(recorder.finish().frames, 4u);
  EXPECT_EQ(open_recording(scratch / "scan")->header().frame_count(), 4);
}

TEST(Recorder, DropsFramesRatherThanHoldUpTheSource) {
  const ScratchFolder scratch;
  Recorder recorder(scratch / "scan", {.max_waiting_frames = 1});
  recorder.record();
  const cv::Mat image = numbered_image(0, {1000, 1000});
  for (int i = 0; i < 100; ++i) recorder.on_frame(tracked_frame(10.0 + 0.01 * i, image, i));
  const FinishedRecording finished = recorder.finish();
  EXPECT_GT(recorder.status().dropped_frames, 0u);
  EXPECT_EQ(finished.frames + recorder.status().dropped_frames, 100u);
  EXPECT_NE(recorder.status().message.find("the disk is too slow"), std::string::npos);
}

TEST(Recorder, KeepsEveryWholeFrameWhereTheDiskTakesNoMore) {
  const ScratchFolder scratch;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const auto frames = frames_of(60, {400, 300});
  {
    Recorder recorder(scratch / "scan", {.sync_interval_s = 0.01});
    recorder.record();
    const rlimit limit{5'000'000, before.rlim_max};  // 41 frames and a part
    setrlimit(RLIMIT_FSIZE, &limit);
    for (const SharedFrame& frame : frames) recorder.on_frame(frame);
    EXPECT_EQ(recorder.finish().frames, 41u);
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_NE(recorder.status().message.find("File too large"), std::string::npos);
  }
  const auto recording = open_recording(scratch / "scan");
  ASSERT_EQ(recording->header().frame_count(), 41);
  for (int i = 0; i < 41; ++i) {
    EXPECT_TRUE(equal(recording->image(i), frames[static_cast<std::size_t>(i)]->frame.image));
  }
  EXPECT_EQ(std::filesystem::file_size(scratch / "scan/sweep.raw"), 41u * 400 * 300);
  EXPECT_FALSE(std::filesystem::exists(scratch / "scan/.sweep.reserve"));
}

TEST(Recorder, TellsHowLongTheDiskWillDo) {
  const ScratchFolder scratch;
  Recorder recorder(scratch / "scan", {.sync_interval_s = 0.01});
  recorder.record();
  for (const SharedFrame& frame : frames_of(20)) {
    recorder.on_frame(frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  wait_for_frames(recorder, 20);
  const double bytes_per_s = 19 * 16 * 12 / 0.38;
  const double expected = static_cast<double>(std::filesystem::space(scratch / "scan").available) / bytes_per_s / 60;
  for (int i = 0; i < 200 && !recorder.status().minutes_left; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_TRUE(recorder.status().minutes_left);
  EXPECT_NEAR(*recorder.status().minutes_left / expected, 1.0, 0.3);
}

TEST(RecorderOptions, RefusesWhatCannotBe) {
  EXPECT_NE(message_of<Error>([] { RecorderOptions{.sync_interval_s = 0.0}.check(); }), "");
  EXPECT_NE(message_of<Error>([] { RecorderOptions{.max_waiting_frames = 0}.check(); }), "");
  EXPECT_NE(message_of<Error>([] { RecorderOptions{.gate = HoldStillOptions{.radius_mm = 0.0}}.check(); }), "");
}

}  // namespace
}  // namespace fathom
