#include "acquisition/live/polhemus_usb.h"

#include <cstdlib>
#include <optional>
#include <ostream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "acquisition/live/polhemus_source.h"
#include "core/error.h"
#include "tests/acquisition/live/heard.h"
#include "tests/acquisition/live/polhemus_match.h"
#include "tests/acquisition/live/polhemus_usb_emulation.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

struct Case {
  PolhemusModel model;
  UsbProduct product;
  const char* name;
};

// As it is named in lists of tests.
void PrintTo(const Case& each, std::ostream* stream) { *stream << each.name; }

constexpr Case kPatriot = {PolhemusModel::kPatriot, {0xef12, 0x02, 0x82, 0}, "PATRIOT"};
constexpr Case kLiberty = {PolhemusModel::kLiberty, {0xff20, 0x04, 0x88, 0}, "LIBERTY HS"};
constexpr Case kFastrak = {PolhemusModel::kFastrak, {0x0002, 0x02, 0x82, 0x84}, "FASTRAK"};

class PolhemusUsb : public testing::TestWithParam<Case> {
 protected:
  void plug_in(const Case& instrument) {
    usb_.emplace(instrument.model, instrument.product);
    usb_->plug_in();
  }

  static std::unique_ptr<LiveSource> make() {
    SourceRegistry registry;
    add_polhemus_sources(registry);
    return registry.make("polhemus:usb");
  }

  std::string refusal() {
    return message_of<Error>([&] {
      Heard heard;
      make()->start(heard);
    });
  }

  std::optional<PolhemusUsbEmulation> usb_;
};

TEST_P(PolhemusUsb, DeliversEveryPose) {
  plug_in(GetParam());
  EXPECT_EQ(find_polhemus_usb(), std::vector{"Polhemus " + std::string(GetParam().name) + " on the USB"});
  Heard heard;
  const auto source = make();
  source->start(heard);
  EXPECT_TRUE(heard.wait_for([](const Heard& h) { return h.samples.size() >= 100; }));
  source->stop();
  EXPECT_EQ(missing(heard.samples, usb_->sent()), 0U);
  EXPECT_TRUE(heard.samples[0].pose.valid());
  EXPECT_EQ(usb_->unknown_requests(), std::vector<unsigned long>());
}

INSTANTIATE_TEST_SUITE_P(, PolhemusUsb, testing::Values(kFastrak, kPatriot, kLiberty),
                         [](const auto& each) { return std::string(name_of(each.param.model)); });

using PolhemusUsbFaults = PolhemusUsb;

TEST_F(PolhemusUsbFaults, PacketsMayCutRecordsAnywhere) {
  plug_in(kLiberty);
  usb_->packet = 13;
  Heard heard;
  const auto source = make();
  source->start(heard);
  EXPECT_TRUE(heard.wait_for([](const Heard& h) { return h.samples.size() >= 30; }));
  source->stop();
  EXPECT_EQ(missing(heard.samples, usb_->sent()), 0U);
}

TEST_F(PolhemusUsbFaults, UnpluggedItIsWaitedForAndSetUpAgain) {
  plug_in(kPatriot);
  Heard heard;
  const auto source = make();
  source->start(heard);
  EXPECT_TRUE(heard.wait_for([](const Heard& h) { return h.samples.size() >= 10; }));
  usb_->unplug();
  EXPECT_TRUE(heard.wait_for_state(SourceState::kConnecting));
  EXPECT_TRUE(heard.was_told("the PATRIOT is gone"));
  EXPECT_TRUE(find_polhemus_usb().empty());
  usb_->switch_off_and_on();
  usb_->plug_in();
  EXPECT_TRUE(heard.wait_for([](const Heard& h) { return h.was_told("back after"); }));
  std::size_t before = 0;
  EXPECT_TRUE(heard.wait_for([&](const Heard& h) { return before = h.samples.size(), true; }));
  EXPECT_TRUE(heard.wait_for([&](const Heard& h) { return h.samples.size() >= before + 10; }));
  source->stop();
  heard.samples.erase(heard.samples.begin(), heard.samples.begin() + static_cast<std::ptrdiff_t>(before));
  EXPECT_EQ(missing(heard.samples, usb_->sent()), 0U);
}

TEST_F(PolhemusUsbFaults, SaysWhatIsWrongWithAnInstrument) {
  usb_.emplace(PolhemusModel::kLiberty, kLiberty.product);  // a bus without devices
  EXPECT_NE(refusal().find("no instrument is there"), std::string::npos) << refusal();
  EXPECT_TRUE(find_polhemus_usb().empty());
  usb_.reset();
  plug_in({PolhemusModel::kLiberty, {0xff21, 0x04, 0x88, 0}, ""});
  EXPECT_NE(refusal().find("LIBERTY HS has not got its firmware"), std::string::npos) << refusal();
  usb_.reset();
  plug_in({PolhemusModel::kLiberty, {0xcf01, 0x04, 0x88, 0}, ""});
  EXPECT_NE(refusal().find("G4 is not supported"), std::string::npos) << refusal();
  usb_.reset();
  plug_in({PolhemusModel::kLiberty, {0xff20, 0x02, 0x82, 0}, ""});
  EXPECT_NE(refusal().find("has not the pipes of its kind"), std::string::npos) << refusal();
}

TEST_F(PolhemusUsbFaults, StayingWithInchesItIsRefused) {
  usb_.emplace(kLiberty.model, kLiberty.product);
  usb_->instrument.takes_centimetres = false;
  usb_->plug_in();
  EXPECT_NE(refusal().find("does not take centimetres"), std::string::npos) << refusal();
}

}  // namespace
}  // namespace fathom

// The thread sanitizer does not see the locks of libraries that were built without it.
extern "C" const char* __tsan_default_suppressions() {
  return "race:libumockdev.so\nrace:libglib-2.0.so\nrace:libgobject-2.0.so\nrace:libudev.so\n";
}

// umockdev puts its devices before programs by a library that must be loaded before all others.
int main(int argc, char** argv) {
  const std::string library = "libumockdev-preload.so.0";
  const char* preloaded = std::getenv("LD_PRELOAD");
  if (!preloaded || std::string(preloaded).find(library) == std::string::npos) {
    ::setenv("LD_PRELOAD", (library + (preloaded ? ":" + std::string(preloaded) : "")).c_str(), 1);
    // The address sanitizer wants to be the first library, and need not be.
    const char* options = std::getenv("ASAN_OPTIONS");
    ::setenv("ASAN_OPTIONS", (std::string(options ? options : "") + ":verify_asan_link_order=0").c_str(), 1);
    ::execv("/proc/self/exe", argv);
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
