#include <atomic>
#include <utility>

#include <opencv2/core.hpp>
#include <sys/mman.h>

#include "acquisition/pixel_source.h"

namespace fathom {

namespace {

// Below this a recording is read frame by frame: copying costs next to nothing, and a file that another program cuts
// short meanwhile gives an Error. In a mapped file the same would end the program (SIGBUS); that is the price of
// opening a recording of any length at once.
constexpr std::uint64_t kSmallRecordingBytes = 8 << 20;

// Pages of the file that were looked at count as this program's memory until it gives them back. They are given back
// after this much; a view in use finds them again in the system's cache.
constexpr std::uint64_t kMostResidentBytes = 256 << 20;

/// A part of a file as memory.
class Mapping {
 public:
  Mapping(const InputFile& file, std::uint64_t offset, std::uint64_t bytes) {
    // Mapped from the file's beginning, as offsets must be multiples of the page size; pages that are not touched cost
    // nothing.
    length_ = static_cast<std::size_t>(offset + bytes);
    void* const address = ::mmap(nullptr, length_, PROT_READ, MAP_PRIVATE, file.descriptor(), 0);
    if (address == MAP_FAILED) {
      length_ = 0;  // a limit on address space, say; frames are then read into memory
      return;
    }
    begin_ = static_cast<uchar*>(address);
    pixels_ = begin_ + offset;
  }
  ~Mapping() {
    if (begin_ != nullptr) ::munmap(begin_, length_);
  }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;

  uchar* pixels() const { return pixels_; }
  void give_back_pages() const { ::madvise(begin_, length_, MADV_DONTNEED); }

 private:
  std::size_t length_ = 0;
  uchar* begin_ = nullptr;
  uchar* pixels_ = nullptr;
};

class RawPixels : public PixelSource {
 public:
  explicit RawPixels(const SequenceFile& sequence)
      : pixels_(sequence.pixels),
        size_(sequence.header.width, sequence.header.height),
        type_(sequence.header.pixel_type),
        frame_bytes_(frame_bytes(sequence.header)) {
    const std::uint64_t all = frame_bytes_ * static_cast<std::uint64_t>(sequence.header.frame_count());
    const bool aligned = pixels_.offset % CV_ELEM_SIZE1(type_) == 0;
    if (all > kSmallRecordingBytes && aligned && is_stored_as_needed(pixels_, type_)) {
      mapping_ = std::make_unique<Mapping>(*pixels_.file, pixels_.offset, all);
    }
  }

  cv::Mat frame(int frame) const override {
    const std::uint64_t position = frame_bytes_ * static_cast<std::uint64_t>(frame);
    if (mapping_ && mapping_->pixels() != nullptr) {
      if (handed_out_bytes_.fetch_add(frame_bytes_) + frame_bytes_ > kMostResidentBytes) {
        handed_out_bytes_ = 0;
        mapping_->give_back_pages();
      }
      return cv::Mat(size_, type_, mapping_->pixels() + position);
    }
    cv::Mat image(size_, type_);
    const auto bytes = std::as_writable_bytes(std::span(image.data, static_cast<std::size_t>(frame_bytes_)));
    if (pixels_.file->read_some(pixels_.offset + position, bytes) != bytes.size()) {
      pixels_.file->fail("was cut short while it was read, before the end of frame " + std::to_string(frame) +
                         "; open it again");
    }
    convert_stored_frame(image, pixels_);
    return image;
  }

 private:
  PixelStorage pixels_;
  cv::Size size_;
  int type_;
  std::uint64_t frame_bytes_;
  std::unique_ptr<Mapping> mapping_;
  mutable std::atomic<std::uint64_t> handed_out_bytes_ = 0;
};

}  // namespace

std::unique_ptr<PixelSource> open_raw_pixels(const SequenceFile& sequence) {
  return std::make_unique<RawPixels>(sequence);
}

}  // namespace fathom
