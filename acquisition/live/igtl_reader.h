#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "acquisition/live/igtl_body.h"
#include "acquisition/live/igtl_wire.h"
#include "core/error.h"

namespace fathom {

/// A stream of bytes that cannot be read on.
class StreamError : public Error {
 public:
  using Error::Error;
};

/// Bytes as they arrive.
class ByteStream {
 public:
  virtual ~ByteStream() = default;
  /// Fills `out`. Throws StreamError when the stream ends before, stays silent for too long, or is told to stop.
  virtual void read(std::span<std::byte> out) = 0;
};

/// A message of OpenIGTLink, understood.
struct IgtlMessage {
  IgtlHeader header;
  /// Why it could not be used: damaged, wrong or of a kind that cannot be recorded. Nothing but the header is given
  /// then; the next message can be read. Empty where all is well.
  std::string fault;
  cv::Mat image;                                            ///< of an IMAGE; RGB where coloured
  std::vector<std::pair<std::string, std::string>> fields;  ///< of an IMAGE: "ImageMatrix" where it is not trivial
  std::vector<IgtlPose> poses;                              ///< of all types that state poses
  std::string complaint;                                    ///< of a STATUS that is not well
};

/// Memory that a message may take; more is refused before any is taken.
inline constexpr std::uint64_t kLargestIgtlImage_bytes = std::uint64_t{128} << 20;
inline constexpr std::uint64_t kLargestIgtlText_bytes = std::uint64_t{1} << 20;  ///< poses, statuses, metadata
/// No message is longer; nobody would wait for its end.
inline constexpr std::uint64_t kLongestIgtlMessage_bytes = std::uint64_t{1} << 30;

/// Reads one message, to its end. An image is read into the matrix that is given out, and copied nowhere. Types that
/// are not used are skipped. Throws StreamError when nothing is known of what follows: the stream ends or is not
/// OpenIGTLink.
IgtlMessage read_igtl_message(ByteStream& stream);

}  // namespace fathom
