#include "surface/cube_mesh.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "surface/layer_geometry.h"
#include "surface/tetrahedra_mesh.h"

namespace fathom {

namespace {

// Corner c of a cube lies at (c & 1, c >> 1 & 1, c >> 2) along columns, rows and layers. Edges run along one axis from
// their lower corner: 4 * axis + the corner's place among the four.
constexpr int kCubeEdges = 12;

constexpr int edge_between(int a, int b) {
  const int low = std::min(a, b);
  const int axis = std::countr_zero(static_cast<unsigned>(a ^ b));
  const int place = axis == 0 ? low >> 1 : axis == 1 ? (low & 1) | (low >> 1 & 2) : low & 3;
  return 4 * axis + place;
}

// The faces' corners in a circle, counter-clockwise seen from outside.
constexpr std::array<std::array<int, 4>, 6> kFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

// The triangles of a case: edges, three by three, counter-clockwise seen from outside of the surface.
struct CubeCase {
  int count = 0;  // of triangles
  std::array<std::int8_t, 3 * 12> edges{};
};

// The two faces that an edge lies on.
constexpr std::array<unsigned, kCubeEdges> kFacesOfEdge = [] {
  std::array<unsigned, kCubeEdges> faces{};
  for (std::size_t f = 0; f < kFaces.size(); ++f) {
    for (std::size_t i = 0; i < 4; ++i) {
      faces[static_cast<std::size_t>(edge_between(kFaces[f][i], kFaces[f][(i + 1) % 4]))] |= 1U << f;
    }
  }
  return faces;
}();

// Cuts a loop into triangles so that as few of the lines inside it as possible, in fact none, run along a face of the
// cube: the neighbour beyond that face might draw the same line, which would then belong to four triangles.
void add_polygon(std::span<const int> loop, CubeCase& result) {
  const std::size_t n = loop.size();
  constexpr std::size_t kMost = kCubeEdges;
  std::array<std::array<int, kMost>, kMost> cost{};  // of the part of the loop from i to j
  std::array<std::array<std::size_t, kMost>, kMost> apex{};
  const auto line_cost = [&](std::size_t i, std::size_t j) {
    const bool side = j == i + 1 || (i == 0 && j + 1 == n);
    const auto faces = [&](std::size_t at) { return kFacesOfEdge[static_cast<std::size_t>(loop[at])]; };
    return !side && (faces(i) & faces(j)) != 0 ? 1 : 0;
  };
  for (std::size_t width = 2; width < n; ++width) {
    for (std::size_t i = 0; i + width < n; ++i) {
      const std::size_t j = i + width;
      cost[i][j] = std::numeric_limits<int>::max();
      for (std::size_t k = i + 1; k < j; ++k) {
        const int here = cost[i][k] + cost[k][j] + line_cost(i, k) + line_cost(k, j);
        if (here >= cost[i][j]) continue;
        cost[i][j] = here;
        apex[i][j] = k;
      }
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> parts{{0, n - 1}};
  while (!parts.empty()) {
    const auto [i, j] = parts.back();
    parts.pop_back();
    if (j < i + 2) continue;
    const std::size_t k = apex[i][j];
    const auto at = static_cast<std::size_t>(3 * result.count++);
    result.edges[at] = static_cast<std::int8_t>(loop[i]);
    result.edges[at + 1] = static_cast<std::int8_t>(loop[k]);
    result.edges[at + 2] = static_cast<std::int8_t>(loop[j]);
    parts.emplace_back(i, k);
    parts.emplace_back(k, j);
  }
}

// For each of the 256 sets of inside corners: on every face the line of the surface is drawn around each run of inside
// corners, which gives closed loops of edges; each is cut into triangles.
std::array<CubeCase, 256> make_cases() {
  std::array<CubeCase, 256> cases;
  for (unsigned inside = 0; inside < 256; ++inside) {
    std::array<int, kCubeEdges> next;
    next.fill(-1);
    for (const auto& face : kFaces) {
      for (std::size_t i = 0; i < 4; ++i) {
        const auto in = [&](std::size_t at) { return (inside >> face[at % 4] & 1U) != 0; };
        if (!in(i) || in(i + 3)) continue;
        // A run of inside corners begins at i, entered over the edge before it, and is left over the edge behind it.
        std::size_t end = i;
        while (in(end + 1)) ++end;
        const int entered = edge_between(face[(i + 3) % 4], face[i % 4]);
        const int left = edge_between(face[end % 4], face[(end + 1) % 4]);
        next[static_cast<std::size_t>(entered)] = left;
      }
    }
    CubeCase& result = cases[inside];
    for (int start = 0; start < kCubeEdges; ++start) {
      if (next[static_cast<std::size_t>(start)] < 0) continue;
      std::array<int, kCubeEdges> loop{};
      std::size_t length = 0;
      for (int edge = start; next[static_cast<std::size_t>(edge)] >= 0;) {
        loop[length++] = edge;
        const int following = next[static_cast<std::size_t>(edge)];
        next[static_cast<std::size_t>(edge)] = -1;
        edge = following;
      }
      add_polygon(std::span(loop).first(length), result);
    }
  }
  return cases;
}

class CubeLayer {
 public:
  CubeLayer(const std::array<const SampledLayer*, 4>& layers, const std::array<bool, 4>& beyond)
      : layers_(layers), beyond_(beyond), columns_(layers[1]->columns), rows_(layers[1]->rows) {
    for (std::size_t i = 1; i <= 2; ++i) {
      if (!layers[i]) continue;
      geometry_[i - 1] =
          layer_geometry(*layers[i], real(static_cast<int>(i) - 1), real(static_cast<int>(i) + 1), Lattice::kCubic);
    }
  }

  LayerMesh make() {
    mark(1, own_);
    if (layers_[2]) mark(2, next_);
    add_vertices();
    if (layers_[2]) add_triangles();
    return std::move(mesh_);
  }

 private:
  // Numbers of the vertices on the edges from a sample along columns, rows and layers; -1 where not cut.
  using Numbers = std::vector<std::array<std::int32_t, 3>>;

  const SampledLayer* real(int i) const {
    if (i < 0 || i > 3) return nullptr;
    const auto at = static_cast<std::size_t>(i);
    return beyond_[at] ? nullptr : layers_[at];
  }

  std::size_t place(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  float value(int layer, int row, int column) const {
    return layers_[static_cast<std::size_t>(layer)]->values[place(row, column)];
  }

  // Numbers the cuts of a layer in the order in which its own vertices are made.
  std::int32_t mark(int layer, Numbers& numbers) const {
    numbers.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), {-1, -1, -1});
    std::int32_t count = 0;
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        const bool inside = value(layer, j, i) >= 0.0F;
        auto& here = numbers[place(j, i)];
        if (i + 1 < columns_ && (value(layer, j, i + 1) >= 0.0F) != inside) here[0] = count++;
        if (j + 1 < rows_ && (value(layer, j + 1, i) >= 0.0F) != inside) here[1] = count++;
        if (layer < 3 && layers_[static_cast<std::size_t>(layer) + 1] && (value(layer + 1, j, i) >= 0.0F) != inside) {
          here[2] = count++;
        }
      }
    }
    return count;
  }

  Eigen::Vector3d change(int layer, int row, int column) const {
    const auto difference = [&](float below, float centre, float above, bool has_below, bool has_above) {
      if (has_below && has_above) return 0.5 * (above - below);
      return has_above ? static_cast<double>(above - centre) : has_below ? static_cast<double>(centre - below) : 0.0;
    };
    const float centre = value(layer, row, column);
    const bool left = column > 0, right = column + 1 < columns_, up = row > 0, down = row + 1 < rows_;
    const SampledLayer* below = real(layer - 1);
    const SampledLayer* above = real(layer + 1);
    return {difference(left ? value(layer, row, column - 1) : 0.0F, centre,
                       right ? value(layer, row, column + 1) : 0.0F, left, right),
            difference(up ? value(layer, row - 1, column) : 0.0F, centre, down ? value(layer, row + 1, column) : 0.0F,
                       up, down),
            difference(below ? below->values[place(row, column)] : 0.0F, centre,
                       above ? above->values[place(row, column)] : 0.0F, below != nullptr, above != nullptr)};
  }

  void add_vertices() {
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        const auto& here = own_[place(j, i)];
        if (here[0] >= 0) add_vertex(j, i, 1, j, i + 1);
        if (here[1] >= 0) add_vertex(j, i, 1, j + 1, i);
        if (here[2] >= 0) add_vertex(j, i, 2, j, i);
      }
    }
  }

  void add_vertex(int row, int column, int other_layer, int other_row, int other_column) {
    const double a = value(1, row, column);
    const double b = value(other_layer, other_row, other_column);
    const double t = std::clamp(a / (a - b), double{kLeastCut}, 1.0 - kLeastCut);
    const LayerGeometry& from = geometry_[0];
    const LayerGeometry& to = geometry_[static_cast<std::size_t>(other_layer - 1)];
    mesh_.vertices.push_back((1.0 - t) * from.at(column, row) + t * to.at(other_column, other_row));
    const bool from_beyond = beyond_[1];
    const bool to_beyond = beyond_[static_cast<std::size_t>(other_layer)];
    if (from_beyond || to_beyond) {
      // A cap: its plane says what is outside.
      mesh_.normals.push_back(
          (from_beyond ? to : from).outward(Eigen::Vector3d(0.0, 0.0, from_beyond ? 1.0 : -1.0), column, row));
      return;
    }
    mesh_.normals.push_back(from.outward(
        (1.0 - t) * change(1, row, column) + t * change(other_layer, other_row, other_column), column, row));
  }

  // The number of the vertex on an edge of the cube at (row, column), counted through this layer and the next.
  std::int32_t vertex(int row, int column, int edge) const {
    const int axis = edge / 4;
    const int at = edge % 4;
    int i = column, j = row;
    bool upper = false;
    switch (axis) {
      case 0:
        j += at & 1;
        upper = (at & 2) != 0;
        break;
      case 1:
        i += at & 1;
        upper = (at & 2) != 0;
        break;
      default:
        i += at & 1;
        j += at >> 1;
        break;
    }
    const auto axis_index = static_cast<std::size_t>(axis);
    if (!upper) return own_[place(j, i)][axis_index];
    return static_cast<std::int32_t>(mesh_.vertices.size()) + next_[place(j, i)][axis_index];
  }

  void add_triangles() {
    static const std::array<CubeCase, 256> cases = make_cases();
    for (int j = 0; j + 1 < rows_; ++j) {
      for (int i = 0; i + 1 < columns_; ++i) {
        unsigned inside = 0;
        for (int c = 0; c < 8; ++c) {
          inside |= (value(1 + (c >> 2), j + (c >> 1 & 1), i + (c & 1)) >= 0.0F ? 1U : 0U) << c;
        }
        if (inside == 0 || inside == 255) continue;
        const CubeCase& found = cases[inside];
        for (int t = 0; t < found.count; ++t) {
          const auto first = static_cast<std::size_t>(3 * t);
          mesh_.triangles.push_back({vertex(j, i, found.edges[first]), vertex(j, i, found.edges[first + 1]),
                                     vertex(j, i, found.edges[first + 2])});
        }
      }
    }
  }

  const std::array<const SampledLayer*, 4>& layers_;
  const std::array<bool, 4>& beyond_;
  int columns_;
  int rows_;
  std::array<LayerGeometry, 2> geometry_;
  Numbers own_;
  Numbers next_;
  LayerMesh mesh_;
};

}  // namespace

LayerMesh cube_layer(const std::array<const SampledLayer*, 4>& layers, const std::array<bool, 4>& beyond) {
  return CubeLayer(layers, beyond).make();
}

}  // namespace fathom
