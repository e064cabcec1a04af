#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "acquisition/sequence_fields.h"
#include "acquisition/sequence_file.h"

namespace fathom {

/// How key/value pairs are written in a NRRD header.
inline constexpr FieldSyntax kNrrdFields = {.separator = ":=", .forbidden = ":#", .image_status = "Status"};

/// Whether a file's first bytes are those of a NRRD header.
bool looks_like_nrrd(std::string_view first_bytes);

/// Reads the header of a NRRD sequence (NRRD0001 to NRRD0005; pixels attached, or in one raw or gzip file beside it).
/// Axes: `width height`, `width height frames` or `width height 1 frames`, with 3 colours as an axis before them.
///
/// Spacing and origin of the images become the fields that a MetaImage has, ElementSpacing and Offset, where they are
/// not 1 and 0; `ultrasound image type` becomes UltrasoundImageType. Throws Error on any fault, also when the file is
/// too short for its pixels.
SequenceFile read_nrrd(const std::shared_ptr<const InputFile>& file);

/// How a NRRD is to be written.
struct NrrdLayout {
  bool compressed = false;
  std::optional<Eigen::Affine3d> reference_from_voxel;  ///< of a volume; empty: a recording
};

/// Text before the frames' fields, as PLUS writes it. Fields of the recording follow as key/value pairs.
std::string nrrd_preamble(const RecordingHeader& header, const NrrdLayout& layout);

}  // namespace fathom
