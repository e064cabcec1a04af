#include "acquisition/live/igtl_source.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "acquisition/live/clock_mapping.h"
#include "acquisition/live/fault_log.h"
#include "acquisition/live/frame_counter.h"
#include "acquisition/live/igtl_reader.h"
#include "acquisition/live/source_address.h"
#include "acquisition/live/source_thread.h"
#include "acquisition/live/tcp_socket.h"
#include "acquisition/orientation.h"
#include "core/error.h"
#include "core/numbers.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr double kConnect_s = 3.0;
constexpr double kShortestPause_s = 0.1;  // before another try; doubled while there is no use in it
constexpr double kLongestPause_s = 1.6;
constexpr double kSlice_s = 0.05;       // how often waiting looks whether it shall stop
constexpr double kMidMessage_s = 10.0;  // a peer that is silent for so long in the middle of a message is gone
constexpr double kSilence_s = 3.0;      // between messages: said, but no fault
constexpr std::size_t kMostNames = 64;  // of transforms and images: no room has more tools

struct Peer {
  std::string host;
  int port = kIgtlPort;
  std::string image;        // empty: the first that comes
  Orientation orientation;  // of the images sent
};

class SocketStream : public ByteStream {
 public:
  SocketStream(TcpSocket& socket, const std::stop_token& stop) : socket_(socket), stop_(stop) {}

  void read(std::span<std::byte> out) override {
    double silent_since_s = live_clock_s();
    while (!out.empty()) {
      const auto count = receive(out);
      if (count == 0u) throw StreamError("the peer ended the connection");
      if (count) {
        out = out.subspan(*count);
        silent_since_s = live_clock_s();
      } else if (stop_.stop_requested()) {
        throw StreamError("stopped");
      } else if (live_clock_s() - silent_since_s > kMidMessage_s) {
        throw StreamError("the peer fell silent in the middle of a message");
      }
    }
  }

 private:
  std::optional<std::size_t> receive(std::span<std::byte> out) {
    try {
      return socket_.receive(out, kSlice_s);
    } catch (const Error& error) {
      throw StreamError(error.what());
    }
  }

  TcpSocket& socket_;
  const std::stop_token& stop_;
};

class IgtlSource : public LiveSource {
 public:
  IgtlSource(std::string name, Peer peer) : name_(std::move(name)), peer_(std::move(peer)) {}

  const std::string& name() const override { return name_; }

  void start(LiveListener& listener) override {
    listener_ = &listener;
    away_.clear();
    thread_.start(name_, listener, [this](const std::stop_token& stop) { run(stop); });
  }

  void stop() override { thread_.stop(); }

 private:
  void tell(SourceState state, const std::string& what) { listener_->on_event(make_event(state, name_, what)); }

  // A peer that comes and goes is reported each time, one that stays away once for each reason.
  void tell_away(const std::string& why) {
    if (why == away_) return;
    away_ = why;
    tell(SourceState::kConnecting, why + "; trying again");
  }

  void run(const std::stop_token& stop) {
    double pause_s = kShortestPause_s;
    while (!stop.stop_requested()) {
      try {
        TcpSocket socket = connect_tcp(peer_.host, peer_.port, stop, kConnect_s);
        away_.clear();
        tell(SourceState::kRunning, "connected");
        understood_ = false;
        receive(socket, stop);
      } catch (const Error& error) {
        if (!stop.stop_requested()) tell_away(error.what());
      }
      faults_.tell_rest(*listener_, name_);
      cut_ = true;
      if (understood_) pause_s = kShortestPause_s;
      understood_ = false;
      wait_until(stop, live_clock_s() + pause_s);
      pause_s = std::min(2.0 * pause_s, kLongestPause_s);
    }
  }

  // Until the connection ends, by an Error, or this is told to stop.
  void receive(TcpSocket& socket, const std::stop_token& stop) {
    SocketStream stream(socket, stop);
    clock_ = ClockMapping();  // the peer may be another
    jumps_ = 0;
    double last_s = live_clock_s();
    bool silent = false;
    while (!stop.stop_requested()) {
      if (!socket.wait_for_input(kSlice_s)) {
        faults_.tell_due(*listener_, name_);
        if (!silent && live_clock_s() - last_s > kSilence_s) {
          silent = true;
          tell(SourceState::kRunning, "connected, but nothing has come for " + format_real(kSilence_s) + " s");
        }
        continue;
      }
      last_s = live_clock_s();
      silent = false;
      take(read_igtl_message(stream), last_s);
    }
  }

  void take(IgtlMessage message, double first_byte_s) {
    if (!message.fault.empty()) {
      if (message.header.type == "IMAGE") frames_.lose(1);
      faults_.add(*listener_, name_, message.fault);
      return;
    }
    understood_ = true;
    if (!message.complaint.empty()) faults_.add(*listener_, name_, "the peer reports " + message.complaint);
    if (message.image.empty() && message.poses.empty()) return;
    const double time_s = map(message.header.time_s, first_byte_s);
    if (!message.image.empty()) take_image(std::move(message), time_s);
    for (IgtlPose& pose : message.poses) take_pose(message.header, std::move(pose), time_s);
  }

  // One stamp has one time, though the line may have moved a little since: poses and images are told together by it.
  double map(const std::optional<double>& stamp_s, double arrival_s) {
    if (!stamp_s) return arrival_s;
    const double time_s = clock_.map(*stamp_s, arrival_s);
    if (clock_.jumps() != jumps_) {
      jumps_ = clock_.jumps();
      tell(SourceState::kRunning, "the peer's clock was set by " + format_rounded(clock_.last_jump_s(), 3) + " s");
    } else if (last_stamp_s_ == stamp_s) {
      return last_time_s_;
    }
    last_stamp_s_ = stamp_s;
    last_time_s_ = time_s;
    return time_s;
  }

  void take_image(IgtlMessage message, double time_s) {
    if (peer_.image.empty()) peer_.image = message.header.device;
    if (message.header.device != peer_.image) {
      if (is_new(message.header.device, other_images_)) {
        tell(SourceState::kRunning, "there are also images of '" + printable(message.header.device) +
                                        "', which are left out; to have them give ?image=NAME");
      }
      return;
    }
    LiveFrame frame;
    frame.arrival_s = live_clock_s();
    frame.device_time_s = message.header.time_s;
    const FrameCounter::Time time{frame.device_time_s, frame.arrival_s};
    if (std::exchange(cut_, false) && had_frames_) tell_lost(frames_.lose_until(time));
    had_frames_ = true;
    frame.image = std::move(message.image);
    flip_to_mf(frame.image, peer_.orientation);
    frame.number = frames_.next(time);
    frame.time_s = time_s;
    frame.fields = std::move(message.fields);
    listener_->on_frame(std::move(frame));
  }

  void tell_lost(const std::optional<std::uint64_t>& frames) {
    tell(SourceState::kRunning, (frames ? std::to_string(*frames) : "an unknown number of") +
                                    std::string(" frames lost while the line was cut"));
  }

  void take_pose(const IgtlHeader& header, IgtlPose pose, double time_s) {
    if (!transforms_.contains(pose.transform)) {
      if (transforms_.size() == kMostNames) {
        faults_.add(*listener_, name_, "more than " + std::to_string(kMostNames) + " transforms; others are left out");
        return;
      }
      transforms_.insert(pose.transform);
    }
    listener_->on_sample({std::move(pose.transform), std::move(pose.pose), time_s, live_clock_s(), header.time_s});
  }

  // Whether it was not there before, and there is room for it.
  static bool is_new(const std::string& name, std::set<std::string>& names) {
    return names.size() < kMostNames && names.insert(name).second;
  }

  std::string name_;
  Peer peer_;
  LiveListener* listener_ = nullptr;
  std::string away_;
  bool understood_ = false;
  bool cut_ = false;
  bool had_frames_ = false;
  FaultLog faults_;
  FrameCounter frames_;
  ClockMapping clock_;
  int jumps_ = 0;
  std::optional<double> last_stamp_s_;
  double last_time_s_ = 0.0;
  std::set<std::string> transforms_;
  std::set<std::string> other_images_;
  SourceThread thread_;
};

// "//host:port", "//[::1]:18944".
Peer peer_of(const SourceAddress& address) {
  const auto malformed = [&address] { address.fail("is no peer; give igtl://host:port"); };
  std::string place = address.target;
  if (!place.starts_with("//")) malformed();
  place.erase(0, 2);
  if (place.ends_with('/')) place.pop_back();
  Peer peer;
  const std::size_t bracket = place.rfind(']');
  const std::size_t colon = place.find(':', bracket == std::string::npos ? 0 : bracket);
  peer.host = place.substr(0, colon);
  if (peer.host.starts_with('[') && peer.host.ends_with(']')) peer.host = peer.host.substr(1, peer.host.size() - 2);
  if (colon != std::string::npos) {
    const auto port = parse_real(place.substr(colon + 1));
    if (!port || *port < 1.0 || *port > 65535.0 || *port != std::floor(*port)) {
      address.fail("there is no such port; give a whole number from 1 to 65535");
    }
    peer.port = static_cast<int>(*port);
  }
  if (peer.host.empty()) malformed();
  return peer;
}

std::unique_ptr<LiveSource> make_from_text(const std::string& source) {
  const SourceAddress address = parse_source(source, {"image", "orientation"});
  Peer peer = peer_of(address);
  if (const auto image = address.options.find("image"); image != address.options.end()) peer.image = image->second;
  if (const auto text = address.options.find("orientation"); text != address.options.end()) {
    const auto orientation = parse_orientation(text->second);
    if (!orientation) address.fail("there is no such orientation; give MF, MN, UF or UN");
    peer.orientation = *orientation;
  }
  return std::make_unique<IgtlSource>(source, std::move(peer));
}

}  // namespace

void add_igtl_sources(SourceRegistry& registry) {
  registry.add("igtl", {"igtl://host:port", "an OpenIGTLink server: PLUS, 3D Slicer, scanners and trackers",
                        make_from_text, [] { return std::vector<FoundDevice>(); }});
}

}  // namespace fathom
