#include "surface/tetrahedra_mesh.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

int half_columns(const CutLayer& layer, int row, int column) { return 2 * column + (layer.shifted(row) ? 1 : 0); }

const CutLayer* real(const CutLayer* layer) { return layer && !layer->beyond ? layer : nullptr; }

// The change of the field with each step of (m, j, k), by least squares over the edges: the lattice makes the normal
// matrix diagonal. An end that is missing is where the straight line through the sample and the opposite end leads.
Eigen::Vector3d change_at(const CutLayer& layer, const CutLayer* below, const CutLayer* above, int row, int column) {
  Star star = star_of(layer, real(below), real(above), row, column);
  if (star.there != kAllEdges) {
    for (int e = 0; e < kLatticeEdges; ++e) {
      if (has_edge(star.there, e) || !has_edge(star.there, opposite_edge(e))) continue;
      star.value[static_cast<std::size_t>(e)] =
          2.0F * star.centre - star.value[static_cast<std::size_t>(opposite_edge(e))];
    }
  }
  float m = 0.0F;
  float j = 0.0F;
  float k = 0.0F;
  for (std::size_t e = kFirstForwardEdge; e < kLatticeEdges; ++e) {
    const float difference = star.value[e] - star.value[kLatticeEdges - 1 - e];
    m += static_cast<float>(kLatticeSteps[e].m) * difference;
    j += static_cast<float>(kLatticeSteps[e].j) * difference;
    k += static_cast<float>(kLatticeSteps[e].k) * difference;
  }
  return {m / 16.0, j / 8.0, k / 8.0};
}

// The regular lattice, for angles: half a column step is 1, rows and layers are sqrt(2) apart.
Eigen::Vector3d regular(const LatticeStep& step) {
  return {static_cast<double>(step.m), std::sqrt(2.0) * step.j, std::sqrt(2.0) * step.k};
}

// Around an edge lie four or six others, in pairs on opposite sides of it; a pair and the edge span a plane.
// Treece 2000, figure 3.28.
struct EdgePlane {
  int b = 0;
  int c = 0;
  double cos_b = 0.0;  // of the angle between the edge and the neighbour
  double cos_c = 0.0;
  double ratio_b = 0.0;  // length of the edge by that of the neighbour
  double ratio_c = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

struct EdgePlanes {
  int count = 0;
  std::array<EdgePlane, 3> planes;
};

std::array<EdgePlanes, kLatticeEdges> make_edge_planes() {
  std::array<EdgePlanes, kLatticeEdges> all;
  for (int a = 0; a < kLatticeEdges; ++a) {
    const Eigen::Vector3d edge = regular(kLatticeSteps[static_cast<std::size_t>(a)]);
    std::array<int, 6> circle{};
    const EdgeMask next = kNextEdges[static_cast<std::size_t>(a)];
    const int around = std::popcount(next);
    circle[0] = std::countr_zero(next);
    for (int i = 1; i < around; ++i) {
      circle[static_cast<std::size_t>(i)] =
          kLeftOf[static_cast<std::size_t>(a)][static_cast<std::size_t>(circle[static_cast<std::size_t>(i - 1)])];
    }
    EdgePlanes& planes = all[static_cast<std::size_t>(a)];
    planes.count = around / 2;
    for (int i = 0; i < planes.count; ++i) {
      EdgePlane& plane = planes.planes[static_cast<std::size_t>(i)];
      plane.b = circle[static_cast<std::size_t>(i)];
      plane.c = circle[static_cast<std::size_t>(i + planes.count)];
      const Eigen::Vector3d b = regular(kLatticeSteps[static_cast<std::size_t>(plane.b)]);
      const Eigen::Vector3d c = regular(kLatticeSteps[static_cast<std::size_t>(plane.c)]);
      plane.cos_b = edge.dot(b) / (edge.norm() * b.norm());
      plane.cos_c = edge.dot(c) / (edge.norm() * c.norm());
      plane.ratio_b = edge.norm() / b.norm();
      plane.ratio_c = edge.norm() / c.norm();
      plane.normal = edge.cross(b).normalized();
    }
  }
  return all;
}

// A cluster where nothing bends is the plain mean of its cuts; this keeps a cut from counting for nothing beside
// others.
constexpr double kFlatWeight = 0.25;

// The weight of a cut, equations (3.13) to (3.16): 1 / tan(beta / 2) in the plane where the surface bends most.
// `normal` is the surface's in the regular lattice.
double bend_weight(const Star& star, int edge, const Eigen::Vector3d& normal) {
  static const std::array<EdgePlanes, kLatticeEdges> all = make_edge_planes();
  const EdgePlanes& planes = all[static_cast<std::size_t>(edge)];
  const double fall = star.centre - star.value[static_cast<std::size_t>(edge)];
  double most = 0.0;
  for (int i = 0; i < planes.count; ++i) {
    const EdgePlane& plane = planes.planes[static_cast<std::size_t>(i)];
    if (!has_edge(star.there, plane.b) || !has_edge(star.there, plane.c)) continue;
    // Cotangents of the angles that the surface makes with the edge in the two triangles.
    const auto cotangent = [&](int other, double cosine, double ratio) {
      const double relative = (star.centre - star.value[static_cast<std::size_t>(other)]) / fall * ratio;
      return (relative - cosine) / std::sqrt(1.0 - cosine * cosine);
    };
    const double b = cotangent(plane.b, plane.cos_b, plane.ratio_b);
    const double c = cotangent(plane.c, plane.cos_c, plane.ratio_c);
    // |cot(alpha / 2)| with alpha = theta_b + theta_c; 0 where the surface is flat.
    const double bend = std::abs(b + c) / (std::sqrt((1.0 + b * b) * (1.0 + c * c)) - b * c + 1.0);
    const double out_of_plane = normal.dot(plane.normal);
    most = std::max(most, bend * std::sqrt(std::max(0.0, 1.0 - out_of_plane * out_of_plane)));
  }
  return kFlatWeight + most;
}

// Makes the vertices of one sample after the other.
class VertexMaker {
 public:
  VertexMaker(const LayerStar& around, VertexPlacement placement, LayerMesh& mesh)
      : around_(around), layer_(*around.at(0)), placement_(placement), mesh_(mesh) {
    for (int step = -1; step <= 1; ++step) {
      const CutLayer* layer = around.at(step);
      if (!layer) continue;
      const CutLayer* below = step > -2 ? real(around.at(step - 1)) : nullptr;
      const CutLayer* above = real(around.at(step + 1));
      geometry_[static_cast<std::size_t>(step + 1)] = layer_geometry(
          *layer->samples, below ? below->samples : nullptr, above ? above->samples : nullptr, Lattice::kBodyCentred);
    }
  }

  void add(const CutSample& sample) {
    const Star star = star_of(layer_, around_.at(-1), around_.at(1), sample.row, sample.column);
    const double m = half_columns(layer_, sample.row, sample.column);
    const Eigen::Vector3d place = geometry_[1].at(m, sample.row);
    const Eigen::Vector3d change = change_at(layer_, around_.at(-1), around_.at(1), sample.row, sample.column);
    for (EdgeMask rest = sample.near; rest != 0;) {
      const EdgeMask cluster = cluster_of(rest, std::countr_zero(rest));
      rest = static_cast<EdgeMask>(rest & ~cluster);
      if ((cluster & sample.kept) == 0) {
        for (EdgeMask one = cluster; one != 0; one = static_cast<EdgeMask>(one & (one - 1))) {
          add_vertex(sample, star, edge_bit(std::countr_zero(one)), place, change, m);
        }
      } else {
        add_vertex(sample, star, cluster, place, change, m);
      }
    }
  }

 private:
  void add_vertex(const CutSample& sample, const Star& star, EdgeMask cuts, const Eigen::Vector3d& place,
                  const Eigen::Vector3d& change, double m) {
    cuts = bound(sample, cuts);
    const bool weigh = placement_ == VertexPlacement::kCurvature && !std::has_single_bit(cuts);
    const Eigen::Vector3d steepest(change.x(), change.y() / std::sqrt(2.0), change.z() / std::sqrt(2.0));
    const Eigen::Vector3d normal =
        steepest.squaredNorm() > 0.0 ? Eigen::Vector3d(steepest.normalized()) : Eigen::Vector3d::UnitZ();
    double weights = 0.0;
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    Eigen::Vector3d change_sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (EdgeMask rest = cuts; rest != 0; rest = static_cast<EdgeMask>(rest & (rest - 1))) {
      const int e = std::countr_zero(rest);
      const EdgeEnd end = edge_end(layer_, sample.row, sample.column, e);
      const CutLayer& other = *around_.at(end.layer_step);
      const double there = star.value[static_cast<std::size_t>(e)];
      const double t = std::clamp(star.centre / (star.centre - there), kLeastCut, 0.5);
      const double weight = weigh ? bend_weight(star, e, normal) : 1.0;
      const double other_m = half_columns(other, end.row, end.column);
      const LayerGeometry& geometry = geometry_[static_cast<std::size_t>(end.layer_step + 1)];
      shift += weight * t * (geometry.at(other_m, end.row) - place);
      weights += weight;
      ++count;
      change_sum += (1.0 - t) * change;
      change_sum += t * (other.beyond ? change
                                      : change_at(other, around_.at(end.layer_step - 1), around_.at(end.layer_step + 1),
                                                  end.row, end.column));
    }
    mesh_.vertices.push_back(place + shift / weights);
    mesh_.normals.push_back(facing_out(change_sum / count, m, sample));
  }

  // Of a cluster at the border of the lattice, only the cuts within the border count, so that the rim stays there.
  EdgeMask bound(const CutSample& sample, EdgeMask cuts) const {
    const bool end = !real(around_.at(-1)) || !real(around_.at(1));
    const int rows = layer_.samples->rows;
    const bool edge_row = sample.row == 0 || sample.row + 1 == rows;
    if (!end && !edge_row) return cuts;
    EdgeMask within_end = 0;
    EdgeMask within_row = 0;
    for (EdgeMask rest = cuts; rest != 0; rest = static_cast<EdgeMask>(rest & (rest - 1))) {
      const int e = std::countr_zero(rest);
      const LatticeStep& step = kLatticeSteps[static_cast<std::size_t>(e)];
      if (step.k == 0) within_end |= edge_bit(e);
      if (step.j == 0) within_row |= edge_bit(e);
    }
    EdgeMask best = cuts;
    if (end && (best & within_end) != 0) best &= within_end;
    if (edge_row && (best & within_row) != 0) best &= within_row;
    return best;
  }

  Eigen::Vector3d facing_out(const Eigen::Vector3d& change, double m, const CutSample& sample) const {
    // In the middle of a cap the plane, not the field, says what is outside.
    for (const int step : {-1, 1}) {
      const CutLayer* beyond = around_.at(step);
      if (!beyond || !beyond->beyond || !capped_only(sample, step)) continue;
      return geometry_[1].outward(Eigen::Vector3d(0.0, 0.0, -step), m, sample.row);
    }
    return geometry_[1].outward(change, m, sample.row);
  }

  static bool capped_only(const CutSample& sample, int step) {
    for (EdgeMask rest = sample.cut; rest != 0; rest = static_cast<EdgeMask>(rest & (rest - 1))) {
      if (kLatticeSteps[static_cast<std::size_t>(std::countr_zero(rest))].k != step) return false;
    }
    return true;
  }

  const LayerStar& around_;
  const CutLayer& layer_;
  VertexPlacement placement_;
  LayerMesh& mesh_;
  std::array<LayerGeometry, 3> geometry_;
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

// The triangles of the six tetrahedra that one sample owns.
class TriangleMaker {
 public:
  TriangleMaker(const CutLayer& layer, const CutLayer& above, LayerMesh& mesh)
      : layer_(layer), above_(above), mesh_(mesh) {}

  // `star` reaches all forward edges of the sample.
  void add(int row, int column, const Star& star) {
    row_ = row;
    column_ = column;
    star_ = &star;
    for (const auto& own : kOwnTetrahedra) {
      if (!has_edge(star.there, own[0]) || !has_edge(star.there, own[1]) || !has_edge(star.there, own[2])) continue;
      add_tetrahedron({kCentre, own[0], own[1], own[2]});
    }
  }

 private:
  static constexpr int kCentre = -1;

  float value(int corner) const {
    return corner == kCentre ? star_->centre : star_->value[static_cast<std::size_t>(corner)];
  }

  void add_tetrahedron(const std::array<int, 4>& corners) {
    unsigned inside = 0;
    for (std::size_t i = 0; i < 4; ++i) inside |= (value(corners[i]) >= 0.0F ? 1U : 0U) << i;
    const int count = std::popcount(inside);
    if (count == 0 || count == 4) return;
    if (count == 2) {
      const std::array<int, 4> order = pair_first(inside);
      const auto corner = [&](std::size_t i) { return corners[static_cast<std::size_t>(order[i])]; };
      const std::int32_t ac = vertex(corner(0), corner(2));
      const std::int32_t ad = vertex(corner(0), corner(3));
      const std::int32_t bd = vertex(corner(1), corner(3));
      const std::int32_t bc = vertex(corner(1), corner(2));
      add_triangle(ac, ad, bd);
      add_triangle(ac, bd, bc);
      return;
    }
    const unsigned lone = count == 1 ? inside : ~inside & 0xFU;
    const std::array<int, 4>& order = kOneFirst[static_cast<std::size_t>(std::countr_zero(lone))];
    const auto corner = [&](std::size_t i) { return corners[static_cast<std::size_t>(order[i])]; };
    const std::int32_t b = vertex(corner(0), corner(1));
    const std::int32_t c = vertex(corner(0), corner(2));
    const std::int32_t d = vertex(corner(0), corner(3));
    if (count == 1) {
      add_triangle(b, c, d);
    } else {
      add_triangle(b, d, c);
    }
  }

  // The vertex on the edge between two corners, counted through this layer and the next.
  std::int32_t vertex(int a, int b) const {
    if (b < a) std::swap(a, b);  // in the order of the lattice: the centre, then forward edges
    const bool at_a = nearer_to_first(value(a), value(b), true);
    const int near = at_a ? a : b;
    const int far = at_a ? b : a;
    const LatticeStep from = step_to(near);
    const int edge = edge_along(step_to(far) - from);
    EdgeEnd place{row_, column_, 0};
    if (near != kCentre) place = edge_end(layer_, row_, column_, near);
    const CutLayer& layer = place.layer_step == 0 ? layer_ : above_;
    const std::int32_t vertex = vertex_of(layer.cut(place.row, place.column), edge);
    return place.layer_step == 0 ? vertex : layer_.vertices + vertex;
  }

  static LatticeStep step_to(int corner) {
    return corner == kCentre ? LatticeStep{} : kLatticeSteps[static_cast<std::size_t>(corner)];
  }

  void add_triangle(std::int32_t a, std::int32_t b, std::int32_t c) {
    if (a != b && b != c && c != a) mesh_.triangles.push_back({a, b, c});
  }

  const CutLayer& layer_;
  const CutLayer& above_;
  LayerMesh& mesh_;
  int row_ = 0;
  int column_ = 0;
  const Star* star_ = nullptr;
};

}  // namespace

void add_vertices(const LayerStar& around, VertexPlacement placement, LayerMesh& mesh) {
  VertexMaker maker(around, placement, mesh);
  for (const CutSample& sample : around.at(0)->cuts) {
    if (sample.near != 0) maker.add(sample);
  }
}

void add_triangles(const CutLayer& layer, const CutLayer& above, LayerMesh& mesh) {
  TriangleMaker maker(layer, above, mesh);
  for (const CutSample& sample : layer.cuts) {
    maker.add(sample.row, sample.column, star_of(layer, nullptr, &above, sample.row, sample.column));
  }
}

}  // namespace fathom
