#pragma once

#include <memory>

#include <opencv2/core/mat.hpp>

#include "acquisition/inflate_stream.h"
#include "acquisition/sequence_file.h"

namespace fathom {

/// The pixels of a recording in a file, one frame at a time, brought to MF orientation and the machine's byte order.
class PixelSource {
 public:
  virtual ~PixelSource() = default;
  /// `frame` exists. May be called from several threads. Throws Error when the pixels are damaged.
  virtual cv::Mat frame(int frame) const = 0;
};

/// Uncompressed pixels. A large file is memory-mapped, and a frame that needs no conversion is a view of it; else the
/// frame is read into memory of its own.
std::unique_ptr<PixelSource> open_raw_pixels(const SequenceFile& sequence);

/// Compressed pixels. The last frame is kept, so that asking for it again costs nothing.
std::unique_ptr<PixelSource> open_compressed_pixels(const SequenceFile& sequence, const InflateOptions& options = {});

/// Either of them, as the file needs it.
std::unique_ptr<PixelSource> open_pixels(const SequenceFile& sequence, const InflateOptions& options = {});

/// Swaps the bytes of numbers where the stored order is not the machine's, and brings the image to MF, in place.
void convert_stored_frame(cv::Mat& image, const PixelStorage& pixels);

/// Whether stored pixels of this type can be used as they are.
bool is_stored_as_needed(const PixelStorage& pixels, int pixel_type);

}  // namespace fathom
