#include "surface/mesh_check.h"

#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/surface/shapes.h"

namespace fathom {
namespace {

using namespace shapes;

// What is true of every surface of a solid.
void expect_solid(const MeshTopology& topology, int components, int genus) {
  EXPECT_TRUE(topology.closed());
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
  EXPECT_TRUE(topology.orientable);
  EXPECT_EQ(topology.components, components);
  EXPECT_EQ(topology.genus(), genus);
  EXPECT_EQ(topology.euler_characteristic(), 2 * components - 2 * genus);
  EXPECT_EQ(2 * topology.edges, 3 * topology.triangles);
  EXPECT_EQ(topology.unused_vertices, 0);
}

TEST(MeshTopology, OfSolids) {
  expect_solid(mesh_topology(tetrahedron()), 1, 0);
  expect_solid(mesh_topology(box({0.0, 0.0, 0.0}, {1.0, 2.0, 3.0})), 1, 0);
  expect_solid(mesh_topology(icosphere(10.0, 4)), 1, 0);
  expect_solid(mesh_topology(turned_inside_out(icosphere(10.0, 2))), 1, 0);
  expect_solid(mesh_topology(torus(10.0, 3.0, 40, 20)), 1, 1);
  const MeshTopology sphere = mesh_topology(icosphere(10.0, 4));
  EXPECT_EQ(sphere.triangles, 5120);
  EXPECT_EQ(sphere.vertices, 2562);
  EXPECT_EQ(sphere.edges, 7680);
}

TEST(MeshTopology, CountsComponentsAndTheirHandlesTogether) {
  const Mesh two = joined(torus(10.0, 3.0, 30, 12), icosphere(2.0, 2));
  expect_solid(mesh_topology(two), 2, 1);
  expect_solid(mesh_topology(joined(two, shifted(torus(10.0, 3.0, 9, 7), {40.0, 0.0, 0.0}))), 3, 2);
}

TEST(MeshTopology, CountsVerticesThatNoTriangleNamesApart) {
  Mesh mesh = tetrahedron();
  mesh.vertices.insert(mesh.vertices.begin(), 3, Eigen::Vector3d::Zero());
  for (Mesh::Triangle& triangle : mesh.triangles) {
    for (std::int32_t& vertex : triangle) vertex += 3;
  }
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_EQ(topology.unused_vertices, 3);
  EXPECT_EQ(topology.vertices, 4);
  EXPECT_EQ(topology.components, 1);
  EXPECT_EQ(topology.genus(), 0);
}

TEST(MeshTopology, OfNothingIsNotClosed) {
  EXPECT_FALSE(mesh_topology({}).closed());
  EXPECT_FALSE(mesh_topology({}).genus().has_value());
}

TEST(MeshTopology, SeesAHole) {
  Mesh mesh = icosphere(10.0, 2);
  mesh.triangles.erase(mesh.triangles.begin() + 57);
  MeshTopology topology = mesh_topology(mesh);
  EXPECT_EQ(topology.boundary_edges, 3);
  EXPECT_FALSE(topology.closed());
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
  EXPECT_EQ(topology.euler_characteristic(), 1);
  EXPECT_FALSE(topology.genus().has_value());
  // All triangles around one vertex: that vertex is named no more.
  mesh = icosphere(10.0, 2);
  std::erase_if(mesh.triangles, [](const Mesh::Triangle& t) { return t[0] == 0 || t[1] == 0 || t[2] == 0; });
  topology = mesh_topology(mesh);
  EXPECT_EQ(topology.boundary_edges, 5);
  EXPECT_EQ(topology.unused_vertices, 1);
  EXPECT_TRUE(topology.manifold());
}

TEST(MeshTopology, SeesATriangleThatIsTurnedOver) {
  Mesh mesh = icosphere(10.0, 2);
  std::swap(mesh.triangles[11][0], mesh.triangles[11][1]);
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_EQ(topology.inconsistent_edges, 3);
  EXPECT_FALSE(topology.oriented());
  EXPECT_TRUE(topology.orientable);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.genus(), 0);
}

TEST(MeshTopology, CountsATriangleThatWasSweptBackwardAsReversed) {
  Mesh mesh = icosphere(10.0, 2);
  mesh.sweep_signs.assign(mesh.triangles.size(), 1);
  EXPECT_TRUE(mesh_topology(mesh).oriented());
  mesh.sweep_signs[11] = -1;
  EXPECT_EQ(mesh_topology(mesh).inconsistent_edges, 3);
  std::swap(mesh.triangles[11][0], mesh.triangles[11][1]);
  EXPECT_TRUE(mesh_topology(mesh).oriented());
  mesh.sweep_signs.assign(mesh.triangles.size(), -1);
  EXPECT_EQ(mesh_topology(mesh).inconsistent_edges, 3);
}

TEST(MeshTopology, OfAMoebiusStripHasNoOrientation) {
  const MeshTopology topology = mesh_topology(moebius_strip(15));
  EXPECT_FALSE(topology.orientable);
  EXPECT_GT(topology.inconsistent_edges, 0);
  EXPECT_EQ(topology.euler_characteristic(), 0);
  EXPECT_EQ(topology.boundary_edges, 30);
  EXPECT_TRUE(topology.manifold());
  EXPECT_EQ(topology.components, 1);
}

TEST(MeshTopology, SeesWhereTwoSolidsTouchAtAVertex) {
  Mesh mesh = joined(tetrahedron(), turned_inside_out(tetrahedron()));
  for (std::size_t v = 4; v < 8; ++v) mesh.vertices[v] *= -1.0;
  for (Mesh::Triangle& triangle : mesh.triangles) {
    for (std::int32_t& vertex : triangle) vertex = vertex == 4 ? 0 : vertex;
  }
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_EQ(topology.non_manifold_vertices, 1);
  EXPECT_EQ(topology.non_manifold_edges, 0);
  EXPECT_EQ(topology.components, 1);
  EXPECT_TRUE(topology.closed());
  EXPECT_TRUE(topology.oriented());
  EXPECT_FALSE(topology.manifold());
  EXPECT_FALSE(topology.genus().has_value());
}

TEST(MeshTopology, SeesWhereTwoSolidsTouchAlongAnEdge) {
  Mesh mesh = joined(tetrahedron(), tetrahedron());
  for (Mesh::Triangle& triangle : mesh.triangles) {
    for (std::int32_t& vertex : triangle) vertex = vertex == 4 || vertex == 7 ? vertex - 4 : vertex;
  }
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_EQ(topology.non_manifold_edges, 1);
  EXPECT_EQ(topology.non_manifold_vertices, 0);
  EXPECT_EQ(topology.boundary_edges, 0);
  EXPECT_FALSE(topology.manifold());
}

TEST(RequireValid, AcceptsWhatCanBeComputedWith) {
  Mesh mesh = icosphere(10.0, 2);
  EXPECT_NO_THROW(require_valid(mesh, "a.ply"));
  mesh.normals = mesh.vertices;
  mesh.sweep_signs.assign(mesh.triangles.size(), -1);
  EXPECT_NO_THROW(require_valid(mesh, "a.ply"));
  EXPECT_NO_THROW(require_valid({}, "a.ply"));
}

TEST(RequireValid, NamesTheFileAndTheFault) {
  const auto expect_fault = [](const std::function<void(Mesh&)>& damage, const std::string& words) {
    Mesh mesh = icosphere(10.0, 1);
    damage(mesh);
    try {
      require_valid(mesh, "liver.ply");
      ADD_FAILURE() << "accepted; expected " << words;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find("liver.ply: "), 0u) << error.what();
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  expect_fault([](Mesh& mesh) { mesh.triangles[3][1] = 42; }, "triangle 3 names vertex 42 of 42");
  expect_fault([](Mesh& mesh) { mesh.triangles[79][2] = -1; }, "triangle 79 names vertex -1");
  expect_fault([](Mesh& mesh) { mesh.triangles[5][2] = mesh.triangles[5][0]; }, "triangle 5 names a vertex twice");
  expect_fault([](Mesh& mesh) { mesh.normals.resize(41); }, "41 normals for 42 vertices");
  expect_fault([](Mesh& mesh) { mesh.sweep_signs.assign(81, 1); }, "81 sweep signs for 80 triangles");
  expect_fault([](Mesh& mesh) { mesh.sweep_signs.assign(80, 0); }, "sweep sign of triangle 0 is 0");
  expect_fault([](Mesh& mesh) { mesh.vertices[7].y() = std::numeric_limits<double>::quiet_NaN(); }, "vertex 7");
  expect_fault([](Mesh& mesh) { mesh.vertices[7].x() = std::numeric_limits<double>::infinity(); }, "vertex 7");
  expect_fault(
      [](Mesh& mesh) {
        mesh.normals = mesh.vertices;
        mesh.normals[2].z() = std::numeric_limits<double>::quiet_NaN();
      },
      "normal of vertex 2");
}

}  // namespace
}  // namespace fathom
