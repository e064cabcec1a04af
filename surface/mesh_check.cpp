#include "surface/mesh_check.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "core/error.h"

namespace fathom {

namespace {

/// Sets of numbers from 0 on that are joined little by little.
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }

  std::uint32_t root(std::uint32_t i) {
    while (parents_[i] != i) {
      parents_[i] = parents_[parents_[i]];
      i = parents_[i];
    }
    return i;
  }

  void join(std::uint32_t i, std::uint32_t j) {
    i = root(i);
    j = root(j);
    if (i < j) {
      parents_[j] = i;
    } else {
      parents_[i] = j;
    }
  }

 private:
  std::vector<std::uint32_t> parents_;
};

// One side of a triangle: from corner `corner` (three times the triangle's index, plus 0 to 2) to the next.
struct Side {
  std::int32_t farther;  // the larger index of its two vertices
  std::uint32_t corner;
};

std::uint32_t next_corner(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

std::int32_t vertex_at(const Mesh& mesh, std::uint32_t corner) { return mesh.triangles[corner / 3][corner % 3]; }

/// The sides of all triangles, those of one edge one after the other.
struct SortedSides {
  std::vector<std::uint32_t> first;  // by the smaller index of an edge's vertices; one more than there are vertices
  std::vector<Side> sides;
};

// Counting by one vertex and sorting the few that are left is several times faster than one sort of everything.
SortedSides sorted_sides(const Mesh& mesh) {
  const auto corners = static_cast<std::uint32_t>(3 * mesh.triangles.size());
  SortedSides sorted;
  sorted.first.assign(mesh.vertices.size() + 1, 0);
  sorted.sides.resize(corners);
  const auto nearer = [&](std::uint32_t corner) {
    return static_cast<std::size_t>(std::min(vertex_at(mesh, corner), vertex_at(mesh, next_corner(corner))));
  };
  for (std::uint32_t corner = 0; corner < corners; ++corner) ++sorted.first[nearer(corner) + 1];
  std::partial_sum(sorted.first.begin(), sorted.first.end(), sorted.first.begin());
  std::vector<std::uint32_t> free(sorted.first.begin(), sorted.first.end() - 1);
  for (std::uint32_t corner = 0; corner < corners; ++corner) {
    sorted.sides[free[nearer(corner)]++] = {std::max(vertex_at(mesh, corner), vertex_at(mesh, next_corner(corner))),
                                            corner};
  }
  for (std::size_t v = 0; v + 1 < sorted.first.size(); ++v) {
    std::sort(sorted.sides.begin() + sorted.first[v], sorted.sides.begin() + sorted.first[v + 1],
              [](const Side& a, const Side& b) {
                return a.farther != b.farther ? a.farther < b.farther : a.corner < b.corner;
              });
  }
  return sorted;
}

bool runs_up(const Mesh& mesh, std::uint32_t corner) {
  return vertex_at(mesh, corner) < vertex_at(mesh, next_corner(corner));
}

bool swept_backward(const Mesh& mesh, std::uint32_t corner) {
  return !mesh.sweep_signs.empty() && mesh.sweep_signs[corner / 3] < 0;
}

// The corners of the two sides of one edge that lie at the same vertex become one fan.
void join_fans(const Mesh& mesh, std::uint32_t a, std::uint32_t b, JoinedSets& fans) {
  const bool same_way = runs_up(mesh, a) == runs_up(mesh, b);
  fans.join(a, same_way ? b : next_corner(b));
  fans.join(next_corner(a), same_way ? next_corner(b) : b);
}

// Sheet 2 t + 0 is the front of triangle t and 2 t + 1 its back; on a surface that cannot be oriented, a walk across
// the edges leads from a front to its own back.
void join_sheets(const Mesh& mesh, std::uint32_t a, std::uint32_t b, JoinedSets& sheets) {
  const std::uint32_t turned = runs_up(mesh, a) == runs_up(mesh, b) ? 1 : 0;
  sheets.join(2 * (a / 3), 2 * (b / 3) + turned);
  sheets.join(2 * (a / 3) + 1, 2 * (b / 3) + 1 - turned);
}

void count_vertices(const Mesh& mesh, JoinedSets& fans, MeshTopology& topology) {
  JoinedSets parts(mesh.vertices.size());
  std::vector<std::uint8_t> fans_at(mesh.vertices.size(), 0);  // 0, 1, or 2 for more
  for (std::uint32_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner) {
    const std::int32_t vertex = vertex_at(mesh, corner);
    parts.join(static_cast<std::uint32_t>(vertex), static_cast<std::uint32_t>(vertex_at(mesh, next_corner(corner))));
    std::uint8_t& count = fans_at[static_cast<std::size_t>(vertex)];
    if (fans.root(corner) == corner && count < 2) ++count;
  }
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    if (fans_at[v] == 0) {
      ++topology.unused_vertices;
      continue;
    }
    ++topology.vertices;
    if (fans_at[v] > 1) ++topology.non_manifold_vertices;
    if (parts.root(v) == v) ++topology.components;
  }
}

std::string of(std::size_t index, const char* what) { return std::string(what) + " " + std::to_string(index); }

}  // namespace

std::optional<int> MeshTopology::genus() const {
  if (!closed() || !manifold() || !orientable) return std::nullopt;
  return components - euler_characteristic() / 2;
}

MeshTopology mesh_topology(const Mesh& mesh) {
  MeshTopology topology;
  topology.triangles = static_cast<int>(mesh.triangles.size());
  JoinedSets fans(3 * mesh.triangles.size());
  JoinedSets sheets(2 * mesh.triangles.size());
  const SortedSides sorted = sorted_sides(mesh);
  for (std::size_t v = 0; v + 1 < sorted.first.size(); ++v) {
    std::uint32_t end = 0;
    for (std::uint32_t begin = sorted.first[v]; begin < sorted.first[v + 1]; begin = end) {
      const Side& side = sorted.sides[begin];
      for (end = begin + 1; end < sorted.first[v + 1] && sorted.sides[end].farther == side.farther; ++end) {
        join_fans(mesh, side.corner, sorted.sides[end].corner, fans);
      }
      ++topology.edges;
      if (end - begin == 1) ++topology.boundary_edges;
      if (end - begin > 2) ++topology.non_manifold_edges;
      if (end - begin != 2) continue;
      const std::uint32_t other = sorted.sides[begin + 1].corner;
      join_sheets(mesh, side.corner, other, sheets);
      const bool up = runs_up(mesh, side.corner) != swept_backward(mesh, side.corner);
      const bool other_up = runs_up(mesh, other) != swept_backward(mesh, other);
      if (up == other_up) ++topology.inconsistent_edges;
    }
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size() && topology.orientable; ++t) {
    topology.orientable = sheets.root(2 * t) != sheets.root(2 * t + 1);
  }
  count_vertices(mesh, fans, topology);
  return topology;
}

void require_valid(const Mesh& mesh, const std::string& name) {
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max() / 3;  // so that corners can be counted
  const auto fail = [&](const std::string& what) { throw Error(name + ": " + what); };
  if (mesh.triangles.size() > kMost || mesh.vertices.size() > 3 * kMost) {
    fail("the mesh has more than " + std::to_string(kMost) + " triangles or as many vertices; make a coarser one");
  }
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.vertices.size()) {
    fail("there are " + std::to_string(mesh.normals.size()) + " normals for " + std::to_string(mesh.vertices.size()) +
         " vertices; give one for each or none");
  }
  if (!mesh.sweep_signs.empty() && mesh.sweep_signs.size() != mesh.triangles.size()) {
    fail("there are " + std::to_string(mesh.sweep_signs.size()) + " sweep signs for " +
         std::to_string(mesh.triangles.size()) + " triangles; give one for each or none");
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!mesh.vertices[v].allFinite()) fail(of(v, "vertex") + " has no finite position; repair the mesh");
    if (!mesh.normals.empty() && !mesh.normals[v].allFinite()) {
      fail("the normal of " + of(v, "vertex") + " is not finite; repair the mesh or leave the normals out");
    }
  }
  const auto count = static_cast<std::int64_t>(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Mesh::Triangle& triangle = mesh.triangles[t];
    for (const std::int32_t vertex : triangle) {
      if (vertex >= 0 && vertex < count) continue;
      fail(of(t, "triangle") + " names vertex " + std::to_string(vertex) + " of " + std::to_string(count) +
           "; the mesh is damaged, write it anew");
    }
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
      fail(of(t, "triangle") + " names a vertex twice; remove such triangles");
    }
    if (!mesh.sweep_signs.empty() && mesh.sweep_signs[t] != 1 && mesh.sweep_signs[t] != -1) {
      fail("the sweep sign of " + of(t, "triangle") + " is " + std::to_string(mesh.sweep_signs[t]) +
           "; it must be 1 or -1");
    }
  }
}

}  // namespace fathom
