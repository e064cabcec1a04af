#include "surface/mesh_clip.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/error.h"
#include "surface/convex_clip.h"
#include "surface/fill_rings.h"
#include "surface/mesh_check.h"
#include "surface/plane_sides.h"

namespace fathom {

namespace {

using Plane = Eigen::Hyperplane<double, 3>;

// Whether an edge that starts on the plane is cut in this vertex itself, which can pinch the surface, or in a new one
// at the same place, which gives triangles without area.
enum class Touch { kMerged, kApart };

// Cuts a mesh by one plane. Triangles are walked in the direction in which they count: one with sweep sign -1 reversed.
class PlaneCut {
 public:
  PlaneCut(const ClippedMesh& whole, const Plane& plane, const PlaneSides& sides, Touch touch)
      : whole_(whole.mesh),
        plane_(plane),
        sides_(sides),
        touch_(touch),
        vertices_(whole.mesh.vertices),
        normals_(whole.mesh.normals) {
    for (std::size_t t = 0; t < whole_.triangles.size(); ++t) cut_triangle(t, whole.plane_of[t]);
  }

  // Whether edges that have nothing in common but a vertex on the plane would be joined there.
  bool is_pinched() const { return pinched_; }
  bool has_merged() const { return merged_; }

  void close(int plane) {
    if (next_.empty()) return;
    const std::vector<Mesh::Triangle> cap = fill_rings(rings(), -plane_.normal(), vertices_);
    if (!normals_.empty()) normals_.resize(vertices_.size(), plane_.normal());
    for (const auto& [a, b, c] : cap) {
      const auto at = [&](std::int32_t v) { return vertices_[static_cast<std::size_t>(v)]; };
      const bool backward =
          !whole_.sweep_signs.empty() && (at(b) - at(a)).cross(at(c) - at(a)).dot(plane_.normal()) > 0;
      const std::int8_t sign = backward ? -1 : 1;
      positive_.add({a, b, c}, sign, plane);
      negative_.add({a, c, b}, sign, plane);
    }
  }

  ClippedMesh positive() const { return positive_.finish(*this); }
  ClippedMesh negative() const { return negative_.finish(*this); }

 private:
  struct Part {
    std::vector<Mesh::Triangle> triangles;
    std::vector<std::int8_t> signs;
    std::vector<int> plane_of;

    void add(Mesh::Triangle triangle, std::int8_t sign, int plane) {
      if (sign < 0) std::swap(triangle[1], triangle[2]);
      triangles.push_back(triangle);
      signs.push_back(sign);
      plane_of.push_back(plane);
    }
    ClippedMesh finish(const PlaneCut& cut) const;
  };

  // At most four corners of a part of a triangle.
  struct Piece {
    std::array<std::int32_t, 4> corners{};
    std::size_t size = 0;

    void add(std::int32_t vertex) {
      if (size > 0 && (corners[size - 1] == vertex || corners[0] == vertex)) return;  // merged
      corners[size++] = vertex;
    }
  };

  bool is_positive(std::int32_t v) const { return sides_.positive[static_cast<std::size_t>(v)] != 0; }

  void cut_triangle(std::size_t t, int plane) {
    Mesh::Triangle triangle = whole_.triangles[t];
    const std::int8_t sign = whole_.sweep_signs.empty() ? std::int8_t{1} : whole_.sweep_signs[t];
    if (sign < 0) std::swap(triangle[1], triangle[2]);
    const int count = is_positive(triangle[0]) + is_positive(triangle[1]) + is_positive(triangle[2]);
    if (count == 3) return positive_.add(triangle, sign, plane);
    if (count == 0) return negative_.add(triangle, sign, plane);
    Piece above;
    Piece below;
    std::int32_t leaves = -1;
    std::int32_t enters = -1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = triangle[k];
      const std::int32_t b = triangle[(k + 1) % 3];
      (is_positive(a) ? above : below).add(a);
      if (is_positive(a) == is_positive(b)) continue;
      const std::int32_t at = is_positive(a) ? cut_vertex(a, b) : cut_vertex(b, a);
      (is_positive(a) ? leaves : enters) = at;
      above.add(at);
      below.add(at);
    }
    add_piece(above, sign, plane, positive_);
    add_piece(below, sign, plane, negative_);
    if (leaves == enters) return;
    const auto [found, is_new] = next_.try_emplace(enters, leaves);
    if (!is_new && found->second != leaves) pinched_ = true;
  }

  void add_piece(const Piece& piece, std::int8_t sign, int plane, Part& part) const {
    if (piece.size < 3) return;
    const auto& [a, b, c, d] = piece.corners;
    if (piece.size == 3) return part.add({a, b, c}, sign, plane);
    const auto length = [this](std::int32_t v, std::int32_t w) {
      return (vertices_[static_cast<std::size_t>(v)] - vertices_[static_cast<std::size_t>(w)]).squaredNorm();
    };
    if (length(a, c) <= length(b, d)) {
      part.add({a, b, c}, sign, plane);
      part.add({a, c, d}, sign, plane);
    } else {
      part.add({a, b, d}, sign, plane);
      part.add({b, c, d}, sign, plane);
    }
  }

  std::int32_t cut_vertex(std::int32_t above, std::int32_t below) {
    const auto p = static_cast<std::size_t>(above);
    const auto n = static_cast<std::size_t>(below);
    if (touch_ == Touch::kMerged && sides_.distances_mm[p] == 0.0) {
      merged_ = true;
      return above;
    }
    const auto [found, is_new] =
        cuts_.try_emplace(std::uint64_t{p} << 32 | std::uint64_t{n}, static_cast<std::int32_t>(vertices_.size()));
    if (!is_new) return found->second;
    const double above_mm = sides_.distances_mm[p];
    const double below_mm = sides_.distances_mm[n];
    vertices_.push_back(plane_crossing(whole_.vertices[p], above_mm, whole_.vertices[n], below_mm));
    if (!normals_.empty()) {
      const Eigen::Vector3d between = plane_crossing(whole_.normals[p], above_mm, whole_.normals[n], below_mm);
      normals_.push_back(between.squaredNorm() > 0.0 ? between.normalized() : whole_.normals[p]);
    }
    return found->second;
  }

  // Along the edges of the cut, as the cap of the positive part passes them.
  std::vector<Ring> rings() {
    if (pinched_) {
      throw Error(
          "the surface branches or is turned inside out where a plane cuts it, so that it cannot be closed; "
          "separate the parts that touch there");
    }
    std::vector<std::int32_t> starts;
    for (const auto& [from, to] : next_) starts.push_back(from);
    std::sort(starts.begin(), starts.end());  // whatever the order of the map
    std::vector<Ring> rings;
    for (const std::int32_t start : starts) {
      Ring ring;
      for (auto at = next_.find(start); at != next_.end() && at->second >= 0;) {
        ring.push_back(at->first);
        at = next_.find(std::exchange(at->second, -1));
        if (at == next_.end()) {
          throw Error("the surface is open where a plane cuts it, so that it cannot be closed; close its holes");
        }
      }
      if (ring.empty()) continue;
      rings.push_back(std::move(ring));
    }
    return rings;
  }

  const Mesh& whole_;
  const Plane& plane_;
  const PlaneSides& sides_;
  Touch touch_;
  std::vector<Eigen::Vector3d> vertices_;  // of the whole, then new ones
  std::vector<Eigen::Vector3d> normals_;
  std::unordered_map<std::uint64_t, std::int32_t> cuts_;  // by the ends of the edge
  std::unordered_map<std::int32_t, std::int32_t> next_;   // along the cut
  Part positive_;
  Part negative_;
  bool pinched_ = false;
  bool merged_ = false;
};

ClippedMesh PlaneCut::Part::finish(const PlaneCut& cut) const {
  ClippedMesh part;
  std::vector<std::int32_t> names(cut.vertices_.size(), -1);
  part.plane_of = plane_of;
  part.mesh.triangles = triangles;
  for (const Mesh::Triangle& triangle : triangles) {
    for (const std::int32_t v : triangle) names[static_cast<std::size_t>(v)] = 0;
  }
  for (std::size_t v = 0; v < names.size(); ++v) {
    if (names[v] < 0) continue;
    names[v] = static_cast<std::int32_t>(part.mesh.vertices.size());
    part.mesh.vertices.push_back(cut.vertices_[v]);
    if (!cut.normals_.empty()) part.mesh.normals.push_back(cut.normals_[v]);
  }
  for (Mesh::Triangle& triangle : part.mesh.triangles) {
    for (std::int32_t& v : triangle) v = names[static_cast<std::size_t>(v)];
  }
  if (std::any_of(signs.begin(), signs.end(), [](std::int8_t sign) { return sign < 0; })) part.mesh.sweep_signs = signs;
  return part;
}

bool is_sound(const ClippedMesh& part, Caps caps) {
  if (part.mesh.triangles.empty()) return true;
  const MeshTopology topology = mesh_topology(part.mesh);
  return topology.manifold() && topology.oriented() && (caps == Caps::kOpen || topology.closed());
}

// `keep_negative`: the negative part is wanted as well.
SplitMesh split(ClippedMesh whole, const Plane& plane, int index, Caps caps, bool keep_negative) {
  const PlaneSides sides = plane_sides(whole.mesh, plane);
  const auto is_positive = [](char side) { return side != 0; };
  if (std::all_of(sides.positive.begin(), sides.positive.end(), is_positive)) return {std::move(whole), {}};
  if (std::none_of(sides.positive.begin(), sides.positive.end(), is_positive)) return {{}, std::move(whole)};
  for (const Touch touch : {Touch::kMerged, Touch::kApart}) {
    PlaneCut cut(whole, plane, sides, touch);
    if (touch == Touch::kMerged && cut.is_pinched() && sides.any_touching) continue;
    if (caps == Caps::kClosed) cut.close(index);
    SplitMesh parts{cut.positive(), keep_negative ? cut.negative() : ClippedMesh{}};
    const bool to_check = touch == Touch::kMerged && cut.has_merged();
    if (to_check && !(is_sound(parts.positive, caps) && is_sound(parts.negative, caps))) continue;
    return parts;
  }
  return {};
}

}  // namespace

ClippedMesh clip_mesh(const Mesh& mesh, std::span<const Plane> planes, Caps caps) {
  ClippedMesh part{mesh, std::vector<int>(mesh.triangles.size(), ClippedMesh::kSurface)};
  for (std::size_t k = 0; k < planes.size(); ++k) {
    part = split(std::move(part), planes[k], static_cast<int>(k), caps, false).positive;
  }
  return part;
}

SplitMesh split_mesh(const Mesh& mesh, const Plane& plane, Caps caps) {
  return split({mesh, std::vector<int>(mesh.triangles.size(), ClippedMesh::kSurface)}, plane, 0, caps, true);
}

double cap_area_mm2(const ClippedMesh& part, int plane) {
  double twice = 0.0;
  for (std::size_t t = 0; t < part.plane_of.size(); ++t) {
    if (part.plane_of[t] != plane) continue;
    const auto at = [&](std::size_t k) -> const Eigen::Vector3d& {
      return part.mesh.vertices[static_cast<std::size_t>(part.mesh.triangles[t][k])];
    };
    const double sign = part.mesh.sweep_signs.empty() ? 1.0 : part.mesh.sweep_signs[t];
    twice += sign * (at(1) - at(0)).cross(at(2) - at(0)).norm();
  }
  return 0.5 * twice;
}

}  // namespace fathom
