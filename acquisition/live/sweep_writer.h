#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/live/append_file.h"
#include "acquisition/live/sweep_lines.h"
#include "acquisition/live/tracked_frame.h"

namespace fathom {

/// The three files of a recording folder while they grow. After any Error they end with the last whole frame again, as
/// far as the disk allows.
class SweepWriter {
 public:
  /// Makes the folder and its files. Throws Error when it exists or cannot be made.
  SweepWriter(const std::filesystem::path& folder, std::vector<std::pair<std::string, std::string>> fields);

  /// Whether a frame has the size and type of those before it.
  bool accepts(const cv::Mat& image) const;

  /// Whether the header of the recording could hold another frame and still be read.
  bool has_room() const;

  /// Throws Error when the disk is full or fails.
  void write(const SharedFrame& frame, int sweep);
  void write(const TrackerSample& sample);
  void write(const InvalidLine& invalid);
  void write(const GeometryLine& geometry);

  /// Brings everything onto the disk, and holds back room for the header. Throws Error.
  void sync();

  /// Drops what a failed write has left, and gives back the room for the header.
  void close();

  /// Removes the folder again.
  void remove();

  std::uint64_t frames() const { return frames_; }
  std::uint64_t bytes() const { return pixels_.size(); }
  const std::filesystem::path& folder() const { return folder_.path; }

 private:
  struct Folder {
    explicit Folder(const std::filesystem::path& path);
    std::filesystem::path path;
  };

  void begin(const cv::Mat& image);
  void write_line(const std::string& line);
  std::uint32_t write_pixels(const cv::Mat& image);

  Folder folder_;
  AppendFile pixels_;
  AppendFile lines_;
  AppendFile samples_;
  ReservedSpace reserve_;
  std::vector<std::pair<std::string, std::string>> fields_;
  std::optional<SweepStart> start_;
  std::optional<GeometryLine> early_geometry_;  ///< that came before the first frame
  std::vector<std::byte> rows_;                 ///< of an image that is part of another
  std::uint64_t frames_ = 0;
  std::uint64_t whole_pixels_ = 0;  ///< bytes up to the last whole frame
  std::uint64_t whole_lines_ = 0;
  std::uint64_t whole_samples_ = 0;
  std::uint64_t header_memory_ = 0;  ///< that reading the finished header will take, estimated
};

}  // namespace fathom
