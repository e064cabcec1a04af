#include <algorithm>
#include <array>

#include "surface/cut_cluster.h"
#include "surface/tetrahedra_mesh.h"
#include "surface/tetrahedron_cut.h"

namespace fathom {

namespace {

// Four samples of a flat side, of two rows and two layers.
class SideSquare {
 public:
  SideSquare(const CutLayer& layer, const CutLayer& above, int row, bool high)
      : layer_(layer), above_(above), row_(row), column_(high ? layer.samples->columns - 1 : 0), high_(high) {}

  /// What lies between three of these, as corners 0 to 2, and what is outside beyond the side, corner 3.
  void add_triangles_beyond(const std::array<LatticeStep, 3>& corners, LayerMesh& mesh) const {
    unsigned inside = 0;
    for (std::size_t i = 0; i < 3; ++i) inside |= (is_inside(corners[i]) ? 1U : 0U) << i;
    cut_tetrahedron(inside, [&](const auto& a, const auto& b, const auto& c) {
      const Mesh::Triangle triangle = {vertex(corners, a), vertex(corners, b), vertex(corners, c)};
      if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0]) {
        mesh.triangles.push_back(triangle);
      }
    });
  }

  /// The diagonal leads to the next row of the next layer.
  bool rising() const { return face_link(high_, true) == layer_.link(row_, column_); }
  bool high() const { return high_; }

 private:
  const CutLayer& layer_of(const LatticeStep& corner) const { return corner.k != 0 ? above_ : layer_; }
  bool is_inside(const LatticeStep& corner) const { return layer_of(corner).at(row_ + corner.j, column_) >= 0.0F; }
  const CutSample& sample(const LatticeStep& corner) const { return layer_of(corner).cut(row_ + corner.j, column_); }

  std::int32_t vertex(const std::array<LatticeStep, 3>& corners, const std::array<std::size_t, 2>& ends) const {
    std::size_t near = ends[0];
    int edge = -1;
    if (ends[0] == 3 || ends[1] == 3) {
      near = std::min(ends[0], ends[1]);
      edge = link_table(sample(corners[near]).link).beyond;
    } else {
      edge = edge_from(corners[ends[0]], corners[ends[1]]);
      if (!has_edge(sample(corners[near]).near, edge)) {
        near = ends[1];
        edge = opposite_edge(edge);
      }
    }
    const std::int32_t number = vertex_of(sample(corners[near]), edge);
    return corners[near].k != 0 ? layer_.vertices + number : number;
  }

  // In a side, samples that were drawn in and the others are as far apart along the rows as in the lattice.
  int edge_from(const LatticeStep& a, const LatticeStep& b) const {
    const auto drawn_in = [this](const LatticeStep& corner) {
      return sample(corner).link == face_link(high_, false) ? 1 : 0;
    };
    LatticeStep step = b - a;
    step.m = (drawn_in(b) - drawn_in(a)) * (high_ ? 1 : -1);
    return edge_along(step);
  }

  const CutLayer& layer_;
  const CutLayer& above_;
  int row_;
  int column_;
  bool high_;
};

// Corners so ordered that the tetrahedra to what is beyond are positive.
void add_cap(const SideSquare& square, LayerMesh& mesh) {
  constexpr LatticeStep kHere{0, 0, 0}, kNext{0, 1, 0}, kAbove{0, 0, 1}, kBoth{0, 1, 1};
  const auto add = [&](const LatticeStep& a, const LatticeStep& b, const LatticeStep& c) {
    square.add_triangles_beyond(square.high() ? std::array{a, b, c} : std::array{a, c, b}, mesh);
  };
  if (square.rising()) {
    add(kHere, kNext, kBoth);
    add(kHere, kBoth, kAbove);
  } else {
    add(kHere, kNext, kAbove);
    add(kNext, kBoth, kAbove);
  }
}

}  // namespace

void add_side_caps(const CutLayer& layer, const CutLayer& above, LayerMesh& mesh) {
  for (const bool high : {false, true}) {
    for (int j = 0; j + 1 < layer.samples->rows; ++j) add_cap(SideSquare(layer, above, j, high), mesh);
  }
}

}  // namespace fathom
