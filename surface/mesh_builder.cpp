#include "surface/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "surface/mesh_check.h"

namespace fathom {

namespace {

constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();

}  // namespace

void MeshBuilder::require_room(std::uint64_t count, std::uint64_t least_bytes, const char* what) const {
  // Plus one, as the last line of a text may lack its end.
  if (count > (source_.remaining() + 1) / least_bytes) {
    source_.fail("claims " + std::to_string(count) + " " + what + ", more than it has room for (" +
                 std::to_string(source_.remaining()) + " bytes); it was cut short or is damaged: copy it again");
  }
}

void MeshBuilder::add_vertex(const std::array<double, 3>& position) {
  if (vertex_count() == kMost) source_.fail("has more than 2147483647 vertices; make a coarser mesh");
  for (const double x : position) {
    if (!std::isfinite(x)) {
      source_.fail("vertex " + std::to_string(vertex_count()) + " has no finite position; write the mesh anew");
    }
  }
  mesh_.vertices.emplace_back(position[0], position[1], position[2]);
}

void MeshBuilder::add_normal(const std::array<double, 3>& normal) {
  if (mesh_.normals.size() == static_cast<std::size_t>(kMost)) {
    source_.fail("has more than 2147483647 normals; make a coarser mesh");
  }
  mesh_.normals.emplace_back(normal[0], normal[1], normal[2]);
}

void MeshBuilder::add_polygon(std::span<const std::int64_t> corners, std::optional<std::int8_t> sweep_sign) {
  for (const std::int64_t corner : corners) {
    if (corner < 0 || corner >= kMost) {
      source_.fail("a face names vertex " + std::to_string(corner) + ", which cannot be; write the mesh anew");
    }
  }
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const auto a = static_cast<std::int32_t>(corners[0]);
    const auto b = static_cast<std::int32_t>(corners[i - 1]);
    const auto c = static_cast<std::int32_t>(corners[i]);
    if (a == b || b == c || c == a) continue;
    if (mesh_.triangles.size() == static_cast<std::size_t>(kMost)) {
      source_.fail("has more than 2147483647 triangles; make a coarser mesh");
    }
    mesh_.triangles.push_back({a, b, c});
    if (sweep_sign) mesh_.sweep_signs.push_back(*sweep_sign);
  }
}

Mesh MeshBuilder::finish() {
  for (const Mesh::Triangle& triangle : mesh_.triangles) {
    const std::int32_t last = std::max({triangle[0], triangle[1], triangle[2]});
    if (last >= vertex_count()) {
      source_.fail("a face names vertex " + std::to_string(last) + ", counting from 0, but there are only " +
                   std::to_string(vertex_count()) + "; the file is damaged or was cut short: copy it again");
    }
  }
  if (mesh_.normals.size() != mesh_.vertices.size()) mesh_.normals.clear();
  require_valid(mesh_, source_.name());
  return std::move(mesh_);
}

}  // namespace fathom
