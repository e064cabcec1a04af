#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "registration/wire_phantom.h"

namespace fathom {

/// Reads an N-wire phantom: the `PhantomDefinition` of a PLUS configuration, with the phantom's registration where its
/// `CoordinateDefinitions` have one (`Phantom` to `reference_frame`, else to `Reference`), or Fathom's JSON:
///
///     {"fathom_phantom": 1, "name": "...", "patterns": [{"wires": [{"name": "1", "front": [x, y, z],
///      "back": [x, y, z]}, two more]}, ...], "phantom_to_reference": [16 numbers, optional]}
///
/// The file's first bytes decide. Throws Error when the file is damaged or larger than 8 MB, when it has no N-shaped
/// pattern or one of another kind, when wires of one pattern are not three in order (outer, middle, outer), are not in
/// one plane, when the outer two are not parallel or the middle one crosses them, when two wires are the same, when the
/// phantom is so small that the numbers must be metres, and when the registration is not rigid.
WirePhantom read_wire_phantom(const std::filesystem::path& path,
                              const std::optional<std::string>& reference_frame = {});

/// The text of Fathom's JSON phantom file; reads back as the same phantom.
std::string wire_phantom_json(const WirePhantom& phantom);

}  // namespace fathom
