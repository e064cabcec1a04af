#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/recording.h"

namespace fathom {

/// "(0.3,0) (0,0.2) none" as vectors; "none" is an empty one. Empty when the text is anything else.
std::vector<std::vector<double>> parse_nrrd_vectors(std::string_view text);

/// Pixel spacing and origin of a NRRD file in the form of a MetaImage's fields, three numbers each; empty where they
/// are the usual 1 and 0, or cannot be told.
struct NrrdGeometry {
  std::optional<std::string> element_spacing;  ///< lengths of the space directions, else the spacings
  std::optional<std::string> offset;           ///< the space origin
};

/// Takes the values of a NRRD header's fields; empty ones are missing.
NrrdGeometry parse_nrrd_geometry(std::string_view space_directions, std::string_view spacings,
                                 std::string_view space_origin);

/// The lines "space dimension", "space directions" and "space origin" for a recording's ElementSpacing and Offset.
std::string nrrd_geometry_fields(const RecordingHeader& header);

}  // namespace fathom
