#include "surface/mesh_clip.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "surface/mesh_check.h"
#include "surface/mesh_measure.h"
#include "surface/mesh_quality.h"
#include "tests/surface/sampled_fields.h"
#include "tests/surface/shapes.h"

namespace fathom {
namespace {

using Plane = Eigen::Hyperplane<double, 3>;

double extent(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex);
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

Plane random_plane(Random& random, const Mesh& mesh) {
  const Eigen::Vector3d normal(random.normal(), random.normal(), random.normal());
  const auto v = static_cast<std::size_t>(random.uniform() * static_cast<double>(mesh.vertices.size()));
  const auto w = static_cast<std::size_t>(random.uniform() * static_cast<double>(mesh.vertices.size()));
  // Half of them through a vertex.
  const double share = random.uniform() < 0.5 ? 1.0 : random.uniform();
  return {normal.normalized(), share * mesh.vertices[v] + (1.0 - share) * mesh.vertices[w]};
}

Mesh bumpy(Random& random) {
  Mesh mesh = shapes::icosphere(10.0, 2);
  const Eigen::Vector3d wave(random.normal(), random.normal(), random.normal());
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex *= 1.0 + 0.4 * std::sin(0.8 * wave.dot(vertex));
  return mesh;
}

Mesh random_mesh(int round, Random& random) {
  Mesh mesh;
  switch (round % 4) {
    case 0:
      mesh = shapes::icosphere(10.0, static_cast<int>(4.0 * random.uniform()));
      break;
    case 1:
      mesh = bumpy(random);
      break;
    case 2:
      mesh = shapes::torus(10.0, random.uniform(1.0, 8.0), 20, 9);
      break;
    default: {
      auto stack = fields::random_stack(round / 4, Lattice::kBodyCentred, static_cast<std::uint64_t>(round));
      fields::close_border(stack);
      mesh = fields::meshed(stack, Mesher::kRegularised);
      mesh.normals.clear();
    }
  }
  if (mesh.triangles.empty()) mesh = shapes::tetrahedron();
  return shapes::moved(std::move(mesh), shapes::random_motion(random, random.uniform(0.0, 100.0)));
}

std::string fault_of(const Mesh& part) {
  require_valid(part, "part");
  const MeshTopology topology = mesh_topology(part);
  if (!topology.closed()) return "is open";
  if (!topology.manifold()) return "is not manifold";
  if (!topology.oriented()) return "is not oriented";
  if (topology.unused_vertices > 0) return "has unused vertices";
  return {};
}

struct Sums {
  double volume = 0.0;
  double size = 0.0;  // of the volumes without regard to sign
  int overlaps = 0;   // caps whose triangles overlap
};

// Cuts a mesh and the parts again by the planes from `first` on.
void add_parts(const Mesh& mesh, std::span<const Plane> planes, Sums& sums) {
  ASSERT_EQ(fault_of(mesh), "");
  if (planes.empty()) {
    sums.volume += volume_mm3(mesh);
    sums.size += std::abs(volume_mm3(mesh));
    return;
  }
  const SplitMesh parts = split_mesh(mesh, planes.front());
  const double scale = std::pow(extent(mesh), 2);
  ASSERT_NEAR(cap_area_mm2(parts.positive, 0), cap_area_mm2(parts.negative, 0), 1e-9 * scale);
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
  for (std::size_t t = 0; t < parts.positive.plane_of.size(); ++t) {
    if (parts.positive.plane_of[t] != 0) continue;
    const auto& [a, b, c] = parts.positive.mesh.triangles[t];
    const auto at = [&](std::int32_t v) { return parts.positive.mesh.vertices[static_cast<std::size_t>(v)]; };
    facing += 0.5 * (at(b) - at(a)).cross(at(c) - at(a));
  }
  if (cap_area_mm2(parts.positive, 0) - facing.dot(-planes.front().normal()) > 1e-6 * scale) ++sums.overlaps;
  for (const ClippedMesh* part : {&parts.positive, &parts.negative}) {
    if (!part->mesh.triangles.empty()) add_parts(part->mesh, planes.subspan(1), sums);
    if (testing::Test::HasFatalFailure()) return;
  }
}

void check_parts(int count) {
  Random random(7);
  int overlaps = 0;
  double worst = 0.0;
  for (int round = 0; round < count; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const Mesh mesh = random_mesh(round, random);
    std::vector<Plane> planes;
    for (int k = round % 6; k >= 0; --k) planes.push_back(random_plane(random, mesh));
    Sums sums;
    add_parts(mesh, planes, sums);
    if (testing::Test::HasFatalFailure()) return;
    const double whole = volume_mm3(mesh);
    worst = std::max(worst, std::abs(sums.volume - whole) / std::max(std::abs(whole), sums.size));
    // Noise gives surfaces that cut themselves.
    const bool is_noise = round % 4 == 3 && round / 4 % fields::kRandomKinds != 0;
    if (!is_noise) overlaps += sums.overlaps;

    // One cell at once is the same as one after another.
    const ClippedMesh cell = clip_mesh(mesh, planes);
    Mesh stepwise = mesh;
    for (const Plane& plane : planes) stepwise = split_mesh(stepwise, plane).positive.mesh;
    ASSERT_EQ(cell.mesh.triangles, stepwise.triangles);
    if (cell.mesh.triangles.empty()) continue;
    ASSERT_EQ(fault_of(cell.mesh), "");
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_EQ(overlaps, 0);
  testing::Test::RecordProperty("worst_in_1e-15", std::to_string(1e15 * worst));
}

TEST(MeshClip, PartsOf200MeshesAddUpToTheWholeAndAreClosed) { check_parts(200); }

TEST(MeshClipStudy, PartsOf1000MeshesAddUpToTheWholeAndAreClosed) { check_parts(1000); }

TEST(MeshClip, BallsHaveTheVolumesOfTheirSegments) {
  const Mesh ball = shapes::icosphere(10.0, 5);
  Random random(3);
  for (int round = 0; round < 10; ++round) {
    const double height = random.uniform(-8.0, 8.0);
    const Eigen::Vector3d normal = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const std::vector<Plane> planes{{normal, -height}};
    const ClippedMesh part = clip_mesh(ball, planes);
    const double h = 10.0 - height;
    EXPECT_NEAR(volume_mm3(part.mesh), std::numbers::pi * h * h * (30.0 - h) / 3.0, 0.002 * 4189.0);
    EXPECT_NEAR(cap_area_mm2(part, 0), std::numbers::pi * (100.0 - height * height), 0.002 * 314.0);
  }
}

TEST(MeshClip, FacesInTwoPlanesShareTheirCorner) {
  const Mesh ball = shapes::icosphere(10.0, 4);
  const std::vector<Plane> planes{{Eigen::Vector3d(1, 0.2, 0).normalized(), -0.3},
                                  {Eigen::Vector3d(0, 1, 0.3).normalized(), 0.4}};
  const ClippedMesh part = clip_mesh(ball, planes);
  ASSERT_EQ(fault_of(part.mesh), "");
  const auto on_both = std::count_if(part.mesh.vertices.begin(), part.mesh.vertices.end(), [&](const auto& vertex) {
    return planes[0].absDistance(vertex) < 1e-9 && planes[1].absDistance(vertex) < 1e-9;
  });
  EXPECT_GE(on_both, 2);
  EXPECT_GT(cap_area_mm2(part, 0), 100.0);
  EXPECT_GT(cap_area_mm2(part, 1), 100.0);
}

TEST(MeshClip, VerticesEdgesAndFacesOnThePlaneLeaveNoTriangleWithoutArea) {
  // An octant of a torus whose vertices lie on all three planes; and a box that is cut along diagonals of its faces.
  const Mesh torus = shapes::torus(5.0, 2.0, 16, 8);
  const std::vector<Plane> octant{
      {Eigen::Vector3d::UnitX(), 0.0}, {Eigen::Vector3d::UnitY(), 0.0}, {Eigen::Vector3d::UnitZ(), 0.0}};
  const ClippedMesh eighth = clip_mesh(torus, octant);
  ASSERT_EQ(fault_of(eighth.mesh), "");
  EXPECT_NEAR(volume_mm3(eighth.mesh), volume_mm3(torus) / 8.0, 1e-9);
  EXPECT_EQ(mesh_quality(eighth.mesh).zero_area_triangles, 0);

  const Mesh box = shapes::box(Eigen::Vector3d::Zero(), Eigen::Vector3d(2, 2, 2));
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(1, -1, 0), Eigen::Vector3d(1, 0, -1), Eigen::Vector3d(0, 1, -1), Eigen::Vector3d(-1, 1, 0)}) {
    const SplitMesh halves = split_mesh(box, {normal.normalized(), 0.0});
    for (const ClippedMesh* half : {&halves.positive, &halves.negative}) {
      ASSERT_EQ(fault_of(half->mesh), "") << normal.transpose();
      EXPECT_NEAR(volume_mm3(half->mesh), 4.0, 1e-12);
      EXPECT_EQ(mesh_quality(half->mesh).zero_area_triangles, 0) << normal.transpose();
    }
  }
}

TEST(MeshClip, AFaceOnThePlaneIsNotCutOff) {
  const Mesh box = shapes::box(Eigen::Vector3d::Zero(), Eigen::Vector3d(2, 2, 2));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      for (const double at : {0.0, 2.0}) {
        const Plane plane(side * Eigen::Vector3d::Unit(axis), -side * at);
        const SplitMesh parts = split_mesh(box, plane);
        const bool keeps = (at == 0.0) == (side > 0.0);
        EXPECT_EQ(parts.positive.mesh.triangles.size(), keeps ? 12u : 0u);
        EXPECT_EQ(parts.negative.mesh.triangles.size(), keeps ? 0u : 12u);
      }
    }
  }
}

TEST(MeshClip, HolesInTheCutStayHoles) {
  // A ball within a ball, turned inside out: a shell.
  const Mesh shell = shapes::joined(shapes::icosphere(10.0, 4), shapes::turned_inside_out(shapes::icosphere(6.0, 3)));
  const SplitMesh parts = split_mesh(shell, {Eigen::Vector3d(1, 2, 3).normalized(), 0.7});
  ASSERT_EQ(fault_of(parts.positive.mesh), "");
  EXPECT_NEAR(cap_area_mm2(parts.positive, 0), std::numbers::pi * (100.0 - 36.0), 3.0);
  EXPECT_NEAR(volume_mm3(parts.positive.mesh) + volume_mm3(parts.negative.mesh), volume_mm3(shell), 1e-9);
  EXPECT_EQ(mesh_topology(parts.positive.mesh).components, 1) << "the cut joins both shells";
}

TEST(MeshClip, WhatWasSweptBackwardCountsNegativeInThePartsToo) {
  Mesh mesh = shapes::joined(shapes::icosphere(10.0, 3), shapes::shifted(shapes::icosphere(4.0, 2), {20, 0, 0}));
  mesh.sweep_signs.assign(mesh.triangles.size(), 1);
  std::fill(mesh.sweep_signs.begin() + 20 * 64, mesh.sweep_signs.end(), std::int8_t{-1});
  const double whole = volume_mm3(mesh);
  const Plane plane(Eigen::Vector3d(0.1, 1, 0.2).normalized(), -1.0);
  const SplitMesh parts = split_mesh(mesh, plane);
  ASSERT_EQ(fault_of(parts.positive.mesh), "");
  ASSERT_EQ(fault_of(parts.negative.mesh), "");
  EXPECT_NEAR(volume_mm3(parts.positive.mesh) + volume_mm3(parts.negative.mesh), whole, 1e-9 * whole);
  EXPECT_NEAR(cap_area_mm2(parts.positive, 0), cap_area_mm2(parts.negative, 0), 1e-9);
  EXPECT_LT(cap_area_mm2(parts.positive, 0), 314.0 - 20.0) << "the small ball's counts negative";
}

TEST(MeshClip, WhereOpenOrBranchingItIsNotClosed) {
  Mesh open = shapes::icosphere(10.0, 2);
  const Plane plane(Eigen::Vector3d::UnitZ(), 0.01);
  // Take away a triangle that the plane cuts.
  const auto cuts = [&](const Mesh::Triangle& t) {
    int above = 0;
    for (const std::int32_t v : t) above += plane.signedDistance(open.vertices[static_cast<std::size_t>(v)]) > 0.0;
    return above == 1;
  };
  open.triangles.erase(std::find_if(open.triangles.begin(), open.triangles.end(), cuts));
  EXPECT_THROW(split_mesh(open, plane), Error);
  const SplitMesh parts = split_mesh(open, plane, Caps::kOpen);
  EXPECT_NEAR(area_mm2(parts.positive.mesh) + area_mm2(parts.negative.mesh), area_mm2(open), 1e-9);
}

TEST(MeshClip, TheProjectedVolumeOfTheOpenPartIsThatOfTheClosedOne) {
  Random random(11);
  int cut_by_two = 0;
  for (int round = 0; round < 60; ++round) {
    const Mesh mesh = random_mesh(round, random);
    std::vector<Plane> planes{random_plane(random, mesh)};
    if (round % 3 != 0) planes.push_back(random_plane(random, mesh));
    if (round % 3 == 2)
      planes[1] =
          Plane(-planes[0].normal(), planes[0].projection(mesh.vertices[0]) + planes[0].normal() * 0.3 * extent(mesh));
    const ClippedMesh closed = clip_mesh(mesh, planes);
    const ClippedMesh open = clip_mesh(mesh, planes, Caps::kOpen);
    if (open.mesh.triangles.empty()) continue;
    std::vector<Eigen::Vector3d> normals;
    for (const Plane& plane : planes) normals.push_back(plane.normal());
    const double projected = projected_volume_mm3(open.mesh, normals);
    const double whole = std::max(std::abs(volume_mm3(mesh)), 1e-3 * std::pow(extent(mesh), 3));
    EXPECT_NEAR(projected, volume_mm3(closed.mesh), 1e-9 * whole) << "round " << round;
    cut_by_two += planes.size() == 2 && cap_area_mm2(closed, 0) > 0.0 && cap_area_mm2(closed, 1) > 0.0;
  }
  EXPECT_GT(cut_by_two, 10);
}

TEST(MeshClip, NormalsOfNewVerticesLieBetweenThoseOfTheEdge) {
  Mesh ball = shapes::icosphere(10.0, 4);
  for (const Eigen::Vector3d& vertex : ball.vertices) ball.normals.push_back(vertex.normalized());
  const std::vector<Plane> planes{{Eigen::Vector3d(1, 2, 3).normalized(), 0.7}};
  const ClippedMesh part = clip_mesh(ball, planes);
  ASSERT_EQ(part.mesh.normals.size(), part.mesh.vertices.size());
  for (std::size_t v = 0; v < part.mesh.vertices.size(); ++v) {
    EXPECT_GT(part.mesh.normals[v].dot(part.mesh.vertices[v].normalized()), 0.999);
  }
}

}  // namespace
}  // namespace fathom
