#include "acquisition/nrrd.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <optional>
#include <utility>

#include <opencv2/core.hpp>

#include "acquisition/header_text.h"
#include "acquisition/metaimage.h"
#include "acquisition/nrrd_geometry.h"
#include "acquisition/volume_geometry.h"
#include "core/error.h"

namespace fathom {

namespace {

constexpr std::array<std::pair<std::string_view, int>, 23> kTypes = {{{"uint8", CV_8U},
                                                                      {"uint8_t", CV_8U},
                                                                      {"uchar", CV_8U},
                                                                      {"unsigned char", CV_8U},
                                                                      {"int8", CV_8S},
                                                                      {"int8_t", CV_8S},
                                                                      {"signed char", CV_8S},
                                                                      {"uint16", CV_16U},
                                                                      {"uint16_t", CV_16U},
                                                                      {"ushort", CV_16U},
                                                                      {"unsigned short", CV_16U},
                                                                      {"unsigned short int", CV_16U},
                                                                      {"int16", CV_16S},
                                                                      {"int16_t", CV_16S},
                                                                      {"short", CV_16S},
                                                                      {"short int", CV_16S},
                                                                      {"signed short", CV_16S},
                                                                      {"signed short int", CV_16S},
                                                                      {"float", CV_32F},
                                                                      {"double", CV_64F},
                                                                      {"float32", CV_32F},
                                                                      {"float64", CV_64F},
                                                                      {"none", CV_8U}}};

constexpr std::array<std::string_view, 18> kStorageFields = {"dimension",
                                                             "encoding",
                                                             "endian",
                                                             "kinds",
                                                             "sizes",
                                                             "type",
                                                             "space",
                                                             "space dimension",
                                                             "space directions",
                                                             "space origin",
                                                             "spacings",
                                                             "data file",
                                                             "byte skip",
                                                             "line skip",
                                                             "ultrasound image orientation",
                                                             "ultrasound image type",
                                                             "UltrasoundImageOrientation",
                                                             "block size"};

constexpr std::string_view kImageType = "ultrasound image type";
constexpr std::string_view kImageOrientation = "ultrasound image orientation";
constexpr std::uint64_t kShortestFrameField = 16;  // "Seq_Frame0000_T=": a frame of poses has one

using Fields = std::map<std::string, std::string, std::less<>>;

std::optional<std::string> find(const Fields& fields, std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end()) return std::nullopt;
  return found->second;
}

std::string require(const Fields& fields, std::string_view name, const InputFile& file) {
  const auto value = find(fields, name);
  if (!value) file.fail("its header has no \"" + std::string(name) + "\"; it was cut short or is no recording");
  return *value;
}

StatedSizes stated_sizes(const Fields& fields, const InputFile& file) {
  const AxisFields axes = {"sizes", require(fields, "sizes", file), find(fields, "kinds").value_or("")};
  if (parse_count(require(fields, "dimension", file)) != words(axes.sizes).size()) {
    file.fail("its dimension does not agree with its sizes \"" + printable(axes.sizes) + "\"; the header is damaged");
  }
  return parse_axes(axes, file);
}

int stated_depth(const Fields& fields, bool has_images, const InputFile& file) {
  const std::string type = require(fields, "type", file);
  for (const auto& [name, depth] : kTypes) {
    if (equal_ignoring_case(type, name) && !(has_images && name == "none")) return depth;
  }
  file.fail("its pixels are of type \"" + printable(type) +
            "\"; only 8-bit and 16-bit integers, float and double can be read");
}

/// A gzip stream ends with the number of bytes that it holds: a stream that was cut, or holds other pixels than the
/// header says, is found without reading it.
void check_gzip_length(const PixelStorage& pixels, std::uint64_t expected_bytes) {
  constexpr std::uint64_t kShortestGzip = 18;
  const std::uint64_t end = pixels.file->size();
  std::array<std::byte, 4> length = {};
  if (end < pixels.offset + kShortestGzip || pixels.file->read_some(end - length.size(), length) != length.size()) {
    pixels.file->fail("ends before its pixels; it was cut short: copy it again");
  }
  std::uint32_t stated = 0;
  for (std::size_t i = length.size(); i-- > 0;) stated = stated << 8 | std::to_integer<std::uint32_t>(length[i]);
  if (stated != static_cast<std::uint32_t>(expected_bytes)) {
    pixels.file->fail("its compressed pixels are cut short, or are not as many as its header says; copy it again");
  }
}

void set_pixel_storage(SequenceFile& sequence, const Fields& fields, std::uint64_t header_end,
                       const std::shared_ptr<const InputFile>& file) {
  PixelStorage& pixels = sequence.pixels;
  const auto data_file = find(fields, "data file");
  pixels.file = data_file ? open_pixel_file(*file, *data_file) : file;
  pixels.offset = data_file ? 0 : header_end;
  const std::string encoding = require(fields, "encoding", *file);
  const bool gzip = equal_ignoring_case(encoding, "gz") || equal_ignoring_case(encoding, "gzip");
  if (!gzip && !equal_ignoring_case(encoding, "raw")) {
    file->fail("its pixels are encoded as \"" + printable(encoding) + "\"; only raw and gzip can be read");
  }
  for (const std::string_view skip : {"byte skip", "line skip"}) {
    const auto text = find(fields, skip);
    if (!text || *text == "0") continue;
    const auto bytes = parse_count(*text);
    if (!bytes || gzip || skip == "line skip" || *bytes > pixels.file->size()) {
      file->fail("its \"" + std::string(skip) + "\" of \"" + printable(*text) + "\" cannot be read; store it plainly");
    }
    pixels.offset += *bytes;
  }
  if (CV_ELEM_SIZE1(sequence.header.pixel_type) > 1) {
    const auto endian = find(fields, "endian");
    if (!endian) {
      sequence.header.warnings.push_back("the file does not say its byte order; assumed little-endian");
    } else if (equal_ignoring_case(*endian, "big")) {
      pixels.big_endian = true;
    } else if (!equal_ignoring_case(*endian, "little")) {
      file->fail("its endian is \"" + printable(*endian) + "\"; it must be little or big");
    }
  }
  if (gzip) pixels.compressed_bytes = pixels.offset > pixels.file->size() ? 0 : pixels.file->size() - pixels.offset;
}

}  // namespace

bool looks_like_nrrd(std::string_view first_bytes) { return first_bytes.starts_with("NRRD"); }

SequenceFile read_nrrd(const std::shared_ptr<const InputFile>& file) {
  HeaderLines lines(*file);
  const std::string magic(trimmed(lines.next().value_or("")));
  if (magic.size() != 8 || !magic.starts_with("NRRD000") || magic[7] < '1' || magic[7] > '5') {
    file->fail("is NRRD of version \"" + printable(magic) + "\"; versions NRRD0001 to NRRD0005 can be read");
  }
  SequenceFields fields(file->name(), "Status");
  Fields storage;
  bool has_spacing = false;
  bool has_offset = false;
  bool has_image_type = false;
  bool closed = false;
  while (const auto line = lines.next()) {
    if (line->empty()) {
      closed = true;
      break;
    }
    if (line->front() == '#') continue;
    const std::size_t separator = line->find(':');
    if (separator == std::string_view::npos) lines.fail("is neither a field nor a comment; the header is damaged");
    std::string_view name = trimmed(line->substr(0, separator));
    std::string_view value = line->substr(separator + 1);
    if (value.starts_with('=')) value.remove_prefix(1);
    // Backslashes stay as they are: PLUS writes and reads them so, although NRRD would have them doubled.
    value = trimmed(value);
    if (name.empty()) lines.fail("has no name before the ':'; the header is damaged");
    if (name == "datafile") name = "data file";
    if (name == "byteskip") name = "byte skip";
    if (name == "lineskip") name = "line skip";
    if (SequenceFields::is_frame_field(name)) {
      fields.add_frame_field(name, value);
    } else if (std::find(kStorageFields.begin(), kStorageFields.end(), name) == kStorageFields.end()) {
      fields.add_field(name, value);
      has_spacing = has_spacing || name == "ElementSpacing";
      has_offset = has_offset || name == "Offset";
      has_image_type = has_image_type || name == "UltrasoundImageType";
    } else if (const auto [place, is_new] = storage.emplace(name, value); !is_new && place->second != value) {
      // PLUS itself repeats a field when it rewrites a file that it has read; only a contradiction is damage.
      file->fail("\"" + std::string(name) + "\" is given twice; the header is damaged");
    }
  }
  if (!closed && !storage.contains("data file")) {
    file->fail("its header does not end with an empty line; it was cut short: copy it again");
  }

  SequenceFile sequence;
  const StatedSizes sizes = stated_sizes(storage, *file);
  sequence.sizes = sizes;
  const bool has_images = sizes.width > 0 && sizes.height > 0;
  set_image_format(sequence.header, sizes, stated_depth(storage, has_images, *file), *file);
  if (has_images) {
    set_pixel_storage(sequence, storage, lines.position(), file);
    check_pixel_storage(sequence, sizes.frames);
    const std::uint64_t all_bytes = sizes.frames * frame_bytes(sequence.header);
    if (sequence.pixels.compressed_bytes) check_gzip_length(sequence.pixels, all_bytes);
  } else if (sizes.frames > lines.position() / kShortestFrameField) {
    file->fail("claims " + std::to_string(sizes.frames) + " frames, more than its header has room for; it is damaged");
  }
  sequence.nrrd_space = {find(storage, "space").value_or(""), find(storage, "space directions").value_or(""),
                         find(storage, "space origin").value_or(""), find(storage, "spacings").value_or("")};
  const NrrdGeometry geometry =
      parse_nrrd_geometry(sequence.nrrd_space->directions, sequence.nrrd_space->spacings, sequence.nrrd_space->origin);
  if (geometry.element_spacing && !has_spacing) fields.add_field("ElementSpacing", *geometry.element_spacing);
  if (geometry.offset && !has_offset) fields.add_field("Offset", *geometry.offset);
  const auto image_type = find(storage, kImageType);
  if (image_type && !has_image_type) fields.add_field("UltrasoundImageType", *image_type);
  fields.finish(sizes.frames, sequence.header);
  const auto orientation = find(storage, kImageOrientation);
  set_orientation(sequence, orientation ? orientation : find(storage, "UltrasoundImageOrientation"), *file);
  return sequence;
}

std::string nrrd_preamble(const RecordingHeader& header, const NrrdLayout& layout) {
  const int channels = CV_MAT_CN(header.pixel_type);
  const auto type = std::find_if(kTypes.begin(), kTypes.end(),
                                 [&](const auto& entry) { return entry.second == CV_MAT_DEPTH(header.pixel_type); });
  std::string text =
      "NRRD0004\n# Complete NRRD file format specification at:\n# http://teem.sourceforge.net/nrrd/format.html\n";
  text += channels > 1 ? "dimension: 4\n" : "dimension: 3\n";
  text += layout.compressed ? "encoding: gz\n" : "encoding: raw\n";
  text += std::endian::native == std::endian::big ? "endian: big\n" : "endian: little\n";
  // PLUS knows the axis of colours by the kind "vector" only.
  text += layout.reference_from_voxel ? "kinds: domain domain domain\n"
          : channels > 1              ? "kinds: vector domain domain list\n"
                                      : "kinds: domain domain list\n";
  text += "sizes: ";
  if (channels > 1) text += std::to_string(channels) + ' ';
  text += std::to_string(header.width) + ' ' + std::to_string(header.height) + ' ' +
          std::to_string(header.frame_count()) + '\n';
  text += layout.reference_from_voxel ? nrrd_volume_lines(*layout.reference_from_voxel) : nrrd_geometry_fields(header);
  text += "type: ";
  text += type->first;
  text += '\n';
  if (!layout.reference_from_voxel) append_field(text, kImageOrientation, "MFA", kNrrdFields);
  for (const auto& [name, value] : header.fields) {
    if (is_metaimage_storage_field(name) || name.empty() ||
        std::find(kStorageFields.begin(), kStorageFields.end(), name) != kStorageFields.end()) {
      continue;
    }
    append_field(text, name == "UltrasoundImageType" ? kImageType : std::string_view(name), value, kNrrdFields);
  }
  return text;
}

}  // namespace fathom
