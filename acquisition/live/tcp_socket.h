#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

namespace fathom {

/// One end of a TCP connection, or a socket that waits for connections. Nothing here blocks longer than it is told.
class TcpSocket {
 public:
  TcpSocket() = default;
  explicit TcpSocket(int descriptor) : descriptor_(descriptor) {}
  TcpSocket(TcpSocket&& other) noexcept;
  TcpSocket& operator=(TcpSocket&& other) noexcept;
  ~TcpSocket() { close(); }

  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }
  void close();

  /// Whether bytes, a connection or an error have come within `longest_s`.
  bool wait_for_input(double longest_s) const;

  /// Takes what is there, up to out.size() bytes, after waiting at most `longest_s`: how many, 0 when the peer has
  /// ended the connection, nothing when nothing came. Throws Error when the connection has failed.
  std::optional<std::size_t> receive(std::span<std::byte> out, double longest_s);

  /// Hands over what the system takes now, after waiting at most `longest_s` until it takes any: how many bytes.
  /// Throws Error when the connection has failed or the peer has ended it.
  std::size_t send(std::span<const std::byte> bytes, double longest_s);

  /// The next connection, after waiting at most `longest_s` for it; one that fails at once is none.
  std::optional<TcpSocket> accept(double longest_s);

  /// The port at this end.
  int local_port() const;

 private:
  int descriptor_ = -1;
};

/// Connects within `longest_s`, to the first of the host's addresses that answers. Throws Error, without the host's
/// name, saying why it could not, also when asked to stop.
TcpSocket connect_tcp(const std::string& host, int port, const std::stop_token& stop, double longest_s);

/// Waits for connections to one of this computer's addresses ("127.0.0.1", "0.0.0.0" for all); port 0 is any that is
/// free. Throws Error.
TcpSocket listen_tcp(const std::string& address, int port);

}  // namespace fathom
