#include "acquisition/live/igtl_server.h"

#include <gtest/gtest.h>
#include <igtlClientSocket.h>
#include <igtlImageMessage.h>

#include "acquisition/live/default_sources.h"
#include "acquisition/live/replay_source.h"
#include "acquisition/rigid.h"
#include "core/error.h"
#include "tests/acquisition/live/heard.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

IgtlServerOptions any_port(std::uint64_t most_frames = UINT64_MAX) {
  IgtlServerOptions options;
  options.port = 0;
  options.most_frames = most_frames;
  return options;
}

void wait_for_clients(const IgtlServer& server, std::uint64_t count) {
  for (int i = 0; i < 1000 && server.counts().clients < count; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_EQ(server.counts().clients, count);
}

void play(LiveListener& listener, double speed = 100.0) {
  Heard end;
  // Events do not reach the listener of a server; so the end is heard here.
  struct Both : LiveListener {
    LiveListener* server = nullptr;
    Heard* heard = nullptr;
    void on_frame(LiveFrame frame) override { server->on_frame(std::move(frame)); }
    void on_sample(TrackerSample sample) override { server->on_sample(std::move(sample)); }
    void on_event(SourceEvent event) override { heard->on_event(std::move(event)); }
  } both;
  both.server = &listener;
  both.heard = &end;
  const auto source = make_replay("sample", std::make_unique<MemoryRecording>(sample_recording()), {.speed = speed});
  source->start(both);
  EXPECT_TRUE(end.wait_for_state(SourceState::kEnded));
  source->stop();
}

TEST(IgtlServer, SendsAllToAllClients) {
  IgtlServer server(any_port());
  const std::string peer = "igtl://127.0.0.1:" + std::to_string(server.port());
  Heard heard[2];
  std::unique_ptr<LiveSource> clients[2];
  for (int i = 0; i < 2; ++i) {
    clients[i] = default_sources().make(peer);
    clients[i]->start(heard[i]);
  }
  wait_for_clients(server, 2);
  play(server);
  EXPECT_TRUE(server.flush(10.0));
  const MemoryRecording recording = sample_recording();
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(heard[i].wait_for_frames(11));
    clients[i]->stop();
    ASSERT_EQ(heard[i].frames.size(), 11u);
    for (int f = 0; f < 11; ++f)
      EXPECT_TRUE(same_pixels(heard[i].frames[static_cast<std::size_t>(f)].image, recording.image(f)));
    std::size_t next = 0;
    for (const FrameHeader& frame : recording.header().frames) {
      for (std::size_t t = 0; t < frame.poses.size(); ++t) {
        if (!frame.poses[t] || !frame.poses[t]->valid() || !is_rigid(frame.poses[t]->matrix)) continue;
        ASSERT_LT(next, heard[i].samples.size());
        const TrackerSample& sample = heard[i].samples[next++];
        EXPECT_EQ(sample.transform, recording.header().transforms[t]);
        EXPECT_EQ(sample.pose.matrix, Eigen::Matrix4d(frame.poses[t]->matrix.cast<float>().cast<double>()));
      }
    }
    EXPECT_EQ(next, heard[i].samples.size());
  }
  const auto counts = server.counts();
  EXPECT_EQ(counts.frames_sent, 22u);
  EXPECT_EQ(counts.dropped_frames, 0u);
  // Stamped with the time of day: of this century.
  EXPECT_GT(*heard[0].frames[0].device_time_s, 1.6e9);
}

TEST(IgtlServer, IsUnderstoodByTheLibrarysOwnClient) {
  IgtlServer server(any_port(1));
  const auto socket = igtl::ClientSocket::New();
  ASSERT_EQ(socket->ConnectToServer("127.0.0.1", server.port()), 0);
  wait_for_clients(server, 1);
  const cv::Mat image = sample_recording().image(0).clone();
  for (int i = 0; i < 2; ++i) {
    LiveFrame frame;
    frame.image = image;
    server.on_frame(std::move(frame));
  }
  const auto header = igtl::MessageHeader::New();
  header->InitPack();
  ASSERT_EQ(socket->Receive(header->GetPackPointer(), header->GetPackSize()), header->GetPackSize());
  header->Unpack();
  EXPECT_STREQ(header->GetDeviceType(), "IMAGE");
  const auto message = igtl::ImageMessage::New();
  message->SetMessageHeader(header);
  message->AllocatePack();
  ASSERT_EQ(socket->Receive(message->GetPackBodyPointer(), message->GetPackBodySize()), message->GetPackBodySize());
  EXPECT_TRUE(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY);
  int size[3];
  message->GetDimensions(size);
  EXPECT_EQ(cv::Size(size[0], size[1]), image.size());
  EXPECT_TRUE(same_pixels(cv::Mat(image.size(), image.type(), message->GetScalarPointer()), image));
  socket->CloseSocket();
  EXPECT_EQ(server.counts().frames, 1u);  // the second is beyond most_frames
}

TEST(IgtlServer, ASlowClientLosesFramesAndHoldsUpNobody) {
  IgtlServer server(any_port());
  TcpSocket slow = connect_tcp("127.0.0.1", server.port(), {}, 5.0);  // never reads
  Heard heard;
  const auto client = default_sources().make("igtl://127.0.0.1:" + std::to_string(server.port()));
  client->start(heard);
  wait_for_clients(server, 2);
  const cv::Mat image(1000, 1000, CV_8UC1, cv::Scalar(5));
  constexpr std::size_t kFrames = 80;  // more than may wait for a client and than the system keeps
  for (std::size_t i = 0; i < kFrames; ++i) {
    LiveFrame frame;
    frame.image = image;
    server.on_frame(std::move(frame));
    EXPECT_TRUE(heard.wait_for_frames(i + 1));
  }
  client->stop();
  EXPECT_EQ(heard.frames.size(), kFrames);
  EXPECT_GT(server.counts().dropped_frames, 0u);
  EXPECT_LT(server.counts().dropped_frames, kFrames);
  EXPECT_FALSE(server.flush(0.1));
  slow.close();
  EXPECT_TRUE(server.flush(10.0));
}

TEST(IgtlServer, TellsOfAPortThatIsTaken) {
  IgtlServer server(any_port());
  IgtlServerOptions same = any_port();
  same.port = server.port();
  try {
    IgtlServer second(same);
    ADD_FAILURE() << "two servers have one port";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("choose another"), std::string::npos);
  }
}

}  // namespace
}  // namespace fathom
