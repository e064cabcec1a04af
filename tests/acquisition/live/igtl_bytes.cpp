#include "tests/acquisition/live/igtl_bytes.h"

#include <algorithm>
#include <cstring>

namespace fathom {

namespace {

void put(Bytes& bytes, std::size_t at, std::size_t size, std::uint64_t value) {
  for (std::size_t i = 0; i < size; ++i) bytes[at + size - 1 - i] = static_cast<std::byte>(value >> (8 * i) & 0xff);
}

void append(Bytes& bytes, std::size_t size, std::uint64_t value) {
  bytes.resize(bytes.size() + size);
  put(bytes, bytes.size() - size, size, value);
}

void append(Bytes& bytes, const std::string& text) {
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
}

}  // namespace

void MemoryStream::read(std::span<std::byte> out) {
  if (out.size() > bytes_.size() - at_) throw StreamError("ended");
  if (!out.empty()) std::memcpy(out.data(), bytes_.data() + at_, out.size());
  at_ += out.size();
}

std::vector<IgtlMessage> read_all(const Bytes& bytes) {
  MemoryStream stream(bytes);
  std::vector<IgtlMessage> messages;
  while (!stream.at_end()) messages.push_back(read_igtl_message(stream));
  return messages;
}

Bytes igtl_message(const std::string& type, const Bytes& body) {
  Bytes message(kIgtlHeader_bytes);
  put(message, 0, 2, 1);
  std::memcpy(message.data() + 2, type.data(), std::min<std::size_t>(type.size(), 12));
  message.insert(message.end(), body.begin(), body.end());
  return message;
}

Bytes with_checksum(Bytes message) {
  put(message, 42, 8, message.size() - kIgtlHeader_bytes);
  put(message, 50, 8, igtl_checksum(std::span(message).subspan(kIgtlHeader_bytes)));
  return message;
}

Bytes with_metadata(const Bytes& message, const std::vector<std::pair<std::string, std::string>>& metadata) {
  Bytes index;
  Bytes texts;
  append(index, 2, metadata.size());
  for (const auto& [key, value] : metadata) {
    append(index, 2, key.size());
    append(index, 2, 3);  // ASCII
    append(index, 4, value.size());
    append(texts, key);
    append(texts, value);
  }
  Bytes whole(message.begin(), message.begin() + static_cast<std::ptrdiff_t>(kIgtlHeader_bytes));
  put(whole, 0, 2, 2);
  append(whole, 2, 12);
  append(whole, 2, index.size());
  append(whole, 4, texts.size());
  append(whole, 4, 1);
  whole.insert(whole.end(), message.begin() + static_cast<std::ptrdiff_t>(kIgtlHeader_bytes), message.end());
  whole.insert(whole.end(), index.begin(), index.end());
  whole.insert(whole.end(), texts.begin(), texts.end());
  return with_checksum(whole);
}

}  // namespace fathom
