#include "acquisition/file_recording.h"

#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include "acquisition/live/recording_folder.h"
#include "acquisition/metaimage.h"
#include "acquisition/nrrd.h"

namespace fathom {

SequenceFile read_sequence(const std::shared_ptr<const InputFile>& file) {
  if (file->size() == 0) file->fail("is empty; copy it again");
  std::array<char, 64> first = {};
  const std::size_t count = file->read_some(0, std::as_writable_bytes(std::span(first)));
  const std::string_view first_bytes(first.data(), count);
  if (looks_like_nrrd(first_bytes)) return read_nrrd(file);
  if (looks_like_metaimage(first_bytes)) return read_metaimage(file);
  file->fail("is not a recording that can be read; give a sequence metafile (.mha, .mhd or .nrrd)");
}

FileRecording::FileRecording(const std::filesystem::path& path, const InflateOptions& options)
    : FileRecording(path.string(), read_sequence(std::make_shared<InputFile>(path)), options) {}

FileRecording::FileRecording(std::string name, SequenceFile sequence, const InflateOptions& options)
    : Recording(std::move(name), {}) {
  if (sequence.header.has_images()) pixels_ = open_pixels(sequence, options);
  header_ = std::move(sequence.header);  // it may be hundreds of megabytes: never copied
}

cv::Mat FileRecording::image(int frame) const {
  require_frame(frame);
  return pixels_->frame(frame);
}

std::unique_ptr<Recording> open_recording(const std::filesystem::path& path) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  return std::make_unique<FileRecording>(is_folder ? finished_header(path) : path);
}

}  // namespace fathom
