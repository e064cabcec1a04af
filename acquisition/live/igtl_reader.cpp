#include "acquisition/live/igtl_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <Eigen/LU>

#include "acquisition/pixel_source.h"
#include "acquisition/sequence_file.h"
#include "core/error.h"
#include "core/numbers.h"
#include "core/printable.h"

namespace fathom {

namespace {

// Checksums keep pace with the line when they are taken of pieces that are still in the processor's cache.
constexpr std::size_t kPiece_bytes = 64 << 10;

// The body of one message: counts what is left of it, and sums.
class BodyStream {
 public:
  BodyStream(ByteStream& stream, std::uint64_t bytes) : stream_(stream), left_(bytes) {}

  std::uint64_t left() const { return left_; }
  std::uint64_t checksum() const { return checksum_; }

  // Throws Error, without reading, when the body is shorter.
  void read(std::span<std::byte> out) {
    if (out.size() > left_) throw Error("its body is too short");
    while (!out.empty()) {
      const auto piece = out.first(std::min(out.size(), kPiece_bytes));
      stream_.read(piece);
      left_ -= piece.size();
      checksum_ = igtl_checksum(piece, checksum_);
      out = out.subspan(piece.size());
    }
  }

  std::vector<std::byte> read(std::uint64_t bytes) {
    if (bytes > kLargestIgtlText_bytes) throw Error("its body of " + std::to_string(bytes) + " bytes is too large");
    std::vector<std::byte> out(static_cast<std::size_t>(std::min(bytes, left_)));
    if (out.size() < bytes) throw Error("its body is too short");
    read(out);
    return out;
  }

  void skip_rest() {
    std::array<std::byte, 4096> ignored;
    while (left_ > 0)
      read(std::span(ignored).first(static_cast<std::size_t>(std::min<std::uint64_t>(left_, ignored.size()))));
  }

 private:
  ByteStream& stream_;
  std::uint64_t left_;
  std::uint64_t checksum_ = 0;
};

// How the body of a message of header version 2 is divided.
struct Division {
  std::uint64_t content_bytes = 0;
  std::uint64_t index_bytes = 0;  // of the metadata
  std::uint64_t metadata_bytes = 0;
};

Division read_division(const IgtlHeader& header, BodyStream& body) {
  if (header.version == 1) return {header.body_bytes, 0, 0};
  // Its own size (2 bytes), that of the metadata's index (2) and of the metadata (4), the message's number (4).
  constexpr std::size_t kLeast_bytes = 12;
  std::array<std::byte, kLeast_bytes> extended;
  body.read(extended);
  const auto number = [&](std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | std::to_integer<std::uint64_t>(extended[at + i]);
    return value;
  };
  const std::uint64_t extended_bytes = number(0, 2);
  Division division{0, number(2, 2), number(4, 4)};
  const std::uint64_t around = extended_bytes + division.index_bytes + division.metadata_bytes;
  if (extended_bytes < kLeast_bytes || around > header.body_bytes) throw Error("the sizes of its parts do not fit");
  division.content_bytes = header.body_bytes - around;
  body.read(extended_bytes - kLeast_bytes);
  return division;
}

// Where the image lies, unless that is said by the identity, or not at all: nobody has measured it then.
void add_matrix(const Eigen::Matrix<double, 3, 4>& matrix, IgtlMessage& message) {
  const Eigen::Matrix3d axes = matrix.leftCols<3>();
  if (!matrix.allFinite() || axes.isIdentity(0.0) || axes.determinant() == 0.0) return;
  std::string text;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) text += format_real(matrix(row, column)) + " ";
  }
  message.fields.emplace_back("ImageMatrix", text + "0 0 0 1");
}

void read_image(std::uint64_t content_bytes, BodyStream& body, IgtlMessage& message) {
  std::array<std::byte, kIgtlImageHeader_bytes> bytes;
  body.read(bytes);
  const IgtlImageHeader header = read_igtl_image_header(bytes);
  const std::string size = std::to_string(header.width) + " x " + std::to_string(header.height) + " pixels";
  if (header.pixel_bytes() + bytes.size() != content_bytes) {
    throw Error("its " + std::to_string(content_bytes) + " bytes are no image of " + size);
  }
  if (header.pixel_bytes() > kLargestIgtlImage_bytes) throw Error("an image of " + size + " is too large");
  cv::Mat image(header.height, header.width, header.pixel_type);
  body.read({reinterpret_cast<std::byte*>(image.data), static_cast<std::size_t>(header.pixel_bytes())});
  PixelStorage storage;
  storage.big_endian = header.big_endian;
  convert_stored_frame(image, storage);
  message.image = std::move(image);
  add_matrix(header.matrix, message);
}

void read_metadata(const Division& division, BodyStream& body, IgtlMetadata& metadata) {
  const auto index = body.read(division.index_bytes);
  metadata = read_igtl_metadata(index, body.read(division.metadata_bytes));
}

void read_body(BodyStream& body, IgtlMessage& message) {
  const std::string& type = message.header.type;
  const bool image = type == "IMAGE";
  const bool poses = has_igtl_poses(type);
  if (!image && !poses && type != "STATUS") return;
  const Division division = read_division(message.header, body);
  IgtlMetadata metadata;
  if (image) {
    read_image(division.content_bytes, body, message);
    read_metadata(division, body, metadata);
    return;
  }
  const auto content = body.read(division.content_bytes);
  read_metadata(division, body, metadata);
  if (poses) {
    message.poses = read_igtl_poses(message.header, content, metadata);
  } else {
    message.complaint = read_igtl_status(content);
  }
}

}  // namespace

IgtlMessage read_igtl_message(ByteStream& stream) {
  std::array<std::byte, kIgtlHeader_bytes> bytes;
  stream.read(bytes);
  IgtlMessage message;
  try {
    message.header = read_igtl_header(bytes);
  } catch (const Error& error) {
    throw StreamError(error.what());
  }
  const IgtlHeader& header = message.header;
  if (header.body_bytes > kLongestIgtlMessage_bytes) {
    throw StreamError("it announces a message of " + std::to_string(header.body_bytes) + " bytes; check host and port");
  }
  BodyStream body(stream, header.body_bytes);
  std::string fault;
  try {
    read_body(body, message);
  } catch (const StreamError&) {
    throw;
  } catch (const Error& error) {
    fault = error.what();
  }
  body.skip_rest();
  // A damaged message's other faults are no news.
  if (body.checksum() != header.checksum) fault = "its checksum is wrong";
  if (!fault.empty())
    message = {header, header.type + " of '" + printable(header.device) + "': " + fault, {}, {}, {}, {}};
  return message;
}

}  // namespace fathom
