#include "acquisition/live/sweep_writer.h"

#include <system_error>

#include <sys/stat.h>

#include "acquisition/live/folder_names.h"
#include "acquisition/live/recording_folder.h"
#include "core/error.h"

namespace fathom {

namespace {

constexpr std::uint64_t kMostFrames = 1'000'000;           // what a recording can have
constexpr std::uint64_t kMostHeaderMemory = 300ull << 20;  // readers stop at 400 MB
constexpr std::uint64_t kReserveStep = 1 << 20;
constexpr mode_t kAllForAll = 0777;  // before the umask, as for any new folder

// As a reader will hold it; numbers on the high side.
std::uint64_t memory_of(const TrackedFrame& frame) {
  std::uint64_t bytes = 400 + 250 * frame.poses.size();
  for (const auto& [name, value] : frame.frame.fields) bytes += 100 + name.size() + value.size();
  return bytes;
}

}  // namespace

SweepWriter::Folder::Folder(const std::filesystem::path& name) : path(name) {
  if (!path.has_filename()) path = path.parent_path();  // "out/" is "out"
  if (::mkdir(path.c_str(), kAllForAll) != 0) fail_to_write(path, "cannot be created");
}

SweepWriter::SweepWriter(const std::filesystem::path& folder, std::vector<std::pair<std::string, std::string>> fields)
    : folder_(folder),
      pixels_(folder_.path / kSweepPixels),
      lines_(folder_.path / kSweepLines),
      samples_(folder_.path / kTrackerLines),
      reserve_(folder_.path / kReservedSpace),
      fields_(std::move(fields)) {
  sync_folder(folder_.path);
  sync_folder(folder_.path.parent_path());
}

bool SweepWriter::accepts(const cv::Mat& image) const {
  return !start_ || (image.cols == start_->width && image.rows == start_->height && image.type() == start_->pixel_type);
}

bool SweepWriter::has_room() const { return frames_ < kMostFrames && header_memory_ < kMostHeaderMemory; }

void SweepWriter::begin(const cv::Mat& image) {
  start_ = SweepStart{image.cols, image.rows, image.type(), fields_};
  write_line(line_of(*start_));
  if (early_geometry_) write_line(line_of(*early_geometry_));
  sync();
}

void SweepWriter::write_line(const std::string& line) {
  lines_.append(line);
  whole_lines_ = lines_.size();
}

std::uint32_t SweepWriter::write_pixels(const cv::Mat& image) {
  const std::size_t row_bytes = image.elemSize() * static_cast<std::size_t>(image.cols);
  const std::size_t bytes = row_bytes * static_cast<std::size_t>(image.rows);
  if (image.isContinuous()) {
    pixels_.append(std::as_bytes(std::span(image.data, bytes)));
    return crc32_of(0, image.data, bytes);
  }
  // Row by row to the system would take longer than to copy them.
  rows_.resize(bytes);
  for (int row = 0; row < image.rows; ++row) {
    const auto from = std::as_bytes(std::span(image.ptr(row), row_bytes));
    std::copy(from.begin(), from.end(), rows_.begin() + static_cast<std::ptrdiff_t>(row_bytes) * row);
  }
  pixels_.append(rows_);
  return crc32_of(0, rows_.data(), bytes);
}

void SweepWriter::write(const SharedFrame& frame, int sweep) {
  if (!start_) begin(frame->frame.image);
  FrameLine line;
  line.frame = frames_;
  line.offset = whole_pixels_;
  line.sweep = sweep;
  line.pixels_crc32 = write_pixels(frame->frame.image);
  line.bytes = pixels_.size() - whole_pixels_;
  line.tracked = *frame;  // the image is shared, not copied
  lines_.append(line_of(line));
  whole_pixels_ = pixels_.size();
  whole_lines_ = lines_.size();
  header_memory_ += memory_of(*frame);
  ++frames_;
}

void SweepWriter::write(const TrackerSample& sample) {
  samples_.append(line_of(sample));
  whole_samples_ = samples_.size();
}

void SweepWriter::write(const InvalidLine& invalid) { write_line(line_of(invalid)); }

void SweepWriter::write(const GeometryLine& geometry) {
  // The first line of the file says what images are.
  if (start_) {
    write_line(line_of(geometry));
  } else {
    early_geometry_ = geometry;
  }
}

void SweepWriter::sync() {
  // The header has the lines' numbers, in other words.
  const std::uint64_t header_bytes = 2 * whole_lines_ + kReserveStep;
  reserve_.hold((header_bytes / kReserveStep + 1) * kReserveStep);
  // Pixels first: a line on the disk then has its pixels there too.
  pixels_.sync();
  lines_.sync();
  samples_.sync();
}

void SweepWriter::close() {
  reserve_.release();
  pixels_.cut(whole_pixels_);
  lines_.cut(whole_lines_);
  samples_.cut(whole_samples_);
  pixels_.sync();
  lines_.sync();
  samples_.sync();
}

void SweepWriter::remove() {
  std::error_code ignored;
  reserve_.release();
  std::filesystem::remove_all(folder_.path, ignored);
}

}  // namespace fathom
