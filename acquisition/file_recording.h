#pragma once

#include <filesystem>
#include <memory>

#include "acquisition/inflate_stream.h"
#include "acquisition/pixel_source.h"
#include "acquisition/recording.h"

namespace fathom {

/// Reads the header of a sequence metafile in whichever format its first bytes name. Throws Error on any fault.
SequenceFile read_sequence(const std::shared_ptr<const InputFile>& file);

/// A recording whose pixels stay in the file until they are asked for.
class FileRecording : public Recording {
 public:
  /// Throws Error as open_recording does.
  explicit FileRecording(const std::filesystem::path& path, const InflateOptions& options = {});
  cv::Mat image(int frame) const override;

 private:
  FileRecording(std::string name, SequenceFile sequence, const InflateOptions& options);

  std::unique_ptr<PixelSource> pixels_;
};

}  // namespace fathom
