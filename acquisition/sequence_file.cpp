#include "acquisition/sequence_file.h"

#include <algorithm>
#include <vector>

#include <opencv2/core.hpp>

#include "acquisition/header_text.h"
#include "core/error.h"

namespace fathom {

namespace {

constexpr std::uint64_t kMostPixelsPerSide = 65535;
constexpr std::uint64_t kMostFrameBytes = 256ull << 20;  // three of them at a time stay below 1 GB
constexpr std::uint64_t kMostExpansion = 1032;           // of deflate: 258 bytes from two bits, plus the stream's frame
constexpr std::uint64_t kExpansionSlack = 1 << 16;
constexpr std::uint64_t kMostBytes = 1ull << 46;  // 64 TB: sums of sizes below it cannot overflow

bool is_colour_kind(std::string_view kind) {
  return equal_ignoring_case(kind, "vector") || equal_ignoring_case(kind, "RGB-color") ||
         equal_ignoring_case(kind, "3-color") || equal_ignoring_case(kind, "3-vector");
}

bool is_list_kind(std::string_view kind) {
  return equal_ignoring_case(kind, "list") || equal_ignoring_case(kind, "time");
}

}  // namespace

StatedSizes parse_axes(const AxisFields& axes, const InputFile& file) {
  const std::string shown = std::string(axes.name) + " is \"" + printable(axes.sizes) + "\"";
  std::vector<std::uint64_t> sizes;
  for (const std::string_view word : words(axes.sizes)) {
    const auto size = parse_count(word);
    if (!size) file.fail(shown + "; it must be whole numbers such as 640 480 100");
    sizes.push_back(*size);
  }
  const auto kinds = words(axes.kinds);
  if (!kinds.empty() && kinds.size() != sizes.size()) {
    file.fail(shown + ", but its kinds are \"" + printable(axes.kinds) + "\"; the header is damaged");
  }
  StatedSizes stated;
  const bool list_comes_early = !kinds.empty() && std::any_of(kinds.begin(), kinds.end() - 1, is_list_kind);
  if (!kinds.empty() && is_colour_kind(kinds[0])) {
    stated.has_channel_axis = true;
    stated.channels = sizes[0];
    sizes.erase(sizes.begin());
  }
  const bool flat_volumes = sizes.size() == 4 && sizes[2] == 1;
  if (list_comes_early || (sizes.size() != 2 && sizes.size() != 3 && !flat_volumes)) {
    file.fail(shown + (kinds.empty() ? std::string() : " and its kinds are \"" + printable(axes.kinds) + "\"") +
              "; only width, height and number of frames, in this order, can be read");
  }
  stated.width = sizes[0];
  stated.height = sizes[1];
  stated.frames = sizes.size() == 2 ? 1 : sizes.back();
  stated.axes = sizes.size();
  stated.is_list = !kinds.empty() && is_list_kind(kinds.back());
  return stated;
}

std::uint64_t frame_bytes(const RecordingHeader& header) {
  return static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height) *
         static_cast<std::uint64_t>(CV_ELEM_SIZE(header.pixel_type));
}

std::optional<std::string> fault_of_image_format(const StatedSizes& sizes, int depth) {
  const std::string images = std::to_string(sizes.width) + " x " + std::to_string(sizes.height) + " pixels";
  if (sizes.channels != 1 && !(sizes.channels == 3 && depth == CV_8U)) {
    return "has pixels of " + std::to_string(sizes.channels) +
           " channels of its type; only one channel, or three 8-bit channels, can be read";
  }
  if ((sizes.width == 0) != (sizes.height == 0)) return "has images of " + images + "; the header is damaged";
  if (sizes.width > kMostPixelsPerSide || sizes.height > kMostPixelsPerSide) {
    return "has images of " + images + "; at most " + std::to_string(kMostPixelsPerSide) + " a side can be read";
  }
  const std::uint64_t bytes = sizes.width * sizes.height * sizes.channels * CV_ELEM_SIZE1(depth);
  if (bytes > kMostFrameBytes) {
    return "has images of " + std::to_string(bytes >> 20) + " MB each; at most " +
           std::to_string(kMostFrameBytes >> 20) + " MB can be read";
  }
  return std::nullopt;
}

void set_image_format(RecordingHeader& header, const StatedSizes& sizes, int depth, const InputFile& file) {
  if (const auto fault = fault_of_image_format(sizes, depth)) file.fail(*fault);
  header.width = static_cast<int>(sizes.width);
  header.height = static_cast<int>(sizes.height);
  header.pixel_type = CV_MAKETYPE(depth, static_cast<int>(sizes.channels));
}

void set_orientation(SequenceFile& sequence, const std::optional<std::string>& text, const InputFile& file) {
  sequence.orientation_is_stated = text.has_value();
  if (!sequence.header.has_images()) return;
  // PLUS writes XX where it does not know.
  if (!text || text->empty() || equal_ignoring_case(*text, "XX") || equal_ignoring_case(*text, "XXX")) {
    sequence.header.warnings.push_back(
        "the file does not say how its images lie; assumed MF (x to the marked side, y away from the probe)");
    return;
  }
  const auto orientation = parse_orientation(*text);
  if (!orientation) {
    file.fail("its images lie in orientation \"" + printable(*text) + "\"; only MF, MN, UF and UN can be read");
  }
  sequence.pixels.orientation = *orientation;
}

std::optional<std::string> fault_of_pixel_file_name(std::string_view name) {
  if (name.find('%') != std::string_view::npos || name.starts_with("LIST")) return "stands for several files";
  const auto is_unusual = [](char c) { return c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  const std::filesystem::path path(name);
  const bool is_plain = !name.empty() && name == trimmed(name) && !path.is_absolute() &&
                        !equal_ignoring_case(name, "LOCAL") && std::none_of(name.begin(), name.end(), is_unusual) &&
                        std::find(path.begin(), path.end(), "..") == path.end();
  if (!is_plain) return "is not a plain name beside this file";
  return std::nullopt;
}

std::shared_ptr<const InputFile> open_pixel_file(const InputFile& header_file, std::string_view stated_name) {
  if (const auto fault = fault_of_pixel_file_name(stated_name)) {
    header_file.fail("names \"" + printable(stated_name) + "\" as the file with its pixels, which " + *fault +
                     "; store them in one file beside it");
  }
  const std::filesystem::path name(stated_name);
  try {
    return std::make_shared<InputFile>(header_file.path().parent_path() / name);
  } catch (const Error& e) {
    header_file.fail(std::string("the file with its pixels is missing or cannot be used: ") + e.what());
  }
}

void check_pixel_storage(const SequenceFile& sequence, std::uint64_t frames) {
  const PixelStorage& pixels = sequence.pixels;
  const InputFile& file = *pixels.file;
  const std::uint64_t one = frame_bytes(sequence.header);
  if (frames > kMostBytes / one) file.fail("claims more pixels than any file can hold; the header is damaged");
  const std::uint64_t all = frames * one;
  if (pixels.offset > file.size()) file.fail("ends before its pixels; it was cut short: copy it again");
  const std::uint64_t available = file.size() - pixels.offset;
  if (!pixels.compressed_bytes) {
    if (all > available) {
      file.fail("holds " + std::to_string(available / one) + " of its " + std::to_string(frames) +
                " frames; it was cut short: copy it again");
    }
    return;
  }
  if (*pixels.compressed_bytes > available) {
    file.fail("holds " + std::to_string(available) + " of its " + std::to_string(*pixels.compressed_bytes) +
              " compressed bytes; it was cut short: copy it again");
  }
  if (all > *pixels.compressed_bytes * kMostExpansion + kExpansionSlack) {
    file.fail("claims " + std::to_string(all) + " bytes of pixels from " + std::to_string(*pixels.compressed_bytes) +
              " compressed ones, which is not possible; the header is damaged");
  }
}

}  // namespace fathom
