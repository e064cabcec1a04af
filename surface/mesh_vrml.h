#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/atomic_file.h"
#include "core/progress.h"
#include "surface/mesh.h"
#include "surface/mesh_source.h"

namespace fathom {

/// The beginning of every VRML 2.0 text file.
inline constexpr std::string_view kVrmlMagic = "#VRML V2.0 utf8";

/// Reads the IndexedFaceSets of a VRML 2.0 text file (VRML97) as one mesh: coord (a Coordinate, also by DEF and USE),
/// coordIndex, ccw, and normals where there is one for each vertex. Other nodes and fields are passed over.
///
/// Throws Error, also where a Transform moves, turns or scales its children, and for shapes from another file or used a
/// second time, as the mesh would not be what is shown.
Mesh read_vrml(MeshSource& source);

/// Writes a Shape with a Material of this colour (red, green, blue from 0 to 255) and an IndexedFaceSet with as many
/// digits as bring every number back. The file is not committed. `mesh` must be valid. Throws Error; Cancelled.
void write_vrml(const Mesh& mesh, AtomicFile& file, const std::array<std::uint8_t, 3>& color, const Progress& progress);

}  // namespace fathom
