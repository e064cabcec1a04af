#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "surface/mesh.h"
#include "surface/mesh_source.h"

namespace fathom {

/// Puts together the mesh that a file holds, and refuses what a mesh cannot have.
class MeshBuilder {
 public:
  /// `source` must outlive this object.
  explicit MeshBuilder(const MeshSource& source) : source_(source) {}

  /// Throws Error where the rest of the file is too short for `count` things, named by `what`, of `least_bytes` or
  /// more.
  void require_room(std::uint64_t count, std::uint64_t least_bytes, const char* what) const;

  /// Throws Error beyond 2^31 - 1 vertices.
  void add_vertex(const std::array<double, 3>& position);
  /// Of the next vertex that has none yet.
  void add_normal(const std::array<double, 3>& normal);

  void drop_normals() { mesh_.normals.clear(); }

  /// A polygon as a fan of triangles about its first corner; those that name a vertex twice are left out. The vertices
  /// may follow later in the file. Throws Error for an index that no vertex can have.
  void add_polygon(std::span<const std::int64_t> corners, std::optional<std::int8_t> sweep_sign = std::nullopt);

  std::int64_t vertex_count() const { return static_cast<std::int64_t>(mesh_.vertices.size()); }
  const Mesh& mesh() const { return mesh_; }

  /// Keeps the normals if there is one for each vertex. Throws Error when a triangle names a vertex that there is not,
  /// or the mesh is not valid (see require_valid).
  Mesh finish();

 private:
  const MeshSource& source_;
  Mesh mesh_;
};

}  // namespace fathom
