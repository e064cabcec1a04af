#include <cerrno>
#include <chrono>
#include <cstring>
#include <iterator>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "acquisition/live/polhemus_line.h"
#include "core/error.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr double kWriteTimeout_s = 1.0;
constexpr int kBitsPerByte = 10;  // with start and stop bit

struct Rate {
  int baud;
  speed_t speed;
};
// Those that the instruments' switches and commands offer.
constexpr Rate kRates[] = {{2400, B2400},   {4800, B4800},   {9600, B9600},    {19200, B19200},
                           {38400, B38400}, {57600, B57600}, {115200, B115200}};

class SerialLine : public PolhemusLine {
 public:
  SerialLine(const std::string& device, int baud) : device_(printable(device)), baud_(baud) {
    fd_ = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd_ < 0) fail_opening();
    try {
      configure();
    } catch (...) {
      ::close(fd_);
      throw;
    }
  }
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;
  ~SerialLine() override { ::close(fd_); }

  std::size_t read(std::span<std::uint8_t> bytes, double longest_s) override {
    if (!wait_for(POLLIN, longest_s)) return 0;
    const ssize_t count = ::read(fd_, bytes.data(), bytes.size());
    if (count > 0) return static_cast<std::size_t>(count);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
    fail_gone();
  }

  void write(std::string_view bytes) override {
    while (!bytes.empty()) {
      if (!wait_for(POLLOUT, kWriteTimeout_s)) {
        throw Error(device_ + ": takes no commands; check the cable and that the instrument is switched on");
      }
      const ssize_t count = ::write(fd_, bytes.data(), bytes.size());
      if (count < 0 && errno != EAGAIN && errno != EINTR) fail_gone();
      if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  double byte_s() const override { return static_cast<double>(kBitsPerByte) / baud_; }

 private:
  [[noreturn]] void fail_opening() const {
    const bool forbidden = errno == EACCES || errno == EPERM;
    throw Error(device_ + ": cannot be opened: " + std::strerror(errno) +
                (forbidden ? "; add yourself to the group that owns it (dialout)"
                           : "; check that the adapter is plugged in and that no other program uses it"));
  }

  [[noreturn]] void fail_gone() const { throw Error(device_ + ": the line is gone; plug the adapter in again"); }

  void configure() {
    termios settings{};
    if (tcgetattr(fd_, &settings) != 0) {
      throw Error(device_ + ": is no serial line; give a terminal such as /dev/ttyUSB0");
    }
    if (ioctl(fd_, TIOCEXCL) != 0) throw Error(device_ + ": cannot be locked; end the program that uses it");
    const Rate* rate = std::begin(kRates);
    while (rate != std::end(kRates) && rate->baud != baud_) ++rate;
    if (rate == std::end(kRates)) {
      throw Error(device_ + ": " + std::to_string(baud_) + " is no rate of the instruments; give one of 2400, 4800, " +
                  "9600, 19200, 38400, 57600, 115200");
    }
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
    cfsetspeed(&settings, rate->speed);
    termios taken{};
    if (tcsetattr(fd_, TCSANOW, &settings) != 0 || tcgetattr(fd_, &taken) != 0 || cfgetospeed(&taken) != rate->speed) {
      throw Error(device_ + ": does not take " + std::to_string(baud_) + " baud; give another rate with ?baud=");
    }
    tcflush(fd_, TCIOFLUSH);
  }

  // Whether `event` came in time. Throws Error when the line is gone.
  bool wait_for(short event, double longest_s) const {
    pollfd state{fd_, event, 0};
    const int count = poll(&state, 1, static_cast<int>(longest_s * 1000.0));
    if (count <= 0) return false;
    // What came before the end is still to be read.
    if ((state.revents & event) == 0) fail_gone();
    return true;
  }

  std::string device_;
  int baud_;
  int fd_ = -1;
};

}  // namespace

std::unique_ptr<PolhemusLine> open_polhemus_serial(const std::string& device, int baud) {
  return std::make_unique<SerialLine>(device, baud);
}

}  // namespace fathom
