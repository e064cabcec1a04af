#include <chrono>
#include <cstdio>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "acquisition/live/recorder.h"
#include "acquisition/live/replay_source.h"
#include "tests/acquisition/live/scripted_source.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

constexpr double kRate_hz = 60.0;
constexpr double kDuration_s = 60.0;

double cpu_s() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double peak_mb() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// A second of noise at 820 x 616 and 60 frames/s, played over and over.
std::unique_ptr<LiveSource> source() {
  RecordingHeader header;
  header.width = 820;
  header.height = 616;
  header.pixel_type = CV_8UC1;
  header.transforms = {"ProbeToTracker"};
  std::vector<cv::Mat> images;
  for (int i = 0; i < static_cast<int>(kRate_hz); ++i) {
    FrameHeader frame;
    frame.time_s = i / kRate_hz;
    frame.poses = {Pose{shifted(i), "OK"}};
    header.frames.push_back(frame);
    images.push_back(numbered_image(i, {820, 616}));
  }
  ReplayOptions options;
  options.loop = true;
  return make_replay("replay", std::make_unique<MemoryRecording>("noise", header, images), options);
}

class Nothing : public SessionListener {
 public:
  void on_frame(const SharedFrame&) override {}
};

/// Plays for a while to a listener; returns the CPU time of the whole process, of one core's.
double share_of_core(SessionListener& listener) {
  LiveSession session(source(), nullptr);
  session.add(listener);
  session.start();
  const double start_s = cpu_s();
  std::this_thread::sleep_for(std::chrono::duration<double>(kDuration_s));
  const double used_s = cpu_s() - start_s;
  session.stop();
  EXPECT_EQ(session.statistics().images.dropped, 0u);
  return used_s / kDuration_s;
}

TEST(RecorderStudy, TakesATenthOfACoreAndBoundedMemoryBesideTheSource) {
  Nothing nothing;
  const double alone = share_of_core(nothing);
  const double memory_mb = peak_mb();
  const ScratchFolder scratch;
  Recorder recorder(scratch / "scan");
  recorder.record();
  const double recording = share_of_core(recorder);
  const double more_mb = peak_mb() - memory_mb;
  const FinishedRecording finished = recorder.finish();
  std::printf("source and session %.2f %% of a core, recorder %.2f %% more, %.0f MB more, %llu frames\n", 100 * alone,
              100 * (recording - alone), more_mb, static_cast<unsigned long long>(finished.frames));
  EXPECT_LE(recording - alone, 0.10);
  EXPECT_EQ(recorder.status().dropped_frames, 0u);
  EXPECT_EQ(recorder.status().invalid_frames, 0u);
  EXPECT_GE(finished.frames, static_cast<std::uint64_t>(kRate_hz * kDuration_s) - 2);
  EXPECT_LE(more_mb, 256 + 64);  // the queue's bound, and the writer's own
}

}  // namespace
}  // namespace fathom
