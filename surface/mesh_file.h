#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "core/atomic_file.h"
#include "core/progress.h"
#include "surface/mesh.h"

namespace fathom {

/// How a mesh is written.
struct MeshWriteOptions {
  /// Red, green, blue from 0 to 255: of the material in VRML. The other formats are written without a colour.
  std::array<std::uint8_t, 3> color = {0x33, 0xcc, 0xff};
};

/// Whether the extension of `path` is that of a mesh: .ply, .stl, .obj, .off or .wrl, in capital or small letters.
bool is_mesh_file(const std::filesystem::path& path);

/// Whether the format that the extension of `path` names keeps the sweep signs of a mesh: .ply only.
bool keeps_sweep_signs(const std::filesystem::path& path);

/// Reads a mesh in the format that the extension names. Polygons become fans of triangles; triangles that name a vertex
/// twice, and so have no area, are left out. Normals are kept where every vertex has one. The file is read in pieces,
/// and memory is taken for what it holds, not for what it claims.
///
/// Throws Error for another extension, and on any fault: a file that is damaged or cut short, numbers that are not
/// finite, indices out of range, more than 2^31 - 1 of anything, whatever require_valid refuses.
Mesh read_mesh(const std::filesystem::path& path);

/// Writes a mesh in the format that the extension names, whole or not at all. Positions, normals and triangles read
/// back as the same numbers, in the same order; except from STL, which holds single precision, no normals of vertices,
/// and finds the vertices again from equal positions. Sweep signs are kept by PLY only.
///
/// Throws Error for another extension, for a mesh that is not valid (see require_valid), for coordinates that STL
/// cannot hold, and when the disk fails; Cancelled.
void write_mesh(const Mesh& mesh, const std::filesystem::path& path, const MeshWriteOptions& options = {},
                const Progress& progress = {});

/// The same into a file that the caller commits, with others that belong to it (AtomicFile::commit_all). The extension
/// of its target names the format.
void write_mesh(const Mesh& mesh, AtomicFile& file, const MeshWriteOptions& options = {},
                const Progress& progress = {});

}  // namespace fathom
