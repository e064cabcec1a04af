#include <algorithm>
#include <array>
#include <vector>

#include "surface/cut_cluster.h"
#include "surface/tetrahedra_mesh.h"

namespace fathom {

namespace {

// A sample and the ends of its forward edges, the corners of the six tetrahedra that it owns: corner 0 is the sample,
// corner c the end of forward edge c - 1.
constexpr int kCorners = 1 + kLatticeEdges - kFirstForwardEdge;

constexpr LatticeStep step_to(int corner) {
  return corner == 0 ? LatticeStep{} : kLatticeSteps[static_cast<std::size_t>(kFirstForwardEdge + corner - 1)];
}

// An edge of the tetrahedra, from its first corner to its second in the order of the lattice.
struct OwnEdge {
  std::int8_t first = 0;
  std::int8_t second = 0;
  std::int8_t direction = 0;  // among the edges of the first corner
};

constexpr int kOwnEdges = 19;
constexpr std::array<OwnEdge, kOwnEdges> kOwnEdgeList = [] {
  std::array<OwnEdge, kOwnEdges> list{};
  std::size_t count = 0;
  for (int a = 0; a < kCorners; ++a) {
    for (int b = a + 1; b < kCorners; ++b) {
      const int direction = edge_along(step_to(b) - step_to(a));
      if (direction < 0) continue;
      list[count++] = {static_cast<std::int8_t>(a), static_cast<std::int8_t>(b), static_cast<std::int8_t>(direction)};
    }
  }
  return list;
}();

int own_edge_between(int a, int b) {
  const auto found = std::find_if(kOwnEdgeList.begin(), kOwnEdgeList.end(), [&](const OwnEdge& edge) {
    return edge.first == std::min(a, b) && edge.second == std::max(a, b);
  });
  return static_cast<int>(found - kOwnEdgeList.begin());
}

struct CaseTriangle {
  std::array<std::int8_t, 3> edges{};
  std::uint8_t corners = 0;  // of the tetrahedron that it lies in, as bits
};

// Two in each of the six tetrahedra, and room for one more.
constexpr std::size_t kMostTriangles = 13;

// What to draw for a set of inside corners.
struct Case {
  std::vector<CaseTriangle> triangles;
  std::vector<std::int8_t> edges;  // that the triangles use
};

// Even permutations of a tetrahedron's corners that bring one corner, or two, to the front.
constexpr std::array<std::array<int, 4>, 4> kOneFirst = {{{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};
constexpr std::array<int, 4> pair_first(unsigned inside) {
  switch (inside) {
    case 0b0011:
      return {0, 1, 2, 3};
    case 0b0101:
      return {0, 2, 3, 1};
    case 0b1001:
      return {0, 3, 1, 2};
    case 0b0110:
      return {1, 2, 0, 3};
    case 0b1010:
      return {1, 3, 2, 0};
    default:
      return {2, 3, 0, 1};
  }
}

// The triangles between inside and outside in a positive tetrahedron: `add` gets three times two of its corners, of
// the edges that are cut. `inside` has a bit for each corner.
template <typename Add>
void cut_tetrahedron(unsigned inside, const Add& add) {
  const int count = std::popcount(inside);
  if (count == 0 || count == 4) return;
  const unsigned lone = count == 1 ? inside : ~inside & 0xFU;
  const std::array<int, 4> order =
      count == 2 ? pair_first(inside) : kOneFirst[static_cast<std::size_t>(std::countr_zero(lone)) & 3U];
  const auto edge = [&order](std::size_t i, std::size_t j) {
    return std::array<std::size_t, 2>{static_cast<std::size_t>(order[i]), static_cast<std::size_t>(order[j])};
  };
  if (count == 2) {
    add(edge(0, 2), edge(0, 3), edge(1, 3));
    add(edge(0, 2), edge(1, 3), edge(1, 2));
  } else if (count == 1) {
    add(edge(0, 1), edge(0, 2), edge(0, 3));
  } else {
    add(edge(0, 1), edge(0, 3), edge(0, 2));
  }
}

void add_tetrahedron(const std::array<int, 4>& corners, unsigned inside_corners, Case& result) {
  unsigned inside = 0;
  std::uint8_t all = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    inside |= (inside_corners >> corners[i] & 1U) << i;
    all = static_cast<std::uint8_t>(all | 1U << corners[i]);
  }
  const auto name = [&corners](const std::array<std::size_t, 2>& ends) {
    return static_cast<std::int8_t>(own_edge_between(corners[ends[0]], corners[ends[1]]));
  };
  cut_tetrahedron(inside, [&](const auto& a, const auto& b, const auto& c) {
    result.triangles.push_back({{name(a), name(b), name(c)}, all});
  });
}

std::vector<Case> make_cases() {
  std::vector<Case> cases(1U << kCorners);
  for (unsigned inside = 0; inside < cases.size(); ++inside) {
    Case& result = cases[inside];
    for (const auto& own : kOwnTetrahedra) {
      add_tetrahedron(
          {0, own[0] - kFirstForwardEdge + 1, own[1] - kFirstForwardEdge + 1, own[2] - kFirstForwardEdge + 1}, inside,
          result);
    }
    for (std::int8_t e = 0; e < kOwnEdges; ++e) {
      const bool used = std::any_of(result.triangles.begin(), result.triangles.end(), [e](const CaseTriangle& t) {
        return t.edges[0] == e || t.edges[1] == e || t.edges[2] == e;
      });
      if (used) result.edges.push_back(e);
    }
  }
  return cases;
}

// Goes along the cuts of a row, forward only.
class RowCursor {
 public:
  RowCursor(const CutLayer& layer, int row) {
    if (row < 0 || row >= layer.samples->rows) return;
    at_ = layer.cuts.data() + layer.row_begin[static_cast<std::size_t>(row)];
    end_ = layer.cuts.data() + layer.row_begin[static_cast<std::size_t>(row) + 1];
  }

  void forward_to(int column) {
    while (at_ != end_ && at_->column < column) ++at_;
  }
  // The sample at a column not before that of the last forward_to and not more than one after it; null if not cut.
  const CutSample* find(int column) const {
    const CutSample* here = at_;
    if (here != end_ && here->column < column) ++here;
    return here != end_ && here->column == column ? here : nullptr;
  }

 private:
  const CutSample* at_ = nullptr;
  const CutSample* end_ = nullptr;
};

// The corners of a sample's tetrahedra that are in the stack, and those of them that are in the same flat side as the
// sample: tetrahedra of these alone are none.
struct Corners {
  std::uint8_t there = 0xFF;
  std::uint8_t in_face = 0;
};

Corners corners_at(const CutLayer& layer, const CutSample& sample) {
  Corners corners{1, 0};
  const bool on_face = sample.link != Link::kInner;
  if (on_face) corners.in_face = 1;
  for (int corner = 1; corner < kCorners; ++corner) {
    const int edge = kFirstForwardEdge + corner - 1;
    const EdgeEnd end = edge_end(layer, sample.row, sample.column, edge);
    if (end.row < 0 || end.row >= layer.samples->rows || end.column < 0 || end.column >= layer.samples->columns) {
      continue;
    }
    const auto bit = static_cast<std::uint8_t>(1U << corner);
    corners.there |= bit;
    if (on_face && step_along(layer, sample.row, sample.column, edge) == 0) corners.in_face |= bit;
  }
  return corners;
}

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

void add_triangles(const CutLayer& layer, const CutLayer& above, LayerMesh& mesh) {
  static const std::vector<Case> cases = make_cases();
  const int rows = layer.samples->rows;
  const int columns = layer.samples->columns;
  const std::int32_t own_vertices = layer.vertices;
  for (int j = 0; j < rows; ++j) {
    const auto begin = static_cast<std::size_t>(layer.row_begin[static_cast<std::size_t>(j)]);
    const auto end = static_cast<std::size_t>(layer.row_begin[static_cast<std::size_t>(j) + 1]);
    if (begin == end) continue;
    RowCursor next_row(layer, j + 1);
    std::array<RowCursor, 3> above_rows = {RowCursor(above, j - 1), RowCursor(above, j), RowCursor(above, j + 1)};
    const int shift = layer.shifted(j) ? 0 : -1;  // from the column to that of the end on the left, one row on
    for (std::size_t s = begin; s < end; ++s) {
      const CutSample& sample = layer.cuts[s];
      const auto other_side = static_cast<unsigned>(sample.cut >> kFirstForwardEdge) << 1;
      const bool centre_inside =
          (layer.inside[static_cast<std::size_t>(j * layer.words + sample.column / 64)] >> (sample.column % 64) & 1U) !=
          0;
      const Case& found = cases[centre_inside ? ~other_side & 0xFFU : other_side];
      if (found.triangles.empty()) continue;

      const int column = sample.column;
      const int left = column + shift;
      next_row.forward_to(left);
      above_rows[0].forward_to(column);
      above_rows[1].forward_to(left);
      above_rows[2].forward_to(column);
      // In the order of the forward edges.
      const std::array<const CutSample*, kCorners> corner = {
          &sample,
          s + 1 < end && layer.cuts[s + 1].column == column + 1 ? &layer.cuts[s + 1] : nullptr,
          next_row.find(left),
          next_row.find(left + 1),
          above_rows[0].find(column),
          above_rows[1].find(left),
          above_rows[1].find(left + 1),
          above_rows[2].find(column)};
      constexpr std::array<int, kCorners> kAbove = {0, 0, 0, 0, 1, 1, 1, 1};

      const bool border = j == 0 || j + 1 == rows || column == 0 || column + 1 == columns;
      const Corners at = border ? corners_at(layer, sample) : Corners{};
      std::array<std::int32_t, kOwnEdges> vertex{};
      for (const std::int8_t e : found.edges) {
        const OwnEdge& edge = kOwnEdgeList[static_cast<std::size_t>(e)];
        const auto first = static_cast<std::size_t>(edge.first);
        const auto second = static_cast<std::size_t>(edge.second);
        if (border) {
          if (((at.there >> first & at.there >> second) & 1) == 0) continue;
          if (!has_edge(corner[first]->cut, edge.direction)) continue;  // of a flat tetrahedron
        }
        const bool near_first = has_edge(corner[first]->near, edge.direction);
        const std::size_t near = near_first ? first : second;
        const CutSample& owner = *corner[near];
        const std::int32_t number = owner.single
                                        ? owner.first_vertex
                                        : vertex_of(owner, near_first ? edge.direction : opposite_edge(edge.direction));
        vertex[static_cast<std::size_t>(e)] = kAbove[near] != 0 ? own_vertices + number : number;
      }
      // Three in four vanish where vertices are clustered, and not in a way that a processor could foresee.
      std::array<Mesh::Triangle, kMostTriangles> triangles;
      std::size_t count = 0;
      for (const CaseTriangle& triangle : found.triangles) {
        const std::int32_t a = vertex[static_cast<std::size_t>(triangle.edges[0])];
        const std::int32_t b = vertex[static_cast<std::size_t>(triangle.edges[1])];
        const std::int32_t c = vertex[static_cast<std::size_t>(triangle.edges[2])];
        triangles[count] = {a, b, c};
        const bool drawn = (a != b) & (b != c) & (c != a) & ((triangle.corners & ~at.there) == 0) &
                           ((triangle.corners & ~at.in_face) != 0);
        count += drawn ? 1 : 0;
      }
      mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.begin() + count);
    }
  }
}

void add_side_caps(const CutLayer& layer, const CutLayer& above, LayerMesh& mesh) {
  for (const bool high : {false, true}) {
    for (int j = 0; j + 1 < layer.samples->rows; ++j) add_cap(SideSquare(layer, above, j, high), mesh);
  }
}

}  // namespace fathom
