#pragma once

#include "core/atomic_file.h"
#include "core/progress.h"
#include "surface/mesh.h"
#include "surface/mesh_source.h"

namespace fathom {

/// Reads an STL file, binary or text: the file's length tells which. Corners at exactly equal positions become one
/// vertex, numbered as they come. Normals are not kept: they are those of triangles. Throws Error.
Mesh read_stl(MeshSource& source);

/// Writes binary STL: positions in single precision, so vertices closer than that resolves (1e-5 mm at 100 mm) become
/// one when it is read. The file is not committed. `mesh` must be valid. Throws Error for coordinates beyond single
/// precision; Cancelled.
void write_stl(const Mesh& mesh, AtomicFile& file, const Progress& progress);

}  // namespace fathom
