#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace fathom {

// Messages of OpenIGTLink as they stand on the line: a header of kIgtlHeader_bytes, then a body. Headers of version 1,
// and of version 2 (protocol version 3), whose bodies have an extended header before the content and metadata after it.

inline constexpr std::size_t kIgtlHeader_bytes = 58;
inline constexpr std::size_t kIgtlImageHeader_bytes = 72;

/// The port that OpenIGTLink has at the registry of ports.
inline constexpr int kIgtlPort = 18944;

struct IgtlHeader {
  int version = 1;
  std::string type;              ///< "IMAGE"
  std::string device;            ///< "ProbeToTracker"
  std::optional<double> time_s;  ///< on the sender's clock; empty where it states none
  std::uint64_t body_bytes = 0;
  std::uint64_t checksum = 0;  ///< of the body
};

/// Throws Error when it is no header, so that nothing is known of what follows it either.
IgtlHeader read_igtl_header(std::span<const std::byte, kIgtlHeader_bytes> bytes);

/// How the pixels in the body of an IMAGE are stored.
struct IgtlImageHeader {
  int width = 0;
  int height = 0;
  int pixel_type = 0;  ///< of RecordingHeader
  bool big_endian = false;
  /// Steps along x, y, z and the place of the image's centre, in millimetres, right-anterior-superior.
  Eigen::Matrix<double, 3, 4> matrix;
  std::uint64_t pixel_bytes() const {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) * CV_ELEM_SIZE(pixel_type);
  }
};

/// Throws Error, saying why, when it is not a whole two-dimensional image of pixels that a recording can hold.
IgtlImageHeader read_igtl_image_header(std::span<const std::byte, kIgtlImageHeader_bytes> bytes);

/// Continues the checksum of a body by the next bytes of it; it begins with 0.
std::uint64_t igtl_checksum(std::span<const std::byte> bytes, std::uint64_t so_far = 0);

/// The twelve float32 of a TRANSFORM or a TDATA element.
Eigen::Matrix4d read_igtl_matrix(std::span<const std::byte, 48> bytes);

// Messages to send, whole, with headers of version 1. Names are cut to 20 characters. Without a time stamp where
// `time_s` is empty or not from 0 to 2^32.

std::vector<std::byte> igtl_image_message(const std::string& device, const std::optional<double>& time_s,
                                          const cv::Mat& image);
/// The matrix is rounded to float32.
std::vector<std::byte> igtl_transform_message(const std::string& device, const std::optional<double>& time_s,
                                              const Eigen::Matrix4d& matrix);
/// `code`: 1 all is well, others see the protocol; `name` of the fault.
std::vector<std::byte> igtl_status_message(const std::string& device, int code, const std::string& name,
                                           const std::string& text);

}  // namespace fathom
