#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/live/tracked_frame.h"
#include "acquisition/recording.h"
#include "core/input_file.h"

namespace fathom {

// The lines of a recording folder: one JSON object each, whose last member "crc32" is the checksum (CRC-32 as in zlib,
// eight hexadecimal digits) of all bytes before it, up to and without the comma.

/// Of `sweep.jsonl`, first line: what all frames share.
struct SweepStart {
  int width = 0;
  int height = 0;
  int pixel_type = 0;                                       ///< as RecordingHeader::pixel_type
  std::vector<std::pair<std::string, std::string>> fields;  ///< for the header
};

/// Of `sweep.jsonl`: one frame.
struct FrameLine {
  std::uint64_t frame = 0;   ///< counted from 0 in this recording
  std::uint64_t offset = 0;  ///< of its pixels in `sweep.raw`
  std::uint64_t bytes = 0;   ///< of its pixels
  std::uint32_t pixels_crc32 = 0;
  int sweep = 0;         ///< counted from 0: see Recorder::new_sweep
  TrackedFrame tracked;  ///< without the image
};

/// Of `sweep.jsonl`: frames `first` to `last`, inclusive, written above, turned out not to be valid.
struct InvalidLine {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

/// Of `sweep.jsonl`: the images' geometry has changed, see GeometryFault. Frames since then have no place.
struct GeometryLine {
  std::string fault;
  double since_s = 0.0;
};

std::string line_of(const SweepStart& start);
std::string line_of(const FrameLine& frame);
std::string line_of(const InvalidLine& invalid);
std::string line_of(const GeometryLine& geometry);
/// Of `tracker.jsonl`.
std::string line_of(const TrackerSample& sample);

/// Each is empty where the line is of another kind, or not as these functions write it, or its checksum is wrong.
std::optional<SweepStart> parse_sweep_start(std::string_view line);
std::optional<FrameLine> parse_frame_line(std::string_view line);
std::optional<InvalidLine> parse_invalid_line(std::string_view line);
std::optional<GeometryLine> parse_geometry_line(std::string_view line);
std::optional<TrackerSample> parse_sample_line(std::string_view line);

/// Whether the line's checksum is right.
bool is_whole_line(std::string_view line);

/// Calls `use` with every line that was ended, without its end, in pieces of bounded memory; a line longer than 1 MB
/// comes as an empty one. Throws Error when the disk fails.
void for_each_line(const InputFile& file, const std::function<void(std::string_view)>& use);

std::uint32_t crc32_of(std::uint32_t before, const void* bytes, std::size_t count);

}  // namespace fathom
