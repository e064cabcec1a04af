#include "acquisition/live/polhemus_usb.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <iterator>

#include <libusb.h>

#include "acquisition/live/polhemus_line.h"
#include "core/error.h"

namespace fathom {

namespace {

constexpr std::uint16_t kVendor = 0x0f44;
constexpr int kInterface = 0;
constexpr unsigned kWriteTimeout_ms = 1000;
// A whole number of the largest packets, so that the controller never has more to give than fits.
constexpr std::size_t kTransferBytes = 4096;

enum class Readiness { kReady, kNoFirmware, kUnknown };

// Instruments, and the numbers of their pipes: commands, answers, and the records that they send by themselves.
struct Product {
  std::uint16_t id;
  const char* name;
  Readiness readiness = Readiness::kUnknown;
  PolhemusModel model = PolhemusModel::kLiberty;
  std::uint8_t out = 0;
  std::uint8_t in = 0;
  std::uint8_t stream = 0;
};

constexpr Product kProducts[] = {
    {0x0002, "FASTRAK", Readiness::kReady, PolhemusModel::kFastrak, 0x02, 0x82, 0x84},
    {0x0003, "FASTRAK 3", Readiness::kReady, PolhemusModel::kFastrak, 0x02, 0x84, 0x84},
    {0xef12, "PATRIOT", Readiness::kReady, PolhemusModel::kPatriot, 0x02, 0x82, 0x82},
    {0xef20, "PATRIOT HS", Readiness::kReady, PolhemusModel::kPatriot, 0x04, 0x88, 0x88},
    {0xff12, "LIBERTY", Readiness::kReady, PolhemusModel::kLiberty, 0x02, 0x82, 0x82},
    {0xff20, "LIBERTY HS", Readiness::kReady, PolhemusModel::kLiberty, 0x04, 0x88, 0x88},
    {0x0001, "FASTRAK", Readiness::kNoFirmware},
    {0xef11, "PATRIOT", Readiness::kNoFirmware},
    {0xef21, "PATRIOT HS", Readiness::kNoFirmware},
    {0xff11, "LIBERTY", Readiness::kNoFirmware},
    {0xff21, "LIBERTY HS", Readiness::kNoFirmware},
    {0xcf01, "G4"},
    {0xbf01, "VIPER"},
};

constexpr Product kOther = {0, "unknown product"};

const char* fault_of(int code) { return libusb_strerror(code); }

// The library, and the devices that were on the bus when this was made.
class Bus {
 public:
  Bus() {
    if (libusb_init(&context_) != 0) return;
    count_ = libusb_get_device_list(context_, &devices_);
  }
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  ~Bus() {
    if (count_ >= 0) libusb_free_device_list(devices_, 1);
    if (context_) libusb_exit(context_);
  }

  bool usable() const { return count_ >= 0; }

  struct Found {
    libusb_device* device;
    const Product* product;
  };
  std::vector<Found> instruments() const {
    std::vector<Found> found;
    for (ssize_t i = 0; i < count_; ++i) {
      libusb_device_descriptor descriptor{};
      if (libusb_get_device_descriptor(devices_[i], &descriptor) != 0 || descriptor.idVendor != kVendor) continue;
      const auto product = std::find_if(std::begin(kProducts), std::end(kProducts),
                                        [&](const Product& p) { return p.id == descriptor.idProduct; });
      found.push_back({devices_[i], product == std::end(kProducts) ? &kOther : product});
    }
    return found;
  }

 private:
  libusb_context* context_ = nullptr;
  libusb_device** devices_ = nullptr;
  ssize_t count_ = -1;
};

// A sentence that ends "..., the POLHEMUS thing", or empty where it can be used.
std::string why_not(const Product& product) {
  const std::string name = product.name;
  if (product.readiness == Readiness::kReady) return "";
  if (product.readiness == Readiness::kUnknown) return name + " is not supported; use a FASTRAK, PATRIOT or LIBERTY";
  return name + " has not got its firmware; load it with fxload, as its maker describes, or use its serial line";
}

class UsbLine : public PolhemusLine {
 public:
  UsbLine() {
    if (!bus_.usable()) throw Error("polhemus:usb: the USB cannot be used; use the instrument's serial line");
    const auto found = bus_.instruments();
    if (found.empty()) throw Error("polhemus:usb: no instrument is there; plug it in and switch it on");
    if (found.size() > 1) {
      throw Error("polhemus:usb: there are " + std::to_string(found.size()) + " instruments; leave one plugged in");
    }
    product_ = found[0].product;
    const std::string fault = why_not(*product_);
    if (!fault.empty()) throw Error("polhemus:usb: the " + fault);
    check_pipes(found[0].device);
    open(found[0].device);
  }
  UsbLine(const UsbLine&) = delete;
  UsbLine& operator=(const UsbLine&) = delete;
  ~UsbLine() override {
    if (claimed_) libusb_release_interface(handle_, kInterface);
    if (handle_) libusb_close(handle_);
  }

  std::size_t read(std::span<std::uint8_t> bytes, double longest_s) override {
    if (next_ == end_) fill(longest_s);
    const std::size_t count = std::min(bytes.size(), end_ - next_);
    std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(next_), count, bytes.begin());
    next_ += count;
    return count;
  }

  void write(std::string_view bytes) override {
    std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
    std::size_t sent = 0;
    while (sent < copy.size()) {
      int count = 0;
      const int code = transfer(product_->out, copy.data() + sent, copy.size() - sent, &count, kWriteTimeout_ms);
      sent += static_cast<std::size_t>(count);
      if (code != 0 && !(code == LIBUSB_ERROR_TIMEOUT && count > 0)) fail_gone(code);
    }
  }

  void set_streaming(bool streaming) override { in_ = streaming ? product_->stream : product_->in; }
  std::optional<PolhemusModel> model() const override { return product_->model; }

 private:
  [[noreturn]] void fail_gone(int code) const {
    throw Error("polhemus:usb: the " + std::string(product_->name) + " is gone (" + fault_of(code) +
                "); plug it in and switch it on again");
  }

  // Which pipes are interrupt pipes; all that the product should have must be there.
  void check_pipes(libusb_device* device) {
    libusb_config_descriptor* configuration = nullptr;
    if (libusb_get_active_config_descriptor(device, &configuration) != 0) fail_layout();
    std::vector<std::uint8_t> pipes;
    for (int i = 0; i < configuration->bNumInterfaces; ++i) {
      const libusb_interface& each = configuration->interface[i];
      if (each.num_altsetting == 0 || each.altsetting[0].bInterfaceNumber != kInterface) continue;
      for (int e = 0; e < each.altsetting[0].bNumEndpoints; ++e) {
        const libusb_endpoint_descriptor& pipe = each.altsetting[0].endpoint[e];
        pipes.push_back(pipe.bEndpointAddress);
        const int kind = pipe.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK;
        if (kind == LIBUSB_TRANSFER_TYPE_INTERRUPT) interrupts_.push_back(pipe.bEndpointAddress);
      }
    }
    libusb_free_config_descriptor(configuration);
    for (const std::uint8_t needed : {product_->out, product_->in, product_->stream}) {
      if (std::find(pipes.begin(), pipes.end(), needed) == pipes.end()) fail_layout();
    }
  }

  [[noreturn]] void fail_layout() const {
    throw Error("polhemus:usb: the " + std::string(product_->name) +
                " has not the pipes of its kind; use the instrument's serial line");
  }

  void open(libusb_device* device) {
    const std::string name = product_->name;
    const int code = libusb_open(device, &handle_);
    if (code == LIBUSB_ERROR_ACCESS) {
      throw Error("polhemus:usb: the " + name + " may not be opened; give yourself access with a udev rule for " +
                  "vendor 0f44 (docs/devices.md)");
    }
    if (code != 0) {
      handle_ = nullptr;
      fail_gone(code);
    }
    libusb_set_auto_detach_kernel_driver(handle_, 1);
    const int claim = libusb_claim_interface(handle_, kInterface);
    if (claim != 0) {
      libusb_close(handle_);
      handle_ = nullptr;
      if (claim == LIBUSB_ERROR_BUSY) throw Error("polhemus:usb: the " + name + " is in use; end the other program");
      fail_gone(claim);
    }
    claimed_ = true;
    set_streaming(false);
  }

  int transfer(std::uint8_t pipe, std::uint8_t* bytes, std::size_t size, int* count, unsigned timeout_ms) {
    const bool interrupt = std::find(interrupts_.begin(), interrupts_.end(), pipe) != interrupts_.end();
    const auto go = interrupt ? libusb_interrupt_transfer : libusb_bulk_transfer;
    return go(handle_, pipe, bytes, static_cast<int>(size), count, timeout_ms);
  }

  void fill(double longest_s) {
    int count = 0;
    const auto timeout_ms = static_cast<unsigned>(std::max(1.0, longest_s * 1000.0));  // 0 would be for ever
    const int code = transfer(in_, buffer_.data(), buffer_.size(), &count, timeout_ms);
    if (code != 0 && code != LIBUSB_ERROR_TIMEOUT) fail_gone(code);
    next_ = 0;
    end_ = static_cast<std::size_t>(count);
  }

  Bus bus_;
  const Product* product_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  bool claimed_ = false;
  std::vector<std::uint8_t> interrupts_;  // pipes of that kind
  std::uint8_t in_ = 0;
  std::array<std::uint8_t, kTransferBytes> buffer_{};
  std::size_t next_ = 0, end_ = 0;  // what is still to be handed on
};

}  // namespace

std::unique_ptr<PolhemusLine> open_polhemus_usb() { return std::make_unique<UsbLine>(); }

std::vector<std::string> find_polhemus_usb() {
  std::vector<std::string> found;
  for (const Bus::Found& each : Bus().instruments()) {
    const std::string fault = why_not(*each.product);
    found.push_back("Polhemus " + (fault.empty() ? each.product->name + std::string(" on the USB") : fault));
  }
  return found;
}

}  // namespace fathom
