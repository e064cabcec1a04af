#include "acquisition/live/igtl_server.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "acquisition/live/igtl_wire.h"
#include "core/error.h"

namespace fathom {

namespace {

constexpr int kSlice_ms = 100;  // how often waiting looks whether it shall stop

double time_of_day_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

IgtlServer::IgtlServer(const IgtlServerOptions& options)
    : options_(options),
      listener_(listen_tcp(options.address, options.port)),
      port_(listener_.local_port()),
      wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      // Once, so that stamps advance as the live clock does even where the time of day is set meanwhile.
      time_of_day_s_(time_of_day_s() - live_clock_s()),
      thread_([this](const std::stop_token& stop) { serve(stop); }) {}

IgtlServer::~IgtlServer() {
  thread_ = {};
  ::close(wake_);
}

IgtlServer::Counts IgtlServer::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

bool IgtlServer::flush(double longest_s) {
  std::unique_lock lock(mutex_);
  return sent_.wait_for(lock, std::chrono::duration<double>(longest_s), [this] {
    return std::all_of(clients_.begin(), clients_.end(),
                       [](const Client& client) { return client.gone || client.waiting.empty(); });
  });
}

void IgtlServer::on_frame(LiveFrame frame) {
  {
    const std::lock_guard lock(mutex_);
    if (counts_.frames == options_.most_frames || clients_.empty()) return;
    ++counts_.frames;
  }
  hand_out({igtl_image_message(options_.image_device, frame.time_s + time_of_day_s_, frame.image), true});
}

void IgtlServer::on_sample(TrackerSample sample) {
  if (!sample.pose.valid()) return;
  {
    const std::lock_guard lock(mutex_);
    if (counts_.frames == options_.most_frames || clients_.empty()) return;
  }
  hand_out({igtl_transform_message(sample.transform, sample.time_s + time_of_day_s_, sample.pose.matrix), false});
}

void IgtlServer::hand_out(Message message) {
  const auto shared = std::make_shared<const Message>(std::move(message));
  {
    const std::lock_guard lock(mutex_);
    for (Client& client : clients_) {
      if (client.waiting_bytes > kMostWaiting_bytes) {
        counts_.dropped_frames += shared->is_frame ? 1 : 0;
        continue;
      }
      client.waiting.push_back(shared);
      client.waiting_bytes += shared->bytes.size();
    }
  }
  ::eventfd_write(wake_, 1);
}

void IgtlServer::serve(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    wait_for_something();
    accept_clients();
    const std::lock_guard lock(mutex_);
    for (Client& client : clients_) send_waiting(client);
    std::erase_if(clients_, [](const Client& client) { return client.gone; });
    sent_.notify_all();
  }
}

void IgtlServer::wait_for_something() {
  std::vector<pollfd> entries{{wake_, POLLIN, 0}, {listener_.descriptor(), POLLIN, 0}};
  {
    const std::lock_guard lock(mutex_);
    for (const Client& client : clients_) {
      const int events = client.waiting.empty() ? POLLIN : POLLIN | POLLOUT;
      entries.push_back({client.socket.descriptor(), static_cast<short>(events), 0});
    }
  }
  ::poll(entries.data(), entries.size(), kSlice_ms);
  eventfd_t ignored;
  ::eventfd_read(wake_, &ignored);
}

void IgtlServer::accept_clients() {
  while (auto socket = listener_.accept(0.0)) {
    const std::lock_guard lock(mutex_);
    if (clients_.size() == kMostClients) continue;  // closes it
    clients_.emplace_back().socket = std::move(*socket);
    ++counts_.clients;
  }
}

void IgtlServer::send_waiting(Client& client) {
  try {
    // Nothing is expected of clients but their end; what they send must not fill up, or they could not go on.
    std::array<std::byte, 4096> ignored;
    if (client.socket.receive(ignored, 0.0) == 0u) client.gone = true;
    while (!client.gone && !client.waiting.empty()) {
      const auto& message = *client.waiting.front();
      const std::size_t sent = client.socket.send(std::span(message.bytes).subspan(client.sent_of_first), 0.0);
      if (sent == 0) return;
      client.sent_of_first += sent;
      if (client.sent_of_first < message.bytes.size()) continue;
      counts_.frames_sent += message.is_frame ? 1 : 0;
      client.waiting_bytes -= message.bytes.size();
      client.sent_of_first = 0;
      client.waiting.pop_front();
    }
  } catch (const Error&) {
    client.gone = true;
  }
}

}  // namespace fathom
