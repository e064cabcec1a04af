#pragma once

#include <chrono>
#include <cstdint>
#include <list>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <umockdev.h>

#include "tests/acquisition/live/polhemus_instrument.h"

namespace fathom {

/// How an instrument appears on the USB.
struct UsbProduct {
  std::uint16_t id = 0;
  std::uint8_t out = 0;
  std::uint8_t in = 0;
  std::uint8_t interrupt = 0;  ///< sends its records here; 0: on `in`
};

/// A Polhemus instrument on an emulated USB: sysfs, device node and uevents are umockdev's, the kernel's part (usbdevfs
/// requests) is played here. Works only in a process with umockdev's preloaded library.
class PolhemusUsbEmulation {
 public:
  PolhemusUsbEmulation(PolhemusModel model, const UsbProduct& product);
  ~PolhemusUsbEmulation();
  PolhemusUsbEmulation(const PolhemusUsbEmulation&) = delete;
  PolhemusUsbEmulation& operator=(const PolhemusUsbEmulation&) = delete;

  void plug_in();
  void unplug();

  std::vector<PolhemusReading> sent();
  void switch_off_and_on();
  /// Requests of kinds that are not played, as numbers; none may come.
  std::vector<unsigned long> unknown_requests();

  PolhemusInstrument instrument;  // to be set before it is plugged in
  std::size_t packet = 512;       // bytes that it gives at a time at most

 private:
  // A transfer of the driver.
  struct Urb {
    UMockdevIoctlData* data;
    UMockdevIoctlData* buffer;
  };

  static gboolean on_request(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self);
  bool handle(UMockdevIoctlClient* client);
  void submit(UMockdevIoctlClient* client);
  void reap(UMockdevIoctlClient* client);
  void reap_of_gone(UMockdevIoctlClient* client);
  void hand_over(UMockdevIoctlClient* client, int error_of_none);
  void discard(UMockdevIoctlClient* client);
  void measure();
  void forget(std::list<Urb>& urbs);

  UsbProduct product_;
  UMockdevTestbed* testbed_;
  std::string syspath_;
  std::vector<std::string> nodes_;  // of the devices so far
  int number_ = 1;                  // on the bus
  std::mutex mutex_;
  bool gone_ = true;
  std::chrono::steady_clock::time_point asked_;  // the last request
  std::list<Urb> waiting_, done_;
  std::map<std::uint8_t, std::string> queued_;  // by pipe, what the instrument has to give
  std::chrono::steady_clock::time_point measured_;
  std::vector<unsigned long> unknown_;
};

}  // namespace fathom
