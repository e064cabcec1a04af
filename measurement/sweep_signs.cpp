#include "measurement/sweep_signs.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace fathom {

namespace {

void turn(Mesh::Triangle& triangle) { std::swap(triangle[1], triangle[2]); }

}  // namespace

void SweepSigns::add_gap(const SectionPlane& first, const SectionPlane& second, const ContourLattice& lattice,
                         std::span<const std::shared_ptr<const SampledLayer>> layers) {
  Gap gap;
  gap.first = first;
  gap.second = second;
  gap.first_layer = gaps_.empty() ? 0 : gaps_.back().last_layer;
  gap.last_layer = gap.first_layer + layers.size() - 1;
  const Eigen::Vector3d average = (first.normal() + second.normal()).normalized();
  gap.way_mm = (second.origin_mm - first.origin_mm).dot(average);
  gap.way_per_mm = {(second.a_axis - first.a_axis).dot(average), (second.b_axis - first.b_axis).dot(average)};
  for (const int i : {0, lattice.columns}) {
    for (const int j : {0, lattice.rows}) {
      const double way = gap.way_at(lattice.at_mm(i, j));
      gap.forward = gap.forward || way > 0.0;
      gap.backward = gap.backward || way <= 0.0;
    }
  }
  gap.lattice = lattice;
  gap.layers.assign(layers.begin(), layers.end());
  gaps_.push_back(std::move(gap));
}

// Each inside sample stands for its share of the way; at the sections for half a share.
SweepSigns::Passed SweepSigns::passed() const {
  Passed passed;
  for (const Gap& gap : gaps_) {
    const ContourLattice& lattice = gap.lattice;
    const double area_mm2 = lattice.column_step_mm() * lattice.row_step_mm();
    const double share = area_mm2 / static_cast<double>(gap.layers.size() - 1);
    for (std::size_t k = 0; k < gap.layers.size(); ++k) {
      const double weight = (k == 0 || k + 1 == gap.layers.size() ? 0.5 : 1.0) * share;
      const float* value = gap.layers[k]->values.data();
      for (int j = 0; j < lattice.rows; ++j) {
        for (int i = 0; i < lattice.columns; ++i) {
          if (*value++ < 0.0F) continue;
          const double way = gap.way_at(lattice.at_mm(i, j));
          (way > 0.0 ? passed.along_mm3 : passed.against_mm3) += weight * std::abs(way);
        }
      }
    }
  }
  return passed;
}

int SweepSigns::sign_at(const Gap& gap, double u, const Eigen::Vector3d& point_mm) {
  if (!gap.backward) return 1;
  if (!gap.forward) return -1;
  // (a, b) of the point within the layer's plane, by least squares: it may lie a little beside the plane.
  Eigen::Matrix<double, 3, 2> axes;
  axes.col(0) = (1.0 - u) * gap.first.a_axis + u * gap.second.a_axis;
  axes.col(1) = (1.0 - u) * gap.first.b_axis + u * gap.second.b_axis;
  const Eigen::Vector3d origin_mm = (1.0 - u) * gap.first.origin_mm + u * gap.second.origin_mm;
  const Eigen::Matrix2d normal_matrix = axes.transpose() * axes;
  const Eigen::Vector2d ab_mm = normal_matrix.inverse() * (axes.transpose() * (point_mm - origin_mm));
  return gap.way_at(ab_mm) > 0.0 ? 1 : -1;
}

double SweepSigns::apply(std::span<const LayerMesh* const> layers, Mesh& mesh) const {
  assert(!gaps_.empty() && layers.size() == gaps_.back().last_layer + 1);
  const bool all_forward = std::none_of(gaps_.begin(), gaps_.end(), [](const Gap& gap) { return gap.backward; });
  if (all_forward) return 0.0;
  const bool all_backward = std::none_of(gaps_.begin(), gaps_.end(), [](const Gap& gap) { return gap.forward; });
  if (all_backward) {
    for (Mesh::Triangle& triangle : mesh.triangles) turn(triangle);
    return 0.0;
  }
  // Only here does it matter how much was passed either way: to count it, all samples are looked at.
  const auto [along_mm3, against_mm3] = passed();
  const int forward = along_mm3 >= against_mm3 ? 1 : -1;
  mesh.sweep_signs.resize(mesh.triangles.size());
  std::size_t t = 0;
  std::size_t g = 0;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    while (g + 1 < gaps_.size() && k >= gaps_[g].last_layer) ++g;
    const Gap& gap = gaps_[g];
    const double u = std::min(
        1.0, (static_cast<double>(k - gap.first_layer) + 0.5) / static_cast<double>(gap.last_layer - gap.first_layer));
    for (std::size_t i = 0; i < layers[k]->triangles.size(); ++i, ++t) {
      Mesh::Triangle& triangle = mesh.triangles[t];
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const std::int32_t vertex : triangle) middle += mesh.vertices[static_cast<std::size_t>(vertex)] / 3.0;
      const int sign = sign_at(gap, u, middle);
      if (sign < 0) turn(triangle);
      mesh.sweep_signs[t] = static_cast<std::int8_t>(sign * forward);
    }
  }
  const double all_mm3 = along_mm3 + against_mm3;
  return all_mm3 > 0.0 ? std::min(along_mm3, against_mm3) / all_mm3 : 0.0;
}

}  // namespace fathom
