#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "acquisition/live/live_source.h"
#include "acquisition/live/tcp_socket.h"

namespace fathom {

struct IgtlServerOptions {
  std::string address = "127.0.0.1";       ///< of this computer; "0.0.0.0": whoever can reach it may look on
  int port = 18944;                        ///< 0: any that is free
  std::string image_device = "Image";      ///< what images are called
  std::uint64_t most_frames = UINT64_MAX;  ///< sent to anybody; what comes after these is not sent
};

/// An OpenIGTLink server: sends what it hears to all clients, frames as IMAGE and valid poses as TRANSFORM (headers of
/// version 1, which cannot state that a pose is invalid, so that invalid ones are not sent), stamped with this
/// computer's time of day. Patients' pictures: only the loopback address unless told otherwise.
///
/// A client that does not keep up loses frames, once kMostWaiting_bytes wait for it; it holds up nobody else. What
/// clients send is not listened to.
class IgtlServer : public LiveListener {
 public:
  static constexpr std::size_t kMostWaiting_bytes = std::size_t{32} << 20;
  static constexpr std::size_t kMostClients = 32;

  struct Counts {
    std::uint64_t clients = 0;         ///< that have connected so far
    std::uint64_t frames = 0;          ///< heard while there was any client, up to most_frames
    std::uint64_t frames_sent = 0;     ///< by all clients together, each of them whole
    std::uint64_t dropped_frames = 0;  ///< for clients that did not keep up
  };

  /// Throws Error when the port cannot be used.
  explicit IgtlServer(const IgtlServerOptions& options);
  ~IgtlServer() override;
  IgtlServer(const IgtlServer&) = delete;
  IgtlServer& operator=(const IgtlServer&) = delete;

  int port() const { return port_; }
  Counts counts() const;

  /// Waits at most `longest_s` for all that was heard to be on its way. Returns whether it is.
  bool flush(double longest_s);

  void on_frame(LiveFrame frame) override;
  void on_sample(TrackerSample sample) override;
  /// Events stay here.
  void on_event(SourceEvent) override {}

 private:
  struct Message {
    std::vector<std::byte> bytes;
    bool is_frame = false;
  };
  struct Client {
    TcpSocket socket;
    std::deque<std::shared_ptr<const Message>> waiting;
    std::size_t waiting_bytes = 0;
    std::size_t sent_of_first = 0;
    bool gone = false;
  };

  void hand_out(Message message);
  void serve(const std::stop_token& stop);
  void wait_for_something();
  void accept_clients();
  void send_waiting(Client& client);

  IgtlServerOptions options_;
  TcpSocket listener_;
  int port_ = 0;
  int wake_ = -1;               // an eventfd: something is to be sent
  double time_of_day_s_ = 0.0;  // minus live_clock_s()
  mutable std::mutex mutex_;
  std::condition_variable sent_;
  Counts counts_;
  std::deque<Client> clients_;
  std::jthread thread_;
};

}  // namespace fathom
