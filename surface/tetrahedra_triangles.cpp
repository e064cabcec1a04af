#include <algorithm>
#include <array>
#include <vector>

#include "surface/cut_cluster.h"
#include "surface/tetrahedra_mesh.h"
#include "surface/tetrahedron_cut.h"

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

}  // namespace fathom
