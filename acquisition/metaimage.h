#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "acquisition/sequence_fields.h"
#include "acquisition/sequence_file.h"

namespace fathom {

/// How fields are written in a MetaImage header.
inline constexpr FieldSyntax kMetaImageFields = {.separator = " = ", .forbidden = "=", .image_status = "ImageStatus"};

/// Whether a field says how the file is stored ("DimSize"), not what was recorded: made anew by every writer.
bool is_metaimage_storage_field(std::string_view name);

/// Whether a file's first bytes are those of a MetaImage header.
bool looks_like_metaimage(std::string_view first_bytes);

/// Reads the header of a MetaImage sequence (.mha, .mhd): `name = value` lines up to `ElementDataFile`. Pixel types are
/// MET_UCHAR (one or three channels), MET_CHAR, MET_USHORT, MET_SHORT, MET_FLOAT, MET_DOUBLE; sizes `width height`,
/// `width height frames` or `width height 1 frames`, with 3 colours as an axis before them where Kinds says `vector`,
/// as PLUS writes them; `0 0 frames` is a recording of poses only. Throws Error on any fault, also when the file is too
/// short for its pixels.
SequenceFile read_metaimage(const std::shared_ptr<const InputFile>& file);

/// How a MetaImage is to be written.
struct MetaImageLayout {
  bool compressed = false;
  std::string pixel_file;                               ///< ElementDataFile: "LOCAL", or a name beside the header
  std::optional<Eigen::Affine3d> reference_from_voxel;  ///< of a volume; empty: a recording
};

/// Text before the frames' fields, in the order that PLUS writes; of the header's own frames nothing is used. Where
/// compressed it ends a line "CompressedDataSize = " with blanks, to be overwritten when the size is known: see
/// compressed_size_place.
std::string metaimage_preamble(const RecordingHeader& header, int frame_count, const MetaImageLayout& layout);

/// Position of the number behind "CompressedDataSize = " in the preamble.
std::size_t compressed_size_place(const std::string& preamble);

/// The last line of the header.
std::string metaimage_closing_line(const MetaImageLayout& layout);

}  // namespace fathom
