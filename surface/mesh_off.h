#pragma once

#include "core/atomic_file.h"
#include "core/progress.h"
#include "surface/mesh.h"
#include "surface/mesh_source.h"

namespace fathom {

/// Reads a text file in Geomview's Object File Format: OFF, or NOFF with a normal behind each position, also COFF and
/// CNOFF, whose colours are passed over; comments from '#' on; one vertex and one face a line. Throws Error.
Mesh read_off(MeshSource& source);

/// Writes OFF, or NOFF where the mesh has normals, with as many digits as bring every number back. The file is not
/// committed. `mesh` must be valid. Throws Error; Cancelled.
void write_off(const Mesh& mesh, AtomicFile& file, const Progress& progress);

}  // namespace fathom
