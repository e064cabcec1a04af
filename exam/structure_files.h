#pragma once

#include <filesystem>
#include <vector>

#include "core/atomic_file.h"
#include "core/progress.h"
#include "segmentation/contours.h"
#include "surface/mesh.h"

namespace fathom {

/// Where what is made of each structure goes: of one to `out` itself, of several to files that bear the structures'
/// names before the extension. Throws Error where two would go to the same file.
std::vector<std::filesystem::path> structure_files(const std::filesystem::path& out,
                                                   const std::vector<Structure>& structures);

/// A structure's surface, in its colour. Throws Error as write_mesh; Cancelled.
void write_structure_mesh(const Mesh& mesh, const Structure& structure, AtomicFile& file, const Progress& progress);

}  // namespace fathom
