#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/live/igtl_reader.h"

namespace fathom {

using Bytes = std::vector<std::byte>;

/// A stream that ends.
class MemoryStream : public ByteStream {
 public:
  explicit MemoryStream(const Bytes& bytes) : bytes_(bytes) {}
  void read(std::span<std::byte> out) override;
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  const Bytes& bytes_;
  std::size_t at_ = 0;
};

/// All messages of a stream. Throws StreamError.
std::vector<IgtlMessage> read_all(const Bytes& bytes);

/// A message of this type with this body, without a checksum.
Bytes igtl_message(const std::string& type, const Bytes& body);

/// Sets the checksum and the size of the body as they should be.
Bytes with_checksum(Bytes message);

/// The same as a message of header version 2 with metadata.
Bytes with_metadata(const Bytes& message, const std::vector<std::pair<std::string, std::string>>& metadata);

}  // namespace fathom
