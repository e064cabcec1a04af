#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/recording.h"

namespace fathom {

/// A folder of a test's own, removed with all that it holds in the end.
class TestFolder {
 public:
  TestFolder();
  ~TestFolder();
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

  /// Writes a file and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& bytes) const;

 private:
  std::filesystem::path path_;
};

std::string read_bytes(const std::filesystem::path& path);

struct SampleOptions {
  int width = 37;  // odd, so that rows are not aligned
  int height = 23;
  int frames = 11;
  int pixel_type = 0;
  std::uint64_t seed = 1;
  bool smooth = false;  ///< pixels that compress well, instead of noise
};

/// A recording with everything non-trivial at once: rotated poses, a pose that is absent in some frames, statuses,
/// times that do not begin at 0 and are missing once, an invalid image, further fields of the recording and of frames.
MemoryRecording sample_recording(const SampleOptions& options = {});

/// Expects two recordings to hold the same, other fields' order and warnings aside.
void expect_same(const Recording& actual, const Recording& expected);

/// Expects opening (and reading all of) `path` to fail with one line that names the file and contains `what`.
void expect_refused(const std::filesystem::path& path, const std::string& what);

/// Whether two images agree in size, type and every byte.
bool same_pixels(const cv::Mat& a, const cv::Mat& b);

/// A MetaImage of `frames` frames of 4 x 3 bytes counting up from 0; `fields` is inserted before ElementDataFile.
std::string tiny_metaimage(int frames, const std::string& fields = {});

}  // namespace fathom
