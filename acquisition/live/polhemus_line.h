#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "acquisition/live/polhemus_record.h"

namespace fathom {

/// The line to a Polhemus instrument, open as long as this lives.
class PolhemusLine {
 public:
  virtual ~PolhemusLine() = default;

  /// Up to bytes.size() bytes as soon as there are some; 0 when none came within `longest_s`. Throws Error when the
  /// instrument is gone.
  virtual std::size_t read(std::span<std::uint8_t> bytes, double longest_s) = 0;
  /// All of `bytes`. Throws Error when the instrument is gone or takes none within a second.
  virtual void write(std::string_view bytes) = 0;
  /// Says that the instrument has been told to send records by itself, or to stop that.
  virtual void set_streaming(bool) {}

  /// How long a byte is under way; 0 where that does not count.
  virtual double byte_s() const { return 0.0; }
  /// The instrument, where the line tells.
  virtual std::optional<PolhemusModel> model() const { return std::nullopt; }
};

/// A serial line: 8 bits, no parity, 1 stop bit, no handshake, locked against other programs. Throws Error when
/// `device` is not there, is no terminal, is in use, or does not take the rate.
std::unique_ptr<PolhemusLine> open_polhemus_serial(const std::string& device, int baud);

/// The one Polhemus instrument on the USB. Throws Error when there is none or more than one, it has not got its
/// firmware yet, is of a kind that is not known, or may not be opened.
std::unique_ptr<PolhemusLine> open_polhemus_usb();

}  // namespace fathom
