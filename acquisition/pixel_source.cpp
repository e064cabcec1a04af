#include "acquisition/pixel_source.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include <opencv2/core.hpp>

namespace fathom {

namespace {

constexpr bool kHostIsBigEndian = std::endian::native == std::endian::big;

template <std::size_t kBytes>
void swap_bytes(uchar* numbers, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) std::reverse(numbers + i * kBytes, numbers + (i + 1) * kBytes);
}

}  // namespace

std::unique_ptr<PixelSource> open_pixels(const SequenceFile& sequence, const InflateOptions& options) {
  return sequence.pixels.compressed_bytes ? open_compressed_pixels(sequence, options) : open_raw_pixels(sequence);
}

bool is_stored_as_needed(const PixelStorage& pixels, int pixel_type) {
  return pixels.orientation.is_mf() && (CV_ELEM_SIZE1(pixel_type) == 1 || pixels.big_endian == kHostIsBigEndian);
}

void convert_stored_frame(cv::Mat& image, const PixelStorage& pixels) {
  if (pixels.big_endian != kHostIsBigEndian) {
    const std::size_t count = image.total() * static_cast<std::size_t>(image.channels());
    switch (image.elemSize1()) {
      case 2:
        swap_bytes<2>(image.data, count);
        break;
      case 4:
        swap_bytes<4>(image.data, count);
        break;
      case 8:
        swap_bytes<8>(image.data, count);
        break;
      default:
        break;
    }
  }
  flip_to_mf(image, pixels.orientation);
}

}  // namespace fathom
