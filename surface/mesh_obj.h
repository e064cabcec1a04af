#pragma once

#include "core/atomic_file.h"
#include "core/progress.h"
#include "surface/mesh.h"
#include "surface/mesh_source.h"

namespace fathom {

/// Reads a Wavefront OBJ file: v, vn and f, whose corners are v, v/vt, v//vn or v/vt/vn, counted from 1 or, where
/// negative, from the last one back. Everything else, such as groups and materials, is passed over. Normals are kept if
/// each vertex has one, the same in all of its faces. Throws Error.
Mesh read_obj(MeshSource& source);

/// Writes v, vn and f with as many digits as bring every number back. The file is not committed. `mesh` must be valid.
/// Throws Error; Cancelled.
void write_obj(const Mesh& mesh, AtomicFile& file, const Progress& progress);

}  // namespace fathom
