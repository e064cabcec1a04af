#include <atomic>
#include <filesystem>
#include <mutex>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include "acquisition/live/polhemus_source.h"
#include "core/error.h"
#include "tests/acquisition/live/heard.h"
#include "tests/acquisition/live/polhemus_instrument.h"
#include "tests/acquisition/live/polhemus_match.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

// An instrument on a pseudo-terminal that can be unplugged. Its end of the line breaks what it sends into pieces and
// may add noise or lose bytes.
class Terminal {
 public:
  explicit Terminal(PolhemusModel model) : instrument(model) {}
  ~Terminal() { unplug(); }

  void plug_in() {
    const int fd = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    ASSERT_GE(fd, 0);
    ASSERT_EQ(::grantpt(fd), 0);
    ASSERT_EQ(::unlockpt(fd), 0);
    std::error_code none;
    std::filesystem::remove(device(), none);
    std::filesystem::create_symlink(::ptsname(fd), device());
    plugged_ = true;
    thread_ = std::thread([this, fd] { serve(fd); });
  }

  void unplug() {
    plugged_ = false;
    if (thread_.joinable()) thread_.join();
  }

  std::string device() const { return folder_ / "tty"; }
  std::string source(const std::string& options = "") const { return "polhemus:" + device() + options; }

  /// What the instrument has sent until now.
  std::vector<PolhemusReading> sent() {
    const std::lock_guard lock(mutex_);
    return instrument.sent;
  }
  void switch_off_and_on() {
    const std::lock_guard lock(mutex_);
    instrument.power_on();
  }

  PolhemusInstrument instrument;  // to be set before it is plugged in
  double noise_share = 0.0;       // of measurements that are followed by noise
  double loss_share = 0.0;        // of measurements that lose a byte

 private:
  void serve(int fd) {
    Random random(12);
    while (plugged_) {
      pollfd state{fd, POLLIN, 0};
      poll(&state, 1, 2);
      char bytes[64];
      const ssize_t count = (state.revents & POLLIN) != 0 ? ::read(fd, bytes, sizeof bytes) : 0;
      std::string said;
      {
        const std::lock_guard lock(mutex_);
        if (count > 0) said = instrument.hear({bytes, static_cast<std::size_t>(count)});
        said += instrument.measure();
      }
      if (!said.empty() && random.uniform() < noise_share) said += std::string("\xff\x00LY\x01PA 01", 10);
      if (!said.empty() && random.uniform() < loss_share) {
        said.erase(static_cast<std::size_t>(random.uniform(0, static_cast<double>(said.size()))), 1);
      }
      for (std::size_t from = 0; from < said.size();) {
        const std::string part = said.substr(from, static_cast<std::size_t>(random.uniform(1, 40)));
        if (::write(fd, part.data(), part.size()) < 0) break;
        from += part.size();
      }
    }
    ::close(fd);
  }

  ScratchFolder folder_;
  std::mutex mutex_;
  std::atomic<bool> plugged_ = false;
  std::thread thread_;
};

std::unique_ptr<LiveSource> make(const std::string& source) {
  SourceRegistry registry;
  add_polhemus_sources(registry);
  return registry.make(source);
}

bool has_samples(const Heard& heard, std::size_t count) { return heard.samples.size() >= count; }

// Waits until the instrument is told to be back, and looks at the poses from then on.
void expect_right_poses_once_back(Heard& heard, LiveSource& source, Terminal& terminal) {
  EXPECT_TRUE(heard.wait_for([](const Heard& h) { return h.was_told("back after"); }));
  std::size_t before = 0;
  EXPECT_TRUE(heard.wait_for([&](const Heard& h) { return before = h.samples.size(), true; }));
  EXPECT_TRUE(heard.wait_for([&](const Heard& h) { return has_samples(h, before + 10); }));
  source.stop();
  const std::vector<TrackerSample> after(heard.samples.begin() + static_cast<std::ptrdiff_t>(before),
                                         heard.samples.end());
  EXPECT_EQ(missing(after, terminal.sent()), 0U);
}

void expect_all_poses(PolhemusModel model, const std::string& options) {
  Terminal terminal(model);
  terminal.plug_in();
  Heard heard;
  const auto source = make(terminal.source(options));
  source->start(heard);
  EXPECT_TRUE(heard.wait_for([](const Heard& h) { return has_samples(h, 60); }));
  source->stop();
  EXPECT_TRUE(heard.was_told(name_of(model)));
  EXPECT_EQ(missing(heard.samples, terminal.sent()), 0U);
  for (const TrackerSample& sample : heard.samples) {
    EXPECT_EQ(sample.pose.status, "OK");
    EXPECT_TRUE(sample.transform == "ProbeToTracker" || sample.transform == "ReferenceToTracker");
    EXPECT_LE(sample.time_s, sample.arrival_s);
    EXPECT_EQ(sample.device_time_s.has_value(), model != PolhemusModel::kFastrak);
  }
}

TEST(PolhemusSerial, DeliversEveryPoseOfAFastrak) { expect_all_poses(PolhemusModel::kFastrak, ""); }
TEST(PolhemusSerial, DeliversEveryPoseOfAFastrakAsText) { expect_all_poses(PolhemusModel::kFastrak, "?text=1"); }
TEST(PolhemusSerial, DeliversEveryPoseOfAPatriot) { expect_all_poses(PolhemusModel::kPatriot, "?baud=57600"); }
TEST(PolhemusSerial, DeliversEveryPoseOfAPatriotAsText) { expect_all_poses(PolhemusModel::kPatriot, "?text=1"); }
TEST(PolhemusSerial, DeliversEveryPoseOfALiberty) { expect_all_poses(PolhemusModel::kLiberty, ""); }
TEST(PolhemusSerial, DeliversEveryPoseOfALibertyAsText) { expect_all_poses(PolhemusModel::kLiberty, "?text=1"); }

class PolhemusSerialModel : public testing::TestWithParam<PolhemusModel> {};

TEST_P(PolhemusSerialModel, ThroughNoiseInventsNothingAndSaysWhatWasLost) {
  const PolhemusModel model = GetParam();
  Terminal terminal(model);
  terminal.noise_share = 0.3;
  terminal.loss_share = 0.1;
  terminal.plug_in();
  Heard heard;
  const auto source = make(terminal.source());
  source->start(heard);
  EXPECT_TRUE(heard.wait_for([](const Heard& h) { return has_samples(h, 300); }));
  source->stop();
  const std::size_t lost = missing(heard.samples, terminal.sent());
  EXPECT_GT(lost, 0U);
  EXPECT_LT(lost, heard.samples.size() / 8);  // a byte lost costs its record, no other
  EXPECT_TRUE(heard.was_told("belong to no whole record"));
  EXPECT_EQ(heard.was_told("records lost"), model == PolhemusModel::kLiberty);  // which alone counts
}

TEST(PolhemusSerial, ComesBackAfterItWasUnplugged) {
  Terminal terminal(PolhemusModel::kLiberty);
  terminal.plug_in();
  Heard heard;
  const auto source = make(terminal.source());
  source->start(heard);
  EXPECT_TRUE(heard.wait_for([](const Heard& h) { return has_samples(h, 10); }));
  terminal.unplug();
  EXPECT_TRUE(heard.wait_for_state(SourceState::kConnecting));
  terminal.switch_off_and_on();
  terminal.plug_in();
  expect_right_poses_once_back(heard, *source, terminal);
}

// Switched off and on it measures in inches again; unless it is set up anew a pose would be wrong by 2.54.
TEST(PolhemusSerial, IsSetUpAgainAfterItWasSwitchedOffAndOn) {
  Terminal terminal(PolhemusModel::kFastrak);
  terminal.plug_in();
  Heard heard;
  const auto source = make(terminal.source());
  source->start(heard);
  EXPECT_TRUE(heard.wait_for([](const Heard& h) { return has_samples(h, 10); }));
  terminal.switch_off_and_on();
  expect_right_poses_once_back(heard, *source, terminal);
}

// As after a program that died while the instrument was sending.
TEST(PolhemusSerial, IsSetUpWhileItIsSending) {
  for (const auto model : {PolhemusModel::kFastrak, PolhemusModel::kPatriot}) {
    Terminal terminal(model);
    terminal.instrument.hear(model == PolhemusModel::kFastrak ? "fC" : "F1\rC\r");
    terminal.plug_in();
    Heard heard;
    const auto source = make(terminal.source());
    source->start(heard);
    EXPECT_TRUE(heard.wait_for([](const Heard& h) { return has_samples(h, 2); }));
    source->stop();
    EXPECT_EQ(missing(heard.samples, terminal.sent()), 0U);
  }
}

TEST(PolhemusSerial, MarksPosesThatTheInstrumentDoubts) {
  Terminal terminal(PolhemusModel::kPatriot);
  terminal.instrument.distortion = 40;
  terminal.plug_in();
  for (const auto& [options, status] : {std::pair("", "DISTORTED"), std::pair("?distortion=50", "OK")}) {
    Heard heard;
    const auto source = make(terminal.source(options));
    source->start(heard);
    EXPECT_TRUE(heard.wait_for([](const Heard& h) { return has_samples(h, 2); }));
    source->stop();
    EXPECT_EQ(heard.samples[0].pose.status, status);
  }
}

TEST(PolhemusSerial, WithoutDistortionIsUsedWithout) {
  Terminal terminal(PolhemusModel::kPatriot);
  terminal.instrument.knows_distortion = false;
  terminal.plug_in();
  Heard heard;
  const auto source = make(terminal.source("?stations=Stylus,Probe"));
  source->start(heard);
  EXPECT_TRUE(heard.wait_for([](const Heard& h) { return has_samples(h, 20); }));
  source->stop();
  EXPECT_EQ(missing(heard.samples, terminal.sent()), 0U);
  EXPECT_EQ(heard.samples[0].transform, "StylusToTracker");
}

std::string refusal_of(PolhemusModel model, const std::function<void(PolhemusInstrument&)>& change) {
  Terminal terminal(model);
  change(terminal.instrument);
  terminal.plug_in();
  Heard heard;
  const auto source = make(terminal.source());
  return message_of<Error>([&] { source->start(heard); });
}

TEST_P(PolhemusSerialModel, ThatStaysWithInchesIsRefused) {
  const std::string message = refusal_of(GetParam(), [](PolhemusInstrument& i) { i.takes_centimetres = false; });
  EXPECT_NE(message.find("does not take centimetres"), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(, PolhemusSerialModel, testing::Values(PolhemusModel::kFastrak, PolhemusModel::kLiberty),
                         [](const auto& each) { return std::string(name_of(each.param)); });

TEST(PolhemusSerial, RefusesSilence) {
  const std::string silent = refusal_of(PolhemusModel::kLiberty, [](PolhemusInstrument& i) { i.answers = false; });
  EXPECT_NE(silent.find("nothing answers as a FASTRAK, PATRIOT or LIBERTY"), std::string::npos) << silent;
}

TEST(PolhemusSerial, RefusesWhatIsNoInstrument) {
  const auto message = [](const std::string& source) {
    return message_of<Error>([&] {
      Heard heard;
      make(source)->start(heard);
    });
  };
  EXPECT_NE(message("polhemus:/dev/ttyNone").find("/dev/ttyNone: cannot be opened"), std::string::npos);
  EXPECT_NE(message("polhemus:/dev/null").find("is no serial line"), std::string::npos);
  EXPECT_NE(message("polhemus:ttyUSB0").find("must be 'usb' or a serial line"), std::string::npos);
  EXPECT_NE(message("polhemus:usb?baud=9600").find("has no rate"), std::string::npos);
  EXPECT_NE(message("polhemus:/dev/ttyUSB0?stations=A,A").find("no two alike"), std::string::npos);
  EXPECT_NE(message("polhemus:/dev/ttyUSB0?colour=red").find("no option"), std::string::npos);
  Terminal terminal(PolhemusModel::kLiberty);
  terminal.plug_in();
  EXPECT_NE(message(terminal.source("?baud=12345")).find("is no rate of the instruments"), std::string::npos);
}

}  // namespace
}  // namespace fathom
