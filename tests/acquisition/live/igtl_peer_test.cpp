#include <algorithm>
#include <cstdio>
#include <iostream>

#include <gtest/gtest.h>

#include "acquisition/live/default_sources.h"
#include "tests/acquisition/live/heard.h"
#include "tests/acquisition/live/peer_frames.h"
#include "tests/acquisition/sample_recording.h"
#include "tests/real_recordings.h"

// A real OpenIGTLink server in a process of its own.

namespace fathom {
namespace {

class Peer {
 public:
  Peer(const std::string& frames, double rate_hz, int count, int cut_every = 0) {
    const std::string command = std::string(FATHOM_IGTL_PEER) + " '" + frames + "' " + std::to_string(rate_hz) + " " +
                                std::to_string(count) + " " + std::to_string(cut_every);
    pipe_ = ::popen(command.c_str(), "r");
    if (pipe_ == nullptr || std::fscanf(pipe_, "%d", &port_) != 1) ADD_FAILURE() << "the peer does not start";
  }
  ~Peer() { ::pclose(pipe_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  std::string source() const { return "igtl://127.0.0.1:" + std::to_string(port_); }

  // Waits for its end.
  void read_counts(int& sent, int& unsent) {
    if (std::fscanf(pipe_, "%d %d", &sent, &unsent) != 2) ADD_FAILURE() << "the peer has died";
  }

 private:
  FILE* pipe_ = nullptr;
  int port_ = 0;
};

// Compares what comes with what was sent, and keeps none of it.
class Comparison : public LiveListener {
 public:
  explicit Comparison(const std::string& what) : frames_(what) {}

  void on_sample(TrackerSample sample) override { samples_.push_back(std::move(sample)); }

  void on_frame(LiveFrame frame) override {
    const int number = static_cast<int>(latencies_s.size());
    EXPECT_EQ(frame.number, static_cast<std::uint64_t>(number));
    EXPECT_TRUE(same_pixels(frame.image, frames_.image(number))) << number;
    EXPECT_LE(frame.time_s, frame.arrival_s);
    const auto sent = frames_.poses(number);
    ASSERT_EQ(samples_.size(), sent.size()) << number;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      EXPECT_EQ(samples_[i].transform, sent[i].name);
      EXPECT_TRUE(samples_[i].pose.valid());
      EXPECT_EQ(samples_[i].pose.matrix, Eigen::Matrix4d(sent[i].matrix.cast<float>().cast<double>())) << number;
      EXPECT_EQ(samples_[i].time_s, frame.time_s);
    }
    samples_.clear();
    latencies_s.push_back(frame.arrival_s - *frame.device_time_s);
    seen.on_frame({});
  }

  void on_event(SourceEvent event) override { seen.on_event(std::move(event)); }

  Heard seen;                       // counts the frames
  std::vector<double> latencies_s;  // from before the peer packs and sends a frame to its delivery

 private:
  PeerFrames frames_;
  std::vector<TrackerSample> samples_;
};

// Receives `count` frames and expects all of them as they were sent. Returns how long they took.
std::vector<double> expect_all(const std::string& what, double rate_hz, int count) {
  Comparison comparison(what);
  Peer peer(what, rate_hz, count);
  const auto source = default_sources().make(peer.source());
  source->start(comparison);
  EXPECT_TRUE(comparison.seen.wait_for_frames(static_cast<std::size_t>(count), 20.0 + count / rate_hz));
  source->stop();
  EXPECT_EQ(comparison.latencies_s.size(), static_cast<std::size_t>(count));
  EXPECT_EQ(comparison.seen.events.size(), 1u);  // connected, and no complaints
  return comparison.latencies_s;
}

double share_below_ms(std::vector<double> latencies_s, double share) {
  std::sort(latencies_s.begin(), latencies_s.end());
  return 1e3 * latencies_s.at(static_cast<std::size_t>(share * static_cast<double>(latencies_s.size() - 1)));
}

void print(const char* what, const std::vector<double>& latencies_s) {
  std::cout << what << ": " << latencies_s.size() << " frames; from send to delivery p50 "
            << share_below_ms(latencies_s, 0.5) << " ms, p99 " << share_below_ms(latencies_s, 0.99) << " ms, longest "
            << share_below_ms(latencies_s, 1.0) << " ms\n";
}

TEST(IgtlPeer, SendsARealRecordingBitForBit) {
  FATHOM_NEEDS_REAL_RECORDINGS();
  expect_all((real_recordings() / "fCal_Test_Calibration_3NWires_fCal2.0.igs.mha").string(), 1000.0, 100);
}

TEST(IgtlPeer, LosesNoFrame) { expect_all("820x616", 200.0, 120); }

void expect_cuts_accounted_for(double rate_hz, int count, int cut_every) {
  const PeerFrames frames("160x120");
  Peer peer("160x120", rate_hz, count, cut_every);
  Heard heard;
  const auto source = default_sources().make(peer.source());
  source->start(heard);
  int sent = 0;
  int unsent = 0;
  peer.read_counts(sent, unsent);
  EXPECT_TRUE(heard.wait_for_frames(static_cast<std::size_t>(sent)));
  source->stop();
  EXPECT_GT(unsent, 0);
  ASSERT_EQ(heard.frames.size(), static_cast<std::size_t>(sent));
  // Numbers tell which frame of the peer it is: those not sent are gaps, each in its place.
  for (const LiveFrame& frame : heard.frames) {
    EXPECT_TRUE(same_pixels(frame.image, frames.image(static_cast<int>(frame.number)))) << frame.number;
  }
  const auto cuts = std::count_if(heard.events.begin(), heard.events.end(), [](const SourceEvent& event) {
    return event.state == SourceState::kConnecting && event.message.find("ended the connection") != std::string::npos;
  });
  EXPECT_EQ(cuts, (sent - 1) / cut_every);
  EXPECT_TRUE(heard.was_told("frames lost while the line was cut"));
}

TEST(IgtlPeer, FramesAroundCutsAreAccountedFor) { expect_cuts_accounted_for(200.0, 150, 40); }

TEST(IgtlPeer, IsWaitedForWhereItIsNotThereYet) {
  int port = 0;
  {
    Peer gone("16x12", 100.0, 0);
    port = std::atoi(gone.source().substr(17).c_str());
    Heard nothing;
    const auto source = default_sources().make(gone.source());
    source->start(nothing);  // else it waits for somebody
    EXPECT_TRUE(nothing.wait_for_state(SourceState::kRunning));
    source->stop();
  }
  Heard heard;
  const auto source = default_sources().make("igtl://127.0.0.1:" + std::to_string(port));
  source->start(heard);
  EXPECT_TRUE(heard.wait_for_state(SourceState::kConnecting));
  source->stop();
  EXPECT_TRUE(heard.was_told("trying again"));
  EXPECT_EQ(heard.events.size(), 1u);
}

TEST(IgtlPeerStudy, SendsAllOfARealRecordingBitForBit) {
  FATHOM_NEEDS_REAL_RECORDINGS();
  expect_all((real_recordings() / "fCal_Test_Calibration_3NWires_fCal2.0.igs.mha").string(), 60.0, 400);
}

TEST(IgtlPeerStudy, SixtyFramesASecondForAMinute) {
  print("820 x 616 at 60 frames/s", expect_all("820x616", 60.0, 3600));
}

TEST(IgtlPeerStudy, LatencyAt640x480) {
  const auto latencies_s = expect_all("640x480", 60.0, 1800);
  print("640 x 480 at 60 frames/s", latencies_s);
  EXPECT_LE(share_below_ms(latencies_s, 0.99), 5.0);
}

TEST(IgtlPeerStudy, TenCuts) { expect_cuts_accounted_for(60.0, 60 * 20, 100); }

}  // namespace
}  // namespace fathom
