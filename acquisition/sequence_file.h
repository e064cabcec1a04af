#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/orientation.h"
#include "acquisition/recording.h"
#include "core/input_file.h"

namespace fathom {

/// Where and how the pixels of a recording are stored.
struct PixelStorage {
  std::shared_ptr<const InputFile> file;          ///< null in a recording of poses only
  std::uint64_t offset = 0;                       ///< of the first byte in `file`
  std::optional<std::uint64_t> compressed_bytes;  ///< length of the zlib or gzip stream; empty where not compressed
  bool big_endian = false;                        ///< of numbers longer than a byte
  Orientation orientation;
};

/// Sizes as a header states them, not checked yet.
struct StatedSizes {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::uint64_t frames = 0;
  std::uint64_t channels = 1;
  bool has_channel_axis = false;  ///< whether the channels were stated as an axis
  std::size_t axes = 0;           ///< how many were stated besides the channels
  bool is_list = false;           ///< whether the last axis is stated to be a list or time
};

/// Fields of a NRRD header that say where its axes lie, as stored; empty where missing.
struct NrrdSpace {
  std::string space;
  std::string directions;
  std::string origin;
  std::string spacings;
};

/// A sequence metafile whose header was read and checked, and whose pixels were not read yet.
struct SequenceFile {
  RecordingHeader header;
  PixelStorage pixels;
  StatedSizes sizes;
  bool orientation_is_stated = false;   ///< of ultrasound images
  std::optional<NrrdSpace> nrrd_space;  ///< empty where the file is a MetaImage
};

/// How a header states the axes of its pixels, fastest first.
struct AxisFields {
  std::string_view name;  ///< of the field with the sizes, for messages
  std::string sizes;      ///< "820 616 97"
  std::string kinds;      ///< "domain domain list"; empty where not stated
};

/// The sizes of `width height`, `width height frames` or `width height 1 frames`, with colours as an axis before them
/// where its kind says so. Throws Error when a size is no whole number, kinds and sizes differ in number, or the axes
/// come in another order.
StatedSizes parse_axes(const AxisFields& axes, const InputFile& file);

/// Bytes of one frame.
std::uint64_t frame_bytes(const RecordingHeader& header);

/// What keeps images of this size and type from being read, for a message; empty where they can be.
std::optional<std::string> fault_of_image_format(const StatedSizes& sizes, int depth);

/// Puts width, height and pixel type into the header. `depth` is CV_8U, CV_16S, ... Throws Error when a size is beyond
/// what is supported, only one of width and height is 0, or the type is neither grey nor 8-bit colour.
void set_image_format(RecordingHeader& header, const StatedSizes& sizes, int depth, const InputFile& file);

/// Sets how the pixels lie, as `text` says; where the file says nothing, MF is assumed and the header gets a warning.
/// Throws Error when the orientation is one that is not supported.
void set_orientation(SequenceFile& sequence, const std::optional<std::string>& text, const InputFile& file);

/// What is wrong with `name` as that of a file with pixels, for a message; empty where it can be used. A header can
/// name one file only, and only beside or below its own folder.
std::optional<std::string> fault_of_pixel_file_name(std::string_view name);

/// Opens the file with the pixels that a header names: a relative path, beside or below the header's folder. Throws
/// Error when the path leads elsewhere, is a list or a pattern, or the file cannot be opened.
std::shared_ptr<const InputFile> open_pixel_file(const InputFile& header_file, std::string_view stated_name);

/// Compares the sizes with the length of the file that holds the pixels. Throws Error when it is too short, or a
/// compressed stream cannot possibly hold so much.
void check_pixel_storage(const SequenceFile& sequence, std::uint64_t frames);

}  // namespace fathom
