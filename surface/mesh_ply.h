#pragma once

#include "core/atomic_file.h"
#include "core/progress.h"
#include "surface/mesh.h"
#include "surface/mesh_source.h"

namespace fathom {

/// Reads a PLY file, version 1.0: text, or binary in either byte order. Of element `vertex` the properties x, y, z are
/// read, and nx, ny, nz where all three are there; of element `face` the list vertex_indices (or vertex_index), and
/// sweep_sign, which must be +1 or -1. Other elements and properties, lists among them, are passed over. Throws Error.
Mesh read_ply(MeshSource& source);

/// Writes little-endian binary PLY with double vertices and normals, and sweep_sign as a char of each face. The file is
/// not committed. `mesh` must be valid. Throws Error; Cancelled.
void write_ply(const Mesh& mesh, AtomicFile& file, const Progress& progress);

}  // namespace fathom
