#include <atomic>

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "acquisition/live/recorder.h"
#include "acquisition/recording.h"
#include "tests/acquisition/live/scripted_source.h"
#include "tests/scratch_folder.h"

namespace {

std::atomic<bool> g_disk_stands = false;
std::atomic<bool> g_is_waited_for = false;

}  // namespace

// In place of the system's own, for this whole program: a disk that takes as long as the test says.
extern "C" int fdatasync(int descriptor) {
  g_is_waited_for = g_disk_stands.load();
  g_disk_stands.wait(true);
  return static_cast<int>(::syscall(SYS_fdatasync, descriptor));
}

namespace fathom {
namespace {

/// The disk stands still while there is one.
class StandingDisk {
 public:
  StandingDisk() {
    g_is_waited_for = false;
    g_disk_stands = true;
  }
  ~StandingDisk() { go_on(); }
  void go_on() {
    g_disk_stands = false;
    g_disk_stands.notify_all();
  }
};

constexpr int kFrames = 100;
constexpr std::size_t kFrameBytes = 1'000'000;

std::size_t alive(const std::vector<std::weak_ptr<const TrackedFrame>>& frames) {
  std::size_t count = 0;
  for (const auto& frame : frames) count += frame.expired() ? 0 : 1;
  return count;
}

TEST(SlowDisk, HoldsUpNobodyTakesBoundedMemoryAndSaysWhatWasDropped) {
  constexpr std::size_t kMostBytes = 8'500'000, kRoom = 8;
  const ScratchFolder scratch;
  std::vector<cv::Mat> images;
  Recorder recorder(scratch / "scan", {.max_waiting_bytes = kMostBytes});
  StandingDisk disk;
  recorder.record();
  std::vector<std::weak_ptr<const TrackedFrame>> frames;
  double longest_s = 0.0;
  for (int i = 0; i < kFrames; ++i) {
    const SharedFrame frame = tracked_frame(10.0 + 0.02 * i, numbered_image(i, {1000, 1000}), i);
    frames.push_back(frame);
    const double start_s = live_clock_s();
    recorder.on_frame(frame);
    longest_s = std::max(longest_s, live_clock_s() - start_s);
    if (i < static_cast<int>(kRoom)) images.push_back(frame->frame.image.clone());
  }
  // The disk still stands: what is not let go now is what memory it costs.
  EXPECT_LT(longest_s, 0.1);
  EXPECT_EQ(alive(frames), kRoom);
  EXPECT_LE(alive(frames) * kFrameBytes, kMostBytes);
  const RecorderStatus status = recorder.status();
  EXPECT_EQ(status.state, RecorderState::kRecording);
  EXPECT_EQ(status.dropped_frames, kFrames - kRoom);
  EXPECT_NE(status.message.find("92 frames were dropped: the disk is too slow"), std::string::npos);

  disk.go_on();
  EXPECT_EQ(recorder.finish().frames, kRoom);
  EXPECT_EQ(alive(frames), 0u);
  const auto recording = open_recording(scratch / "scan");
  for (std::size_t i = 0; i < kRoom; ++i) {
    EXPECT_EQ(cv::norm(recording->image(static_cast<int>(i)), images[i], cv::NORM_INF), 0.0) << i;
  }
}

TEST(SlowDisk, RecordsOnWhenTheDiskComesBack) {
  const ScratchFolder scratch;
  Recorder recorder(scratch / "scan", {.max_waiting_frames = 4});
  recorder.record();
  StandingDisk disk;
  for (int i = 0; i < 10; ++i) recorder.on_frame(tracked_frame(10.0 + 0.02 * i, numbered_image(i), i));
  EXPECT_EQ(recorder.status().dropped_frames, 6u);
  disk.go_on();
  for (int i = 0; i < 1000 && recorder.status().frames < 4; ++i) ::usleep(1000);
  recorder.on_frame(tracked_frame(11.0, numbered_image(77), 77));
  const FinishedRecording finished = recorder.finish();
  EXPECT_EQ(finished.frames, 5u);
  EXPECT_EQ(recorder.status().dropped_frames, 6u);
  EXPECT_DOUBLE_EQ(finished.duration_s, 1.0);
}

TEST(SlowDisk, SamplesThatFindNoRoomAreCountedAndMarksAreKept) {
  constexpr int kSent = 50'500, kRoom = 50'000;
  const ScratchFolder scratch;
  Recorder recorder(scratch / "scan");
  recorder.record();
  StandingDisk disk;
  recorder.on_frame(tracked_frame(10.0, numbered_image(1), 1));
  while (!g_is_waited_for) ::usleep(1000);
  const TrackerSample sample{"ProbeToTracker", {shifted(1), "OK"}, 10.0, 10.0, {}};
  for (int i = 0; i < kSent; ++i) recorder.on_sample(sample);
  const std::uint64_t dropped = recorder.status().dropped_samples;
  EXPECT_EQ(dropped, kSent - kRoom);
  EXPECT_NE(recorder.status().message.find("samples"), std::string::npos);
  recorder.mark_invalid();
  disk.go_on();
  const FinishedRecording finished = recorder.finish();
  EXPECT_EQ(finished.invalid_frames, 1u);
  EXPECT_EQ(recorder.status().samples + dropped, static_cast<std::uint64_t>(kSent));
}

}  // namespace
}  // namespace fathom
