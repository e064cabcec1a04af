#include <mutex>
#include <string>

#include <opencv2/core.hpp>

#include "acquisition/pixel_source.h"

namespace fathom {

namespace {

class CompressedPixels : public PixelSource {
 public:
  CompressedPixels(const SequenceFile& sequence, const InflateOptions& options)
      : pixels_(sequence.pixels),
        size_(sequence.header.width, sequence.header.height),
        type_(sequence.header.pixel_type),
        frame_bytes_(frame_bytes(sequence.header)),
        stream_(*pixels_.file, pixels_.offset, pixels_.compressed_bytes.value(),
                frame_bytes_ * static_cast<std::uint64_t>(sequence.header.frame_count()), options) {}

  cv::Mat frame(int frame) const override {
    const std::lock_guard lock(mutex_);
    if (frame == last_frame_) return last_image_;
    // Let go before the next one is made: frames may be as large as 256 MB.
    last_frame_ = -1;
    last_image_.release();
    cv::Mat image(size_, type_);
    const auto bytes = std::as_writable_bytes(std::span(image.data, static_cast<std::size_t>(frame_bytes_)));
    const auto fault = stream_.read(frame_bytes_ * static_cast<std::uint64_t>(frame), bytes);
    if (fault != InflateStream::Fault::none) fail(fault, frame);
    convert_stored_frame(image, pixels_);
    last_frame_ = frame;
    last_image_ = image;
    return image;
  }

 private:
  [[noreturn]] void fail(InflateStream::Fault fault, int frame) const {
    if (fault == InflateStream::Fault::too_long) {
      pixels_.file->fail("its compressed pixels are more than its header says; the header is damaged");
    }
    const std::uint64_t good_frames = stream_.good_bytes() / frame_bytes_;
    const bool at_the_end = fault == InflateStream::Fault::damaged && good_frames > static_cast<std::uint64_t>(frame);
    if (at_the_end) {
      pixels_.file->fail("the checksum of its pixels is wrong (found when reading the last frame, " +
                         std::to_string(frame) + "); some pixels are damaged; copy it again");
    }
    const std::string where = good_frames > 0 ? "damaged after frame " + std::to_string(good_frames - 1)
                                              : std::string("damaged from frame 0 on");
    pixels_.file->fail((fault == InflateStream::Fault::ends_early ? "its compressed pixels end early; they are "
                                                                  : "its compressed pixels are ") +
                       where + "; copy it again");
  }

  PixelStorage pixels_;
  cv::Size size_;
  int type_;
  std::uint64_t frame_bytes_;
  mutable std::mutex mutex_;
  mutable InflateStream stream_;
  mutable int last_frame_ = -1;
  mutable cv::Mat last_image_;
};

}  // namespace

std::unique_ptr<PixelSource> open_compressed_pixels(const SequenceFile& sequence, const InflateOptions& options) {
  return std::make_unique<CompressedPixels>(sequence, options);
}

}  // namespace fathom
