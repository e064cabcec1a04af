#include <algorithm>
#include <atomic>
#include <iostream>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "acquisition/live/default_sources.h"
#include "acquisition/live/source_thread.h"
#include "acquisition/live/tcp_socket.h"
#include "acquisition/rigid.h"
#include "core/random.h"
#include "tests/acquisition/live/heard.h"
#include "tests/acquisition/live/igtl_bytes.h"

// Peers that send what no peer should.

namespace fathom {
namespace {

std::size_t below(Random& random, std::size_t end) {
  return static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(end)));
}

std::byte any_byte(Random& random) { return static_cast<std::byte>(below(random, 256)); }

Bytes good_message(Random& random) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix(0, 3) = random.normal();
  const cv::Mat image(7, 9, below(random, 2) == 0 ? CV_8UC1 : CV_16UC1, cv::Scalar(3));
  switch (below(random, 6)) {
    case 0:
      return igtl_image_message("Image", random.uniform(0.0, 1e6), image);
    case 1:
      return igtl_status_message("Tracker", static_cast<int>(below(random, 25)), "name", "text");
    case 2:
      return with_checksum(igtl_message("TDATA", Bytes(70 * below(random, 4), any_byte(random))));
    case 3:
      return with_checksum(igtl_message("QTDATA", Bytes(50 * below(random, 4), any_byte(random))));
    case 4:
      return with_checksum(igtl_message("POSITION", Bytes(28, any_byte(random))));
    default:
      return igtl_transform_message("ProbeToTracker", random.uniform(0.0, 1e6), matrix);
  }
}

// A message that is wrong somewhere, as its sender may have meant it: half of them with a checksum that is right.
Bytes hostile_message(Random& random) {
  Bytes bytes = good_message(random);
  if (below(random, 3) == 0) bytes = with_metadata(bytes, {{"TransformStatus", "INVALID"}, {"b", "c"}});
  const std::size_t faults = below(random, 5);
  for (std::size_t i = 0; i < faults; ++i) {
    // Most faults where sizes stand: in the header, or at the beginning of the body.
    const std::size_t end = below(random, 2) == 0 ? std::min<std::size_t>(bytes.size(), 90) : bytes.size();
    bytes[below(random, end)] = any_byte(random);
  }
  if (below(random, 4) == 0) bytes.resize(below(random, bytes.size() + 1));
  if (below(random, 4) == 0) bytes.resize(bytes.size() + below(random, 100), any_byte(random));
  return below(random, 2) == 0 && bytes.size() >= kIgtlHeader_bytes ? with_checksum(bytes) : bytes;
}

void expect_sound(const Pose& pose) {
  EXPECT_TRUE(pose.matrix.allFinite());
  EXPECT_TRUE(!pose.valid() || is_rigid(pose.matrix));
}

// Reads streams of hostile messages until `until_s`. Returns how many messages.
std::uint64_t read_hostile_streams(std::uint64_t seed, double until_s) {
  Random random(seed);
  std::uint64_t messages = 0;
  while (live_clock_s() < until_s) {
    Bytes bytes;
    for (std::size_t i = 0; i < 1 + below(random, 4); ++i) {
      const Bytes next = hostile_message(random);
      bytes.insert(bytes.end(), next.begin(), next.end());
    }
    MemoryStream stream(bytes);
    try {
      while (!stream.at_end()) {
        const IgtlMessage message = read_igtl_message(stream);
        ++messages;
        for (const IgtlPose& pose : message.poses) expect_sound(pose.pose);
        EXPECT_TRUE(message.fault.empty() || (message.image.empty() && message.poses.empty()));
      }
    } catch (const StreamError&) {
      continue;
    }
  }
  return messages;
}

// Serves hostile messages to whoever connects, then a good image to each who has come `good_after` times.
class HostilePeer {
 public:
  HostilePeer(std::uint64_t seed, double until_s)
      : listener_(listen_tcp("127.0.0.1", 0)), thread_([this, seed, until_s] { serve(seed, until_s); }) {}

  std::string source() const { return "igtl://127.0.0.1:" + std::to_string(listener_.local_port()); }
  int connections() const { return connections_; }

 private:
  static void send_all(TcpSocket& socket, const Bytes& bytes) {
    for (std::size_t at = 0; at < bytes.size();) at += socket.send(std::span(bytes).subspan(at), 1.0);
  }

  void serve(std::uint64_t seed, double until_s) {
    Random random(seed);
    while (true) {
      auto socket = listener_.accept(0.1);
      const bool good = live_clock_s() >= until_s;
      if (!socket) continue;
      ++connections_;
      try {
        if (good) {
          send_all(*socket, igtl_image_message("Image", 1.0, cv::Mat(4, 4, CV_8UC1, cv::Scalar(9))));
          socket->wait_for_input(10.0);  // until it goes
          return;
        }
        for (int i = 0; i < 200; ++i) send_all(*socket, hostile_message(random));
      } catch (const Error&) {
        continue;  // it has gone
      }
    }
  }

  TcpSocket listener_;
  std::atomic<int> connections_ = 0;
  std::jthread thread_;
};

// Returns how many connections there were.
int survive(std::uint64_t seed, double duration_s) {
  const double until_s = live_clock_s() + duration_s;
  HostilePeer peer(seed, until_s);
  Heard heard;
  // Names of images are as hostile as the rest.
  const auto source = default_sources().make(peer.source() + "?image=Image");
  source->start(heard);
  const auto good_came = [](const Heard& all) {
    return std::any_of(all.frames.begin(), all.frames.end(),
                       [](const LiveFrame& frame) { return frame.image.size() == cv::Size(4, 4); });
  };
  EXPECT_TRUE(heard.wait_for(good_came, duration_s + 20.0));
  source->stop();
  std::set<std::string> transforms;
  for (const TrackerSample& sample : heard.samples) {
    expect_sound(sample.pose);
    EXPECT_LE(sample.time_s, sample.arrival_s);
    transforms.insert(sample.transform);
  }
  EXPECT_LE(transforms.size(), 64u);
  // A flood of faults is no flood of events: some for each connection, and one every other second.
  EXPECT_LE(heard.events.size(),
            10u * static_cast<std::size_t>(peer.connections()) + static_cast<std::size_t>(duration_s));
  for (const SourceEvent& event : heard.events) EXPECT_LT(event.message.size(), 600u);
  return peer.connections();
}

TEST(HostilePeer, DoesNoHarm) {
  EXPECT_GT(read_hostile_streams(1, live_clock_s() + 0.5), 1000u);
  EXPECT_GE(survive(1, 0.3), 1);
}

TEST(HostilePeer, FloodsAreCountedAndNotToldOneByOne) {
  TcpSocket listener = listen_tcp("127.0.0.1", 0);
  Heard heard;
  const auto source = default_sources().make("igtl://127.0.0.1:" + std::to_string(listener.local_port()));
  source->start(heard);
  auto socket = listener.accept(10.0);
  ASSERT_TRUE(socket);
  Bytes flood;
  for (int i = 0; i < 5000; ++i) {
    Bytes bytes = igtl_transform_message("Probe" + std::to_string(i) + "ToTracker", {}, Eigen::Matrix4d::Identity());
    if (i % 2 == 0) bytes.back() ^= std::byte{1};
    flood.insert(flood.end(), bytes.begin(), bytes.end());
  }
  for (std::size_t at = 0; at < flood.size();) at += socket->send(std::span(flood).subspan(at), 1.0);
  socket->close();
  EXPECT_TRUE(heard.wait_for_state(SourceState::kConnecting));
  source->stop();
  EXPECT_EQ(heard.samples.size(), 64u);
  EXPECT_LT(heard.events.size(), 6u);
  // Every second is damaged, and only the first 64 of the others have a place.
  EXPECT_TRUE(heard.was_told("(and " + std::to_string(5000 - 64 - 2) + " more)"));
}

TEST(HostilePeer, ThatFallsSilentDoesNotKeepTheSourceFromStopping) {
  TcpSocket listener = listen_tcp("127.0.0.1", 0);
  Heard heard;
  const auto source = default_sources().make("igtl://127.0.0.1:" + std::to_string(listener.local_port()));
  source->start(heard);
  auto socket = listener.accept(10.0);
  ASSERT_TRUE(socket);
  const Bytes bytes = igtl_image_message("Image", {}, cv::Mat(400, 400, CV_8UC1, cv::Scalar(1)));
  socket->send(std::span(bytes).first(1000), 1.0);
  EXPECT_TRUE(heard.wait_for_state(SourceState::kRunning));
  const double before_s = live_clock_s();
  source->stop();
  EXPECT_LT(live_clock_s() - before_s, 5.0);
  EXPECT_TRUE(heard.frames.empty());
}

TEST(HostilePeerStudy, TenMinutes) {
  const std::uint64_t messages = read_hostile_streams(2, live_clock_s() + 300.0);
  const int connections = survive(2, 300.0);
  std::cout << messages << " messages in memory, " << connections << " hostile connections\n";
}

}  // namespace
}  // namespace fathom
