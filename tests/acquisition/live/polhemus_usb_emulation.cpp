#include "tests/acquisition/live/polhemus_usb_emulation.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <thread>

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

namespace fathom {

namespace {

constexpr auto kMeasureEvery = std::chrono::milliseconds(4);  // 240 a second

std::string hex(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  char digits[3];
  for (const std::uint8_t byte : bytes) {
    std::snprintf(digits, sizeof digits, "%02X", byte);
    text += digits;
  }
  return text;
}

// Device, configuration, interface and endpoint descriptors (USB 2.0, chapter 9).
std::vector<std::uint8_t> descriptors_of(const UsbProduct& product) {
  struct Pipe {
    std::uint8_t address, kind;
  };
  std::vector<Pipe> pipes = {{product.out, 2}, {product.in, 2}};
  if (product.interrupt) pipes.push_back({product.interrupt, 3});
  const auto total = static_cast<std::uint8_t>(9 + 9 + 7 * pipes.size());
  std::vector<std::uint8_t> bytes = {18,
                                     1,
                                     0x00,
                                     0x02,
                                     0xff,
                                     0,
                                     0,
                                     64,
                                     0x44,
                                     0x0f,
                                     static_cast<std::uint8_t>(product.id),
                                     static_cast<std::uint8_t>(product.id >> 8),
                                     0,
                                     1,
                                     0,
                                     0,
                                     0,
                                     1};
  bytes.insert(bytes.end(), {9, 2, total, 0, 1, 1, 0, 0x80, 50});
  bytes.insert(bytes.end(), {9, 4, 0, 0, static_cast<std::uint8_t>(pipes.size()), 0xff, 0, 0, 0});
  for (const Pipe& pipe : pipes) bytes.insert(bytes.end(), {7, 5, pipe.address, pipe.kind, 0x00, 0x02, 1});
  return bytes;
}

usbdevfs_urb* urb_of(UMockdevIoctlData* data) { return reinterpret_cast<usbdevfs_urb*>(data->data); }

bool is_in(const usbdevfs_urb& urb) { return (urb.endpoint & 0x80) != 0; }

}  // namespace

PolhemusUsbEmulation::PolhemusUsbEmulation(PolhemusModel model, const UsbProduct& product)
    : instrument(model), product_(product), testbed_(umockdev_testbed_new()) {
  if (!umockdev_in_mock_environment()) throw std::runtime_error("libumockdev-preload.so.0 is not loaded");
}

PolhemusUsbEmulation::~PolhemusUsbEmulation() {
  unplug();
  for (const std::string& node : nodes_) umockdev_testbed_detach_ioctl(testbed_, node.c_str(), nullptr);
  g_object_unref(testbed_);
}

void PolhemusUsbEmulation::plug_in() {
  ++number_;
  char device[2000];
  nodes_.push_back("/dev/bus/usb/001/00" + std::to_string(number_));
  syspath_ = "/sys/devices/usb1/1-" + std::to_string(number_);
  const std::string descriptors = hex(descriptors_of(product_));
  std::snprintf(device, sizeof device,
                "P: /devices/usb1/1-%d\nN: bus/usb/001/00%d=%s\nE: BUSNUM=001\nE: DEVNUM=00%d\n"
                "E: DEVNAME=/dev/bus/usb/001/00%d\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\n"
                "A: bConfigurationValue=1\\n\nA: bNumConfigurations=1\\n\nA: busnum=1\\n\nA: devnum=%d\\n\n"
                "A: idVendor=0f44\\n\nA: idProduct=%04x\\n\nA: speed=480\\n\nH: descriptors=%s\n\n",
                number_, number_, descriptors.c_str(), number_, number_, number_, product_.id, descriptors.c_str());
  GError* fault = nullptr;
  if (!umockdev_testbed_add_from_string(testbed_, device, &fault)) throw std::runtime_error(fault->message);
  UMockdevIoctlBase* handler = umockdev_ioctl_base_new();
  g_signal_connect(handler, "handle-ioctl", G_CALLBACK(on_request), this);
  const bool attached = umockdev_testbed_attach_ioctl(testbed_, nodes_.back().c_str(), handler, &fault);
  g_object_unref(handler);
  if (!attached) throw std::runtime_error(fault->message);
  const std::lock_guard lock(mutex_);
  gone_ = false;
}

void PolhemusUsbEmulation::unplug() {
  {
    const std::lock_guard lock(mutex_);
    if (gone_) return;
    gone_ = true;  // every request is answered so from now on
  }
  umockdev_testbed_uevent(testbed_, syspath_.c_str(), "remove");
  // Without its device umockdev leaves a request under way without an answer, for ever; a kernel does not. A driver
  // that has the device open asks all the time: once it does not, it has closed it.
  constexpr auto kQuiet = std::chrono::milliseconds(150);
  std::unique_lock lock(mutex_);
  while (std::chrono::steady_clock::now() - asked_ < kQuiet) {
    lock.unlock();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    lock.lock();
  }
  lock.unlock();
  umockdev_testbed_remove_device(testbed_, syspath_.c_str());
  lock.lock();
  forget(waiting_);
  forget(done_);
  queued_.clear();
}

std::vector<PolhemusReading> PolhemusUsbEmulation::sent() {
  const std::lock_guard lock(mutex_);
  return instrument.sent;
}

void PolhemusUsbEmulation::switch_off_and_on() {
  const std::lock_guard lock(mutex_);
  instrument.power_on();
}

std::vector<unsigned long> PolhemusUsbEmulation::unknown_requests() {
  const std::lock_guard lock(mutex_);
  return unknown_;
}

gboolean PolhemusUsbEmulation::on_request(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  return static_cast<PolhemusUsbEmulation*>(self)->handle(client);
}

bool PolhemusUsbEmulation::handle(UMockdevIoctlClient* client) {
  const std::lock_guard lock(mutex_);
  asked_ = std::chrono::steady_clock::now();
  const unsigned long request = umockdev_ioctl_client_get_request(client);
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  const bool reaps = request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY;
  if (gone_ && reaps) {
    reap_of_gone(client);
  } else if (gone_) {
    umockdev_ioctl_client_complete(client, -1, ENODEV);
  } else if (request == USBDEVFS_SUBMITURB) {
    submit(client);
  } else if (reaps) {
    reap(client);
  } else if (request == USBDEVFS_DISCARDURB) {
    discard(client);
  } else if (request == USBDEVFS_GET_CAPABILITIES) {
    UMockdevIoctlData* capabilities = umockdev_ioctl_data_resolve(argument, 0, sizeof(std::uint32_t), nullptr);
    *reinterpret_cast<std::uint32_t*>(capabilities->data) = USBDEVFS_CAP_BULK_CONTINUATION;
    umockdev_ioctl_client_complete(client, 0, 0);
    g_object_unref(capabilities);
  } else if (request == USBDEVFS_CLAIMINTERFACE || request == USBDEVFS_RELEASEINTERFACE) {
    umockdev_ioctl_client_complete(client, 0, 0);
  } else if (request == USBDEVFS_GETDRIVER || request == USBDEVFS_IOCTL || request == USBDEVFS_DISCONNECT_CLAIM) {
    // No kernel driver is bound to it.
    umockdev_ioctl_client_complete(client, request == USBDEVFS_DISCONNECT_CLAIM ? 0 : -1, ENODATA);
  } else {
    unknown_.push_back(request);
    umockdev_ioctl_client_complete(client, -1, ENOTTY);
  }
  return true;
}

void PolhemusUsbEmulation::submit(UMockdevIoctlClient* client) {
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr);
  usbdevfs_urb* urb = urb_of(data);
  const auto size = static_cast<std::size_t>(urb->buffer_length);
  UMockdevIoctlData* buffer = umockdev_ioctl_data_resolve(data, offsetof(usbdevfs_urb, buffer), size, nullptr);
  if (is_in(*urb)) {
    waiting_.push_back({data, buffer});
  } else {
    queued_[product_.in] += instrument.hear({reinterpret_cast<const char*>(buffer->data), size});
    urb->status = 0;
    urb->actual_length = urb->buffer_length;
    done_.push_back({data, buffer});
  }
  umockdev_ioctl_client_complete(client, 0, 0);
}

void PolhemusUsbEmulation::measure() {
  const auto now = std::chrono::steady_clock::now();
  if (now - measured_ < kMeasureEvery) return;
  measured_ = now;
  queued_[product_.interrupt ? product_.interrupt : product_.in] += instrument.measure();
}

void PolhemusUsbEmulation::reap(UMockdevIoctlClient* client) {
  measure();
  for (auto each = waiting_.begin(); done_.empty() && each != waiting_.end(); ++each) {
    usbdevfs_urb* urb = urb_of(each->data);
    std::string& queued = queued_[urb->endpoint];
    if (queued.empty()) continue;
    const std::size_t count = std::min({queued.size(), packet, static_cast<std::size_t>(urb->buffer_length)});
    std::memcpy(each->buffer->data, queued.data(), count);
    queued.erase(0, count);
    urb->status = 0;
    urb->actual_length = static_cast<int>(count);
    done_.splice(done_.end(), waiting_, each);
    break;
  }
  hand_over(client, EAGAIN);
}

// As a kernel does: what is under way ends with the device, and who waits for it is told so.
void PolhemusUsbEmulation::reap_of_gone(UMockdevIoctlClient* client) {
  for (const Urb& each : waiting_) {
    urb_of(each.data)->status = -ENODEV;
    urb_of(each.data)->actual_length = 0;
  }
  done_.splice(done_.end(), waiting_);
  hand_over(client, ENODEV);
}

void PolhemusUsbEmulation::hand_over(UMockdevIoctlClient* client, int error_of_none) {
  if (done_.empty()) {
    umockdev_ioctl_client_complete(client, -1, error_of_none);
    return;
  }
  const Urb urb = done_.front();
  done_.pop_front();
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  UMockdevIoctlData* place = umockdev_ioctl_data_resolve(argument, 0, sizeof(void*), nullptr);
  umockdev_ioctl_data_set_ptr(place, 0, urb.data);
  umockdev_ioctl_client_complete(client, 0, 0);
  g_object_unref(place);
  g_object_unref(urb.buffer);
  g_object_unref(urb.data);
}

void PolhemusUsbEmulation::discard(UMockdevIoctlClient* client) {
  unsigned long address = 0;
  std::memcpy(&address, umockdev_ioctl_client_get_arg(client)->data, sizeof address);
  const auto urb =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const Urb& u) { return u.data->client_addr == address; });
  if (urb == waiting_.end()) {
    umockdev_ioctl_client_complete(client, -1, EINVAL);
    return;
  }
  urb_of(urb->data)->status = -ENOENT;
  urb_of(urb->data)->actual_length = 0;
  done_.splice(done_.end(), waiting_, urb);
  umockdev_ioctl_client_complete(client, 0, 0);
}

void PolhemusUsbEmulation::forget(std::list<Urb>& urbs) {
  for (const Urb& urb : urbs) {
    g_object_unref(urb.buffer);
    g_object_unref(urb.data);
  }
  urbs.clear();
}

}  // namespace fathom
