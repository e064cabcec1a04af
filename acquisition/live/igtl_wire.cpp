#include "acquisition/live/igtl_wire.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>

#include <igtl_header.h>
#include <igtl_image.h>
#include <igtl_transform.h>

#include "core/error.h"
#include "core/printable.h"

namespace fathom {

namespace {

static_assert(sizeof(igtl_header) == kIgtlHeader_bytes && sizeof(igtl_image_header) == kIgtlImageHeader_bytes);

constexpr double kFraction = 4294967296.0;  // stamps are seconds and 2^-32 seconds

// What of OpenIGTLink's pixels a recording can hold.
struct PixelKind {
  int scalar_type;
  int components;
  int pixel_type;
};
constexpr PixelKind kPixelKinds[] = {
    {IGTL_IMAGE_STYPE_TYPE_UINT8, 1, CV_8UC1},    {IGTL_IMAGE_STYPE_TYPE_INT8, 1, CV_8SC1},
    {IGTL_IMAGE_STYPE_TYPE_UINT16, 1, CV_16UC1},  {IGTL_IMAGE_STYPE_TYPE_INT16, 1, CV_16SC1},
    {IGTL_IMAGE_STYPE_TYPE_FLOAT32, 1, CV_32FC1}, {IGTL_IMAGE_STYPE_TYPE_FLOAT64, 1, CV_64FC1},
    {IGTL_IMAGE_STYPE_TYPE_UINT8, 3, CV_8UC3},
};

constexpr int kNativeEndian =
    std::endian::native == std::endian::little ? IGTL_IMAGE_ENDIAN_LITTLE : IGTL_IMAGE_ENDIAN_BIG;

// Text of fixed length, which ends at a zero if there is one.
template <std::size_t N>
std::string text_of(const char (&bytes)[N]) {
  return {bytes, std::find(bytes, bytes + N, '\0')};
}

template <std::size_t N>
void put_text(char (&bytes)[N], std::string_view text) {
  std::memset(bytes, 0, N);
  std::memcpy(bytes, text.data(), std::min(N, text.size()));
}

template <typename T>
T from_bytes(std::span<const std::byte> bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

std::uint64_t stamp_of(const std::optional<double>& time_s) {
  if (!time_s || !(*time_s >= 0.0 && *time_s < kFraction)) return 0;
  const double whole = std::floor(*time_s);
  return (static_cast<std::uint64_t>(whole) << 32) + static_cast<std::uint64_t>((*time_s - whole) * kFraction);
}

bool is_type(const std::string& type) {
  return !type.empty() && std::all_of(type.begin(), type.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || c == '_';
  });
}

// Room for a message, with its header filled in but for the checksum.
std::vector<std::byte> begin_message(const char* type, const std::string& device, const std::optional<double>& time_s,
                                     std::size_t body_bytes) {
  igtl_header header{};
  header.version = 1;
  put_text(header.name, type);
  put_text(header.device_name, device);
  header.timestamp = stamp_of(time_s);
  header.body_size = body_bytes;
  std::vector<std::byte> message(sizeof header + body_bytes);
  std::memcpy(message.data(), &header, sizeof header);
  return message;
}

// Once the body stands.
void end_message(std::vector<std::byte>& message) {
  auto header = from_bytes<igtl_header>(message);
  header.crc = igtl_checksum(std::span(message).subspan(sizeof header));
  igtl_header_convert_byte_order(&header);
  std::memcpy(message.data(), &header, sizeof header);
}

const PixelKind* find_kind(const igtl_image_header& header) {
  const auto* kind = std::find_if(std::begin(kPixelKinds), std::end(kPixelKinds), [&](const PixelKind& each) {
    return each.scalar_type == header.scalar_type && each.components == header.num_components;
  });
  return kind == std::end(kPixelKinds) ? nullptr : kind;
}

}  // namespace

IgtlHeader read_igtl_header(std::span<const std::byte, kIgtlHeader_bytes> bytes) {
  auto raw = from_bytes<igtl_header>(bytes);
  igtl_header_convert_byte_order(&raw);
  IgtlHeader header;
  header.version = raw.version;
  header.type = text_of(raw.name);
  header.device = text_of(raw.device_name);
  if (raw.timestamp != 0) header.time_s = static_cast<double>(raw.timestamp) / kFraction;
  header.body_bytes = raw.body_size;
  header.checksum = raw.crc;
  if ((header.version != 1 && header.version != 2) || !is_type(header.type)) {
    throw Error("what it sends is not OpenIGTLink (versions 1 to 3); check host and port");
  }
  return header;
}

IgtlImageHeader read_igtl_image_header(std::span<const std::byte, kIgtlImageHeader_bytes> bytes) {
  auto raw = from_bytes<igtl_image_header>(bytes);
  igtl_image_convert_byte_order(&raw);
  const PixelKind* kind = find_kind(raw);
  if (kind == nullptr) throw Error("its pixels are of a type that cannot be recorded");
  const bool whole = std::equal(raw.size, raw.size + 3, raw.subvol_size) &&
                     std::all_of(raw.subvol_offset, raw.subvol_offset + 3, [](auto offset) { return offset == 0; });
  if (!whole) throw Error("only a part of the image was sent");
  if (raw.size[0] == 0 || raw.size[1] == 0 || raw.size[2] != 1) throw Error("it is not one two-dimensional image");
  if (raw.endian != IGTL_IMAGE_ENDIAN_BIG && raw.endian != IGTL_IMAGE_ENDIAN_LITTLE) {
    throw Error("it does not state the order of its bytes");
  }
  IgtlImageHeader header;
  header.width = raw.size[0];
  header.height = raw.size[1];
  header.pixel_type = kind->pixel_type;
  header.big_endian = raw.endian == IGTL_IMAGE_ENDIAN_BIG;
  for (int i = 0; i < 12; ++i) header.matrix(i % 3, i / 3) = static_cast<double>(raw.matrix[i]);
  // From left-posterior-superior.
  if (raw.coord == IGTL_IMAGE_COORD_LPS) header.matrix.topRows<2>() *= -1.0;
  return header;
}

Eigen::Matrix4d read_igtl_matrix(std::span<const std::byte, 48> bytes) {
  std::array<float, 12> numbers;
  std::memcpy(numbers.data(), bytes.data(), sizeof numbers);
  igtl_transform_convert_byte_order(numbers.data());
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 12; ++i) matrix(i % 3, i / 3) = static_cast<double>(numbers[static_cast<std::size_t>(i)]);
  return matrix;
}

std::vector<std::byte> igtl_image_message(const std::string& device, const std::optional<double>& time_s,
                                          const cv::Mat& image) {
  igtl_image_header header{};
  const auto* kind = std::find_if(std::begin(kPixelKinds), std::end(kPixelKinds),
                                  [&](const PixelKind& each) { return each.pixel_type == image.type(); });
  constexpr int kLargest = 65535;
  if (kind == std::end(kPixelKinds) || image.cols > kLargest || image.rows > kLargest) {
    throw Error("images of this type or size cannot be sent by OpenIGTLink; choose another source");
  }
  header.version = IGTL_IMAGE_HEADER_VERSION;
  header.num_components = static_cast<igtl_uint8>(kind->components);
  header.scalar_type = static_cast<igtl_uint8>(kind->scalar_type);
  header.endian = kNativeEndian;
  header.coord = IGTL_IMAGE_COORD_RAS;
  const igtl_uint16 size[3] = {static_cast<igtl_uint16>(image.cols), static_cast<igtl_uint16>(image.rows), 1};
  for (int i = 0; i < 3; ++i) {
    header.size[i] = header.subvol_size[i] = size[i];
    header.matrix[4 * i] = 1.0f;  // a step along each axis is 1, as no pixel size is known
  }
  igtl_image_convert_byte_order(&header);
  const std::size_t row_bytes = image.elemSize() * static_cast<std::size_t>(image.cols);
  auto message =
      begin_message("IMAGE", device, time_s, sizeof header + row_bytes * static_cast<std::size_t>(image.rows));
  std::byte* out = message.data() + kIgtlHeader_bytes;
  std::memcpy(out, &header, sizeof header);
  out += sizeof header;
  for (int y = 0; y < image.rows; ++y, out += row_bytes) std::memcpy(out, image.ptr(y), row_bytes);
  end_message(message);
  return message;
}

std::vector<std::byte> igtl_transform_message(const std::string& device, const std::optional<double>& time_s,
                                              const Eigen::Matrix4d& matrix) {
  std::array<float, 12> numbers;
  for (int i = 0; i < 12; ++i) numbers[static_cast<std::size_t>(i)] = static_cast<float>(matrix(i % 3, i / 3));
  igtl_transform_convert_byte_order(numbers.data());
  auto message = begin_message("TRANSFORM", device, time_s, sizeof numbers);
  std::memcpy(message.data() + kIgtlHeader_bytes, numbers.data(), sizeof numbers);
  end_message(message);
  return message;
}

std::vector<std::byte> igtl_status_message(const std::string& device, int code, const std::string& name,
                                           const std::string& text) {
  // Code (2 bytes), subcode (8), name (20), text that ends with a zero.
  auto message = begin_message("STATUS", device, std::nullopt, 30 + text.size() + 1);
  std::byte* body = message.data() + kIgtlHeader_bytes;
  body[0] = static_cast<std::byte>(code >> 8);
  body[1] = static_cast<std::byte>(code & 0xff);
  std::memcpy(body + 10, name.data(), std::min<std::size_t>(name.size(), 20));
  std::memcpy(body + 30, text.data(), text.size());
  end_message(message);
  return message;
}

}  // namespace fathom
