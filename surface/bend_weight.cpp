#include "surface/bend_weight.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace fathom {

namespace {

// The regular lattice, for angles: half a column step is 1, rows and layers are sqrt(2) apart.
Eigen::Vector3d regular(const LatticeStep& step) {
  return {static_cast<double>(step.m), std::sqrt(2.0) * step.j, std::sqrt(2.0) * step.k};
}

// Around an edge lie four or six others, in pairs on opposite sides of it; a pair and the edge span a plane.
// Treece 2000, figure 3.28.
struct EdgePlane {
  int b = 0;
  int c = 0;
  // Of the angle between the edge and the neighbour: its cotangent, and the length of the edge by that of the neighbour
  // by its sine.
  double cot_b = 0.0;
  double cot_c = 0.0;
  double ratio_b = 0.0;
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
      plane.cot_b = edge.dot(b) / edge.cross(b).norm();
      plane.cot_c = edge.dot(c) / edge.cross(c).norm();
      plane.ratio_b = edge.squaredNorm() / edge.cross(b).norm();
      plane.ratio_c = edge.squaredNorm() / edge.cross(c).norm();
      plane.normal = edge.cross(b).normalized();
    }
  }
  return all;
}

// A cluster where nothing bends is the plain mean of its cuts; this keeps a cut from counting for nothing beside
// others.
constexpr double kFlatWeight = 0.25;

}  // namespace

double bend_weight(const Star& star, int edge, const Eigen::Vector3d& normal) {
  static const std::array<EdgePlanes, kLatticeEdges> all = make_edge_planes();
  const EdgePlanes& planes = all[static_cast<std::size_t>(edge)];
  const double per_fall = 1.0 / (star.centre - star.value[static_cast<std::size_t>(edge)]);
  double most = 0.0;  // of the squares
  for (int i = 0; i < planes.count; ++i) {
    const EdgePlane& plane = planes.planes[static_cast<std::size_t>(i)];
    if (!has_edge(star.there, plane.b) || !has_edge(star.there, plane.c)) continue;
    // Cotangents of the angles that the surface makes with the edge in the two triangles.
    const auto cotangent = [&](int other, double cot, double ratio) {
      return (star.centre - star.value[static_cast<std::size_t>(other)]) * per_fall * ratio - cot;
    };
    const double b = cotangent(plane.b, plane.cot_b, plane.ratio_b);
    const double c = cotangent(plane.c, plane.cot_c, plane.ratio_c);
    // |cot(alpha / 2)| with alpha = theta_b + theta_c; 0 where the surface is flat.
    const double bend = (b + c) / (std::sqrt((1.0 + b * b) * (1.0 + c * c)) - b * c + 1.0);
    const double out_of_plane = normal.dot(plane.normal);
    most = std::max(most, bend * bend * std::max(0.0, 1.0 - out_of_plane * out_of_plane));
  }
  return kFlatWeight + std::sqrt(most);
}

}  // namespace fathom
