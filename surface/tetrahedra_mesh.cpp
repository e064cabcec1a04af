#include "surface/tetrahedra_mesh.h"

#include <algorithm>
#include <cmath>

#include "surface/bend_weight.h"
#include "surface/cut_cluster.h"
#include "surface/star.h"
#include "surface/wall.h"

namespace fathom {

namespace {

const CutLayer* real(const CutLayer* layer) { return layer && !layer->beyond ? layer : nullptr; }

using Vector3 = Eigen::Vector3f;

Vector3 as_vector(const std::array<float, 3>& change) { return {change[0], change[1], change[2]}; }

// In the places of Vector4's steps.
Eigen::Array4f as_array(const Vector3& change) { return {0.0F, change.x(), change.y(), change.z()}; }

// The way in (m, j, k) in which the field changes fastest in the regular lattice, where a half column is 1 and rows and
// layers are sqrt(2) apart.
Vector3 steepest(const Vector3& change) { return {change.x(), 0.5F * change.y(), 0.5F * change.z()}; }

// Of each edge, 1 and its step: what counts of a cut, times its share of the edge.
using Vector4 = Eigen::Array4f;
const std::array<Vector4, kLatticeEdges> kOneAndStep = [] {
  std::array<Vector4, kLatticeEdges> list;
  for (std::size_t e = 0; e < kLatticeEdges; ++e) {
    const LatticeStep& step = kLatticeSteps[e];
    list[e] = {1.0F, static_cast<float>(step.m), static_cast<float>(step.j), static_cast<float>(step.k)};
  }
  return list;
}();

// The sum of the ways from a sample to cuts, by the layers to which their edges lead.
struct CutSum {
  // One below, the same, one above: the share and how far along m, j and k.
  std::array<Vector4, 3> to{Vector4::Zero(), Vector4::Zero(), Vector4::Zero()};

  void add(std::size_t edge, const Vector4& way) { to[static_cast<std::size_t>(kLatticeSteps[edge].k + 1)] += way; }
  void add(const Vector3& way) {
    to[1] += Vector4(0.0F, way.x(), way.y(), 0.0F);
    to[way.z() < 0.0F ? 0U : 2U][0] += std::abs(way.z());
  }
  void scale(float factor) {
    for (Vector4& layer : to) layer *= factor;
  }
  Vector3 in_lattice() const {
    return {to[0][1] + to[1][1] + to[2][1], to[0][2] + to[1][2] + to[2][2], to[2][0] - to[0][0]};
  }
};

// Makes the vertices of one sample after the other.
class VertexMaker {
 public:
  VertexMaker(const LayerStar& around, VertexPlacement placement, LayerMesh& mesh)
      : around_(around),
        layer_(*around.at(0)),
        stars_(layer_, around.at(-1), around.at(1)),
        placement_(placement),
        mesh_(mesh) {
    const CutLayer* below = real(around.at(-1));
    const CutLayer* above = real(around.at(1));
    geometry_ = layer_geometry(*layer_.samples, below ? below->samples : nullptr, above ? above->samples : nullptr,
                               Lattice::kBodyCentred);
    for (const int step : {-1, 1}) {
      const CutLayer* layer = around.at(step);
      if (!layer) continue;
      const SampledLayer& other = *layer->samples;
      way_[static_cast<std::size_t>(step + 1)] = {other.origin - layer_.samples->origin,
                                                  0.5 * (other.column_step - layer_.samples->column_step),
                                                  other.row_step - layer_.samples->row_step};
    }
    parallel_ = geometry_.next_per_m.isZero(0.0) && geometry_.next_per_j.isZero(0.0);
    at_end_ = !below || !above;
    if (parallel_) normal_of_change_ = geometry_.outward_map(0.0, 0.0);
  }

  void add(const CutSample& sample) {
    const Star star = stars_.at(sample.row, sample.column);
    if (sample.single) {
      add_vertex(sample, star, sample.near, true);
      return;
    }
    for (EdgeMask rest = sample.near; rest != 0;) {
      const EdgeMask cluster = first_cluster(rest, sample.link);
      rest = static_cast<EdgeMask>(rest & ~cluster);
      if ((cluster & sample.kept) != 0) {
        add_vertex(sample, star, cluster, true);
        continue;
      }
      for (EdgeMask one = cluster; one != 0; one = static_cast<EdgeMask>(one & (one - 1))) {
        add_vertex(sample, star, edge_bit(std::countr_zero(one)), false);
      }
    }
  }

 private:
  void add_vertex(const CutSample& sample, const Star& star, EdgeMask cuts, bool kept) {
    const bool at_border = at_end_ || sample.row <= 1 || sample.row + 2 >= layer_.samples->rows || sample.column <= 1 ||
                           sample.column + 2 >= layer_.samples->columns;
    if (at_border) {
      const Walls walls(layer_, around_.at(-1), around_.at(1), sample, star);
      place_vertex<true>(sample, star, walls.bound(cuts), kept, walls);
    } else {
      place_vertex<false>(sample, star, cuts, kept, Walls());
    }
  }

  template <bool at_border>
  void place_vertex(const CutSample& sample, const Star& star, EdgeMask cuts, bool kept, const Walls& walls) {
    const Vector3 own_change = as_vector(sample.change);
    const bool weigh = placement_ == VertexPlacement::kCurvature && (cuts & (cuts - 1)) != 0;
    const Eigen::Vector3d normal = weigh ? unit(steepest(own_change)) : Eigen::Vector3d::Zero();
    CutSum sum;
    const Vector4 own = as_array(own_change);
    Vector4 all_changes = Vector4::Zero();
    float weights = 0.0F;
    int count = 0;
    float heights = 0.0F;  // of change . way over all cuts
    const int side_edge = link_table(sample.link).beyond;
    // A cap is where the samples are. Only cuts that all become vertices must differ: half as far as others are at
    // least, since some of these edges lie in the middle of others, and three cuts in line.
    const float cap_cut = kept ? 0.0F : kLeastCut / 2;
    for (EdgeMask rest = cuts; rest != 0; rest = static_cast<EdgeMask>(rest & (rest - 1))) {
      const auto e = static_cast<std::size_t>(std::countr_zero(rest));
      const float there = star.value[e];
      const float t = at_border && there == kFarOutside
                          ? cap_cut
                          : std::clamp(star.centre / (star.centre - there), kLeastCut, 0.5F);
      const Vector4 change = (1.0F - t) * own + t * change_at_end<at_border>(sample, static_cast<int>(e), own);
      all_changes += change;
      ++count;
      Vector4 step = kOneAndStep[e];
      // Samples on flat sides have edges that are shorter than others, and so do their neighbours.
      if (at_border && static_cast<int>(e) != side_edge) {
        step[1] = static_cast<float>(step_along(layer_, sample.row, sample.column, static_cast<int>(e)));
      }
      const Vector4 way = t * step;
      const Vector4 height = change * way;
      heights += height[1] + (height[2] + height[3]);
      if (weigh) {
        const auto weight = static_cast<float>(bend_weight(star, static_cast<int>(e), normal));
        weights += weight;
        sum.add(e, weight * way);
      } else {
        weights += 1.0F;
        sum.add(e, way);
      }
    }
    const Vector3 changes(all_changes[1], all_changes[2], all_changes[3]);
    sum.scale(1.0F / weights);
    if (kRaise && count > 2 && !walls.any()) {
      const float share = 1.0F / static_cast<float>(count);
      const Vector3 mean = share * changes;
      sum.add(raise(share * heights, mean, sum.in_lattice()));
    }
    mesh_.vertices.push_back(place_of(sample, sum));
    mesh_.normals.push_back(normal_of(sample, walls, changes));
  }

  // The change of the field at the end of an edge that is cut; `own` where that end is made up.
  template <bool at_border>
  Vector4 change_at_end(const CutSample& sample, int edge, const Vector4& own) const {
    if (at_border && edge == link_table(sample.link).beyond) return own;
    const EdgeEnd end = edge_end(layer_, sample.row, sample.column, edge);
    const CutSample& other = around_.at(end.layer_step)->cut(end.row, end.column);
    return at_border && other.made_up ? own : as_array(as_vector(other.change));
  }

  static constexpr bool kRaise = true;

  // The mean of cuts in a bent surface lies off it, by half the mean of what the planes through the cuts say.
  static Vector3 raise(float mean_height, const Vector3& change, const Vector3& middle) {
    const Vector3 way = steepest(change);
    const float rise = change.dot(way);
    if (!(rise > 0.0F && std::isfinite(rise))) return Vector3::Zero();
    const Vector3 shift = 0.5F * (mean_height - change.dot(middle)) / rise * way;
    // In noise the planes say anything.
    const float length = std::sqrt(shift.x() * shift.x() + 2.0F * (shift.y() * shift.y() + shift.z() * shift.z()));
    return length > kMostRaise ? Vector3(kMostRaise / length * shift) : shift;
  }

  // Half columns. On smooth surfaces of a radius of two layers and more it is less.
  static constexpr float kMostRaise = 0.25F;

  static Eigen::Vector3d unit(const Vector3& steep) {
    const Eigen::Vector3d way(steep.x(), std::sqrt(2.0) * steep.y(), std::sqrt(2.0) * steep.z());
    return way.squaredNorm() > 0.0 ? Eigen::Vector3d(way.normalized()) : Eigen::Vector3d::UnitZ();
  }

  Eigen::Vector3d place_of(const CutSample& sample, const CutSum& sum) const {
    const double m = layer_.half_columns(sample.row, sample.column);
    const double j = sample.row;
    const Vector3 way_in_lattice = sum.in_lattice();
    Eigen::Vector3d place = geometry_.at(m + double{way_in_lattice.x()}, j + double{way_in_lattice.y()});
    for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
      const Vector4& to = sum.to[i];
      const Way& way = way_[i];
      const double t = to[0];
      place += t * way.origin;
      if (!parallel_) place += (t * m + double{to[1]}) * way.per_m + (t * j + double{to[2]}) * way.per_j;
    }
    return place;
  }

  Eigen::Vector3d normal_of(const CutSample& sample, const Walls& walls, const Vector3& changes) const {
    const double m = layer_.half_columns(sample.row, sample.column);
    Eigen::Vector3d change(changes.x(), changes.y(), changes.z());
    // In the middle of a cap the wall, not the field, says what is outside.
    for (const Wall& wall : walls) {
      if ((sample.cut & ~wall.through) != 0) continue;
      change = {-1.0 * wall.outward.m, -1.0 * wall.outward.j, -1.0 * wall.outward.k};
      break;
    }
    if (parallel_) {
      const Eigen::Vector3d fall = normal_of_change_ * change;
      const double length = fall.norm();
      if (length > 1e-300) return (1.0 / length) * fall;
    }
    return geometry_.outward(change, m, sample.row);
  }

  // From the same place in the lattice of this layer to that of a neighbouring one.
  struct Way {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    Eigen::Vector3d per_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d per_j = Eigen::Vector3d::Zero();
  };

  const LayerStar& around_;
  const CutLayer& layer_;
  Stars stars_;
  VertexPlacement placement_;
  LayerMesh& mesh_;
  LayerGeometry geometry_;
  std::array<Way, 3> way_;
  bool at_end_ = false;
  bool parallel_ = false;  // all three layers have the same steps
  Eigen::Matrix3d normal_of_change_;
};

}  // namespace

void add_vertices(const LayerStar& around, VertexPlacement placement, LayerMesh& mesh) {
  VertexMaker maker(around, placement, mesh);
  for (const CutSample& sample : around.at(0)->cuts) {
    if (sample.near != 0) maker.add(sample);
  }
}

}  // namespace fathom
