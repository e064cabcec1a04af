#include "acquisition/metaimage.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>

#include "acquisition/header_text.h"
#include "acquisition/sequence_fields.h"
#include "acquisition/volume_geometry.h"

namespace fathom {

namespace {

constexpr std::array<std::pair<std::string_view, int>, 6> kElementTypes = {{{"MET_UCHAR", CV_8U},
                                                                            {"MET_CHAR", CV_8S},
                                                                            {"MET_USHORT", CV_16U},
                                                                            {"MET_SHORT", CV_16S},
                                                                            {"MET_FLOAT", CV_32F},
                                                                            {"MET_DOUBLE", CV_64F}}};

// Fields that say how the file is stored, not what was recorded: understood on reading, made anew on writing.
constexpr std::array<std::string_view, 14> kStorageFields = {"ObjectType",
                                                             "NDims",
                                                             "BinaryData",
                                                             "BinaryDataByteOrderMSB",
                                                             "DimSize",
                                                             "Kinds",
                                                             "CompressedData",
                                                             "ElementByteOrderMSB",
                                                             "ElementType",
                                                             "HeaderSize",
                                                             "CompressedDataSize",
                                                             "ElementNumberOfChannels",
                                                             "ElementDataFile",
                                                             "UltrasoundImageOrientation"};
constexpr std::string_view kSizePadding = "                    ";  // room for any 64-bit number
constexpr std::uint64_t kShortestFrameField = 16;                  // "Seq_Frame0000_T=": a frame of poses has one

/// The fields of kStorageFields that a file has.
class StorageFields {
 public:
  explicit StorageFields(const InputFile& file) : file_(file) {}

  /// Takes a field if it is one of these. Throws Error when it was given before.
  bool take(std::string_view name, std::string_view value) {
    if (!is_metaimage_storage_field(name)) return false;
    if (!values_.emplace(name, value).second) file_.fail(std::string(name) + " is given twice; the header is damaged");
    return true;
  }

  std::optional<std::string> text(std::string_view name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) return std::nullopt;
    return found->second;
  }

  std::string required(std::string_view name) const {
    const auto value = text(name);
    if (!value) file_.fail("its header has no " + std::string(name) + "; it was cut short or is no recording");
    return *value;
  }

  bool truth(std::string_view name, bool otherwise) const {
    const auto value = text(name);
    if (!value) return otherwise;
    if (equal_ignoring_case(*value, "True") || *value == "1") return true;
    if (equal_ignoring_case(*value, "False") || *value == "0") return false;
    file_.fail(std::string(name) + " is \"" + printable(*value) + "\"; it must be True or False");
  }

  std::uint64_t count(std::string_view name, std::uint64_t otherwise) const {
    const auto value = text(name);
    if (!value) return otherwise;
    const auto number = parse_count(*value);
    if (!number) file_.fail(std::string(name) + " is \"" + printable(*value) + "\"; it must be a whole number");
    return *number;
  }

 private:
  const InputFile& file_;
  std::map<std::string, std::string, std::less<>> values_;
};

StatedSizes stated_sizes(const StorageFields& storage, const InputFile& file) {
  const AxisFields axes = {"DimSize", storage.required("DimSize"), storage.text("Kinds").value_or("")};
  StatedSizes stated = parse_axes(axes, file);
  const std::uint64_t numbers = words(axes.sizes).size();
  const std::uint64_t dimensions = storage.count("NDims", numbers);
  // PLUS does not count its axis of colours.
  if (dimensions != numbers && !(stated.has_channel_axis && dimensions + 1 == numbers)) {
    file.fail("NDims is " + std::to_string(dimensions) + ", but DimSize has " + std::to_string(numbers) +
              " numbers; the header is damaged");
  }
  const std::uint64_t channels = storage.count("ElementNumberOfChannels", stated.channels);
  if (stated.has_channel_axis && channels != stated.channels) {
    file.fail("ElementNumberOfChannels is " + std::to_string(channels) + ", but DimSize is \"" + printable(axes.sizes) +
              "\"; the header is damaged");
  }
  stated.channels = channels;
  return stated;
}

int stated_depth(const StorageFields& storage, bool has_images, const InputFile& file) {
  if (!has_images && !storage.text("ElementType")) return CV_8U;
  const std::string type = storage.required("ElementType");
  for (const auto& [name, depth] : kElementTypes) {
    if (type == name) return depth;
  }
  if (!has_images) return CV_8U;
  file.fail("its pixels are of type \"" + printable(type) +
            "\"; only MET_UCHAR, MET_CHAR, MET_USHORT, MET_SHORT, MET_FLOAT and MET_DOUBLE can be read");
}

void set_pixel_storage(SequenceFile& sequence, const StorageFields& storage, const HeaderLines& lines,
                       const std::shared_ptr<const InputFile>& file) {
  PixelStorage& pixels = sequence.pixels;
  if (!storage.truth("BinaryData", true)) file->fail("its pixels are stored as text; only binary ones can be read");
  const std::string name = storage.required("ElementDataFile");
  const bool local = equal_ignoring_case(name, "LOCAL");
  pixels.file = local ? file : open_pixel_file(*file, name);
  pixels.offset = local ? lines.position() : 0;
  if (const auto skip = storage.text("HeaderSize"); skip && *skip != "0") {
    const auto bytes = parse_count(*skip);
    if (local || !bytes || *bytes > pixels.file->size()) {
      file->fail("HeaderSize is \"" + printable(*skip) +
                 "\"; it must be the number of bytes before the pixels in a file of their own");
    }
    pixels.offset = *bytes;
  }
  pixels.big_endian = storage.truth("BinaryDataByteOrderMSB", storage.truth("ElementByteOrderMSB", false));
  if (storage.truth("CompressedData", false)) {
    // MetaIO's writers may leave the size out; then the stream takes the rest of the file.
    const std::uint64_t rest = pixels.offset > pixels.file->size() ? 0 : pixels.file->size() - pixels.offset;
    pixels.compressed_bytes = storage.count("CompressedDataSize", rest);
  }
}

}  // namespace

bool is_metaimage_storage_field(std::string_view name) {
  return std::find(kStorageFields.begin(), kStorageFields.end(), name) != kStorageFields.end();
}

bool looks_like_metaimage(std::string_view first_bytes) {
  const std::string_view name = trimmed(first_bytes.substr(0, first_bytes.find('=')));
  return first_bytes.find('=') != std::string_view::npos && (name == "ObjectType" || name == "NDims");
}

SequenceFile read_metaimage(const std::shared_ptr<const InputFile>& file) {
  HeaderLines lines(*file);
  SequenceFields fields(file->name());
  StorageFields storage(*file);
  bool closed = false;
  while (!closed) {
    const auto line = lines.next();
    if (!line) break;
    if (trimmed(*line).empty()) continue;
    const std::size_t separator = line->find('=');
    if (separator == std::string_view::npos) lines.fail("is not of the form name = value; the header is damaged");
    const std::string_view name = trimmed(line->substr(0, separator));
    const std::string_view value = trimmed(line->substr(separator + 1));
    if (name.empty()) lines.fail("has no name before the '='; the header is damaged");
    if (SequenceFields::is_frame_field(name)) {
      fields.add_frame_field(name, value);
    } else if (!storage.take(name, value)) {
      fields.add_field(name, value);
    }
    closed = name == "ElementDataFile";
  }

  if (const auto type = storage.text("ObjectType"); type && *type != "Image") {
    file->fail("is a MetaIO file of type \"" + printable(*type) + "\", not an image; give a recording");
  }
  SequenceFile sequence;
  const StatedSizes sizes = stated_sizes(storage, *file);
  sequence.sizes = sizes;
  const bool has_images = sizes.width > 0 && sizes.height > 0;
  set_image_format(sequence.header, sizes, stated_depth(storage, has_images, *file), *file);
  if (has_images) {
    set_pixel_storage(sequence, storage, lines, file);
    check_pixel_storage(sequence, sizes.frames);
  } else {
    if (sizes.frames > lines.position() / kShortestFrameField) {
      file->fail("claims " + std::to_string(sizes.frames) +
                 " frames, more than its header has room for; it is damaged");
    }
    if (!closed && (!lines.line_was_ended() || fields.frames_seen() < sizes.frames)) {
      file->fail("its header ends early, without ElementDataFile; it was cut short: copy it again");
    }
  }
  fields.finish(sizes.frames, sequence.header);
  set_orientation(sequence, storage.text("UltrasoundImageOrientation"), *file);
  return sequence;
}

std::string metaimage_preamble(const RecordingHeader& header, int frame_count, const MetaImageLayout& layout) {
  const auto type = std::find_if(kElementTypes.begin(), kElementTypes.end(),
                                 [&](const auto& entry) { return entry.second == CV_MAT_DEPTH(header.pixel_type); });
  std::string text = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = ";
  text += std::endian::native == std::endian::big ? "True\n" : "False\n";
  if (layout.compressed) {
    text += "CompressedData = True\nCompressedDataSize = ";
    text += kSizePadding;
    text += '\n';
  } else {
    text += "CompressedData = False\n";
  }
  text += "DimSize = " + std::to_string(header.width) + ' ' + std::to_string(header.height) + ' ' +
          std::to_string(frame_count) + '\n';
  if (!layout.reference_from_voxel) text += "Kinds = domain domain list\n";
  if (CV_MAT_CN(header.pixel_type) > 1) {
    text += "ElementNumberOfChannels = " + std::to_string(CV_MAT_CN(header.pixel_type)) + '\n';
  }
  text += "ElementType = ";
  text += type->first;
  text += '\n';
  if (layout.reference_from_voxel) {
    text += metaimage_volume_lines(*layout.reference_from_voxel);
  } else {
    text += "UltrasoundImageOrientation = MFA\n";
  }
  for (const auto& [name, value] : header.fields) {
    if (!is_metaimage_storage_field(name)) append_field(text, name, value, kMetaImageFields);
  }
  return text;
}

std::size_t compressed_size_place(const std::string& preamble) {
  constexpr std::string_view kField = "\nCompressedDataSize = ";
  return preamble.find(kField) + kField.size();
}

std::string metaimage_closing_line(const MetaImageLayout& layout) {
  return "ElementDataFile = " + layout.pixel_file + '\n';
}

}  // namespace fathom
