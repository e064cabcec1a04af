#include "acquisition/live/tcp_socket.h"

#include <cerrno>
#include <cmath>
#include <memory>
#include <system_error>
#include <utility>

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "acquisition/live/live_source.h"
#include "core/error.h"
#include "core/printable.h"

namespace fathom {

namespace {

// Room for some frames while this program is kept from reading.
constexpr int kReceiveBuffer_bytes = 4 << 20;

// A plug that is pulled is noticed after kIdle_s + kProbes * kProbe_s.
constexpr int kIdle_s = 3;
constexpr int kProbe_s = 1;
constexpr int kProbes = 3;

// How often waiting looks whether it shall stop.
constexpr double kSlice_s = 0.05;

std::string reason(int error) { return std::generic_category().message(error); }

bool would_block(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

bool wait(int descriptor, short events, double longest_s) {
  pollfd entry{descriptor, events, 0};
  return ::poll(&entry, 1, static_cast<int>(std::ceil(longest_s * 1000.0))) > 0;
}

void set(int descriptor, int level, int option, int value) {
  ::setsockopt(descriptor, level, option, &value, sizeof value);
}

void set_up_connection(int descriptor) {
  set(descriptor, IPPROTO_TCP, TCP_NODELAY, 1);
  set(descriptor, SOL_SOCKET, SO_KEEPALIVE, 1);
  set(descriptor, IPPROTO_TCP, TCP_KEEPIDLE, kIdle_s);
  set(descriptor, IPPROTO_TCP, TCP_KEEPINTVL, kProbe_s);
  set(descriptor, IPPROTO_TCP, TCP_KEEPCNT, kProbes);
}

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

Addresses find_addresses(const std::string& host, int port, int flags) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (error != 0)
    throw Error("there is no host '" + printable(host) + "' (" + ::gai_strerror(error) + "); check its name");
  return {found, &::freeaddrinfo};
}

TcpSocket open_socket(const addrinfo& address) {
  return TcpSocket(::socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

// 0, or why there is no connection.
int connect_to(const TcpSocket& socket, const addrinfo& address, const std::stop_token& stop, double until_s) {
  if (!socket.is_open()) return errno;
  // Before connecting: the size of the window is agreed upon then.
  set(socket.descriptor(), SOL_SOCKET, SO_RCVBUF, kReceiveBuffer_bytes);
  if (::connect(socket.descriptor(), address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  while (!wait(socket.descriptor(), POLLOUT, kSlice_s)) {
    if (stop.stop_requested()) return ECANCELED;
    if (live_clock_s() >= until_s) return ETIMEDOUT;
  }
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(socket.descriptor(), SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

}  // namespace

TcpSocket::TcpSocket(TcpSocket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

TcpSocket& TcpSocket::operator=(TcpSocket&& other) noexcept {
  if (this != &other) {
    close();
    descriptor_ = std::exchange(other.descriptor_, -1);
  }
  return *this;
}

void TcpSocket::close() {
  if (is_open()) ::close(std::exchange(descriptor_, -1));
}

bool TcpSocket::wait_for_input(double longest_s) const { return wait(descriptor_, POLLIN, longest_s); }

std::optional<std::size_t> TcpSocket::receive(std::span<std::byte> out, double longest_s) {
  // Under load bytes are mostly there already.
  for (const bool may_wait : {true, false}) {
    const ssize_t count = ::recv(descriptor_, out.data(), out.size(), 0);
    if (count >= 0) return static_cast<std::size_t>(count);
    if (!would_block(errno)) throw Error("the connection failed: " + reason(errno));
    if (!may_wait || !wait_for_input(longest_s)) break;
  }
  return std::nullopt;
}

std::size_t TcpSocket::send(std::span<const std::byte> bytes, double longest_s) {
  for (const bool may_wait : {true, false}) {
    const ssize_t count = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count >= 0) return static_cast<std::size_t>(count);
    if (!would_block(errno)) throw Error("the connection failed: " + reason(errno));
    if (!may_wait || !wait(descriptor_, POLLOUT, longest_s)) break;
  }
  return 0;
}

std::optional<TcpSocket> TcpSocket::accept(double longest_s) {
  if (!wait_for_input(longest_s)) return std::nullopt;
  TcpSocket connection(::accept4(descriptor_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!connection.is_open()) return std::nullopt;
  set_up_connection(connection.descriptor());
  return connection;
}

int TcpSocket::local_port() const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  ::getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address), &size);
  return address.ss_family == AF_INET6 ? ntohs(reinterpret_cast<sockaddr_in6&>(address).sin6_port)
                                       : ntohs(reinterpret_cast<sockaddr_in&>(address).sin_port);
}

TcpSocket connect_tcp(const std::string& host, int port, const std::stop_token& stop, double longest_s) {
  const double until_s = live_clock_s() + longest_s;
  const Addresses addresses = find_addresses(host, port, 0);
  int error = ETIMEDOUT;
  for (const addrinfo* address = addresses.get(); address != nullptr; address = address->ai_next) {
    TcpSocket socket = open_socket(*address);
    error = connect_to(socket, *address, stop, until_s);
    if (error != 0) continue;
    set_up_connection(socket.descriptor());
    return socket;
  }
  throw Error("no connection: " + reason(error));
}

TcpSocket listen_tcp(const std::string& address, int port) {
  constexpr int kWaiting = 16;  // connections that nobody has taken yet
  const Addresses addresses = find_addresses(address, port, AI_PASSIVE);
  TcpSocket socket = open_socket(*addresses);
  if (socket.is_open()) {
    set(socket.descriptor(), SOL_SOCKET, SO_REUSEADDR, 1);
    if (::bind(socket.descriptor(), addresses->ai_addr, addresses->ai_addrlen) == 0 &&
        ::listen(socket.descriptor(), kWaiting) == 0) {
      return socket;
    }
  }
  throw Error("port " + std::to_string(port) + " of " + printable(address) + " cannot be used: " + reason(errno) +
              "; choose another");
}

}  // namespace fathom
