#include "surface/layer_mesher.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "surface/mesh_check.h"
#include "surface/mesh_measure.h"
#include "surface/mesh_quality.h"
#include "tests/surface/sampled_fields.h"

namespace fathom {
namespace {

using namespace fields;
constexpr double kPi = std::numbers::pi;
constexpr std::array<Mesher, 3> kMeshers = {Mesher::kRegularised, Mesher::kTetrahedra, Mesher::kCubes};

MesherOptions with(Mesher mesher, VertexPlacement placement = VertexPlacement::kAverage, bool cap_ends = false) {
  MesherOptions options;
  options.mesher = mesher;
  options.placement = placement;
  options.cap_ends = cap_ends;
  return options;
}

// No two triangles with the same corners, whichever way round.
bool all_different(const Mesh& mesh) {
  std::vector<Mesh::Triangle> sorted = mesh.triangles;
  for (Mesh::Triangle& triangle : sorted) std::sort(triangle.begin(), triangle.end());
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
}

bool unit_normals(const Mesh& mesh) {
  if (mesh.normals.size() != mesh.vertices.size()) return false;
  for (const Eigen::Vector3d& normal : mesh.normals) {
    if (!(std::abs(normal.norm() - 1.0) < 1e-9)) return false;
  }
  return true;
}

// Of random fields, those of few whole values: cuts lie in the middle and in the third of edges, and three of them in
// one line by chance where all are in the plane of a border or cap.
constexpr int kWholeValues = 4;

// Expects a mesh without fault; `closed` or else with a boundary. `in_line`: triangles without area may be there.
void expect_sound(const Mesh& mesh, bool closed, const std::string& what, bool in_line = false) {
  SCOPED_TRACE(what);
  ASSERT_NO_THROW(require_valid(mesh, what));
  EXPECT_TRUE(unit_normals(mesh));
  if (mesh.triangles.empty()) return;
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
  EXPECT_EQ(topology.unused_vertices, 0);
  if (closed) {
    EXPECT_EQ(topology.boundary_edges, 0);
    if (topology.manifold() && topology.oriented() && topology.boundary_edges == 0) {
      EXPECT_GT(volume_mm3(mesh), 0.0);
    }
  }
  EXPECT_TRUE(all_different(mesh));
  if (!in_line) {
    EXPECT_EQ(mesh_quality(mesh).zero_area_triangles, 0);
  }
}

// Closes a stack at its first and last rows.
void make_far_outside_rows(std::vector<SampledLayer>& stack) {
  for (SampledLayer& layer : stack) {
    std::fill_n(layer.values.begin(), layer.columns, -1e30F);
    std::fill_n(layer.values.end() - layer.columns, layer.columns, -1e30F);
  }
}

void expect_sound_random_meshes(int count) {
  for (int n = 0; n < count; ++n) {
    const int kind = n % kRandomKinds;
    for (const bool open : {false, true}) {
      auto stack = random_stack(kind, Lattice::kBodyCentred, 1000 + static_cast<std::uint64_t>(n));
      if (!open) close_border(stack);
      for (const bool cap : {false, true}) {
        if (cap && !open) continue;
        const std::string what = "field " + std::to_string(n) + (cap ? " capped" : open ? " open" : "");
        const auto placement = n % 4 == 3 ? VertexPlacement::kCurvature : VertexPlacement::kAverage;
        const Mesh rmt = meshed(stack, with(Mesher::kRegularised, placement, cap));
        const Mesh mt = meshed(stack, with(Mesher::kTetrahedra, VertexPlacement::kAverage, cap));
        expect_sound(rmt, !open, what + ", RMT", open && kind == kWholeValues);
        expect_sound(mt, !open, what + ", MT");
        ASSERT_EQ(mesh_topology(rmt).euler_characteristic(), mesh_topology(mt).euler_characteristic()) << what;
        ASSERT_EQ(mesh_topology(rmt).components, mesh_topology(mt).components) << what;
        if (!mt.triangles.empty()) {
          ASSERT_LE(rmt.triangles.size(), mt.triangles.size()) << what;
        }
        if (::testing::Test::HasFailure()) return;
      }
    }
    // Flat sides make the stack half a column narrower.
    auto flat = random_stack(kind, Lattice::kBodyCentred, 1000 + static_cast<std::uint64_t>(n));
    for (SampledLayer& layer : flat) layer.flat_sides = true;
    for (const bool cap : {false, true}) {
      if (cap) make_far_outside_rows(flat);
      const std::string what = "field " + std::to_string(n) + " with flat sides" + (cap ? ", capped" : "");
      const auto placement = n % 4 == 3 ? VertexPlacement::kCurvature : VertexPlacement::kAverage;
      MesherOptions options = with(Mesher::kRegularised, placement, cap);
      options.cap_sides = cap;
      const Mesh rmt = meshed(flat, options);
      options.mesher = Mesher::kTetrahedra;
      const Mesh mt = meshed(flat, options);
      expect_sound(rmt, cap, what + ", RMT", kind == kWholeValues);
      expect_sound(mt, cap, what + ", MT");
      ASSERT_EQ(mesh_topology(rmt).euler_characteristic(), mesh_topology(mt).euler_characteristic()) << what;
      ASSERT_EQ(mesh_topology(rmt).components, mesh_topology(mt).components) << what;
      if (::testing::Test::HasFailure()) return;
    }
    auto cubes = random_stack(kind, Lattice::kCubic, 1000 + static_cast<std::uint64_t>(n));
    close_border(cubes);
    expect_sound(meshed(cubes, Mesher::kCubes), true, "field " + std::to_string(n) + ", MC");
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(LayerMesher, KeepsRandomFieldsClosedManifoldAndOfTheTopologyOfMarchingTetrahedra) {
  expect_sound_random_meshes(60);
}

TEST(LayerMesherStudy, Keeps2000RandomFieldsClosedManifoldAndOfTheTopologyOfMarchingTetrahedra) {
  expect_sound_random_meshes(2000);
}

TEST(LayerMesher, GivesTheSameMeshPieceByPieceAndForAnyNumberOfThreads) {
  const int threads = cv::getNumThreads();
  for (const Mesher mesher : kMeshers) {
    for (int n = 0; n < 12; ++n) {
      const MesherOptions options =
          with(mesher, n % 2 == 0 ? VertexPlacement::kAverage : VertexPlacement::kCurvature, n % 3 == 0);
      const auto stack = random_stack(n, options.lattice(), 70 + static_cast<std::uint64_t>(n));
      const auto layers = pointers(stack);
      const int last = static_cast<int>(stack.size());
      cv::setNumThreads(1);
      const std::vector<LayerMesh> whole = mesh_layers(layers, 0, last, options);
      cv::setNumThreads(2);
      EXPECT_EQ(mesh_layers(layers, 0, last, options), whole);
      cv::setNumThreads(7);
      EXPECT_EQ(mesh_layers(layers, 0, last, options), whole);
      for (const int size : {1, 2, 3}) {
        for (int first = 0; first < last; first += size) {
          const int end = std::min(first + size, last);
          const auto piece = mesh_layers(layers, first, end, options);
          ASSERT_EQ(piece.size(), static_cast<std::size_t>(end - first));
          for (int k = first; k < end; ++k) {
            EXPECT_EQ(piece[static_cast<std::size_t>(k - first)], whole[static_cast<std::size_t>(k)])
                << "layer " << k << " of pieces of " << size;
          }
        }
      }
    }
  }
  cv::setNumThreads(threads);
}

TEST(LayerMesher, DependsOnNoLayerBeyondItsReach) {
  for (const Mesher mesher : kMeshers) {
    const MesherOptions options = with(mesher, VertexPlacement::kCurvature);
    auto stack = random_stack(1, options.lattice(), 5);
    while (stack.size() < 9) stack.push_back(stack[stack.size() - 2]);
    for (std::size_t k = 0; k < stack.size(); ++k) stack[k].origin.z() = static_cast<double>(k);
    const auto before = mesh_layers(pointers(stack), 4, 5, options);
    for (int k = 0; k < static_cast<int>(stack.size()); ++k) {
      if (std::abs(k - 4) <= kLayerReach) continue;
      for (float& value : stack[static_cast<std::size_t>(k)].values) value = 1.0F - 2.0F * value;
    }
    EXPECT_EQ(mesh_layers(pointers(stack), 4, 5, options), before);
  }
}

// A sphere of radius 1, as distance.
double sphere(const Eigen::Vector3d& p) { return 1.0 - p.norm(); }

TEST(LayerMesher, VolumeOfTheSphereConvergesInSecondOrder) {
  const double truth = 4.0 / 3.0 * kPi;
  for (const Mesher mesher : kMeshers) {
    for (const auto placement : {VertexPlacement::kAverage, VertexPlacement::kCurvature}) {
      std::vector<double> errors;
      for (const double spacing : {1.0 / 8.0, 1.0 / 16.0, 1.0 / 32.0}) {
        const MesherOptions options = with(mesher, placement);
        const Mesh mesh =
            meshed(sampled_within(sphere, options.lattice(), spacing, Eigen::Vector3d::Constant(1.0)), options);
        EXPECT_EQ(mesh_topology(mesh).euler_characteristic(), 2);
        errors.push_back(std::abs(volume_mm3(mesh) / truth - 1.0));
      }
      EXPECT_LT(errors[2], 0.005);
      EXPECT_GT(std::log2(errors[0] / errors[1]), 1.7) << static_cast<int>(mesher);
      EXPECT_GT(std::log2(errors[1] / errors[2]), 1.8) << static_cast<int>(mesher);
    }
  }
}

TEST(LayerMesher, NormalsOfTheSpherePointOutwardAlongTheRadius) {
  for (const Mesher mesher : kMeshers) {
    const MesherOptions options = with(mesher);
    const Mesh mesh =
        meshed(sampled_within(sphere, options.lattice(), 1.0 / 16.0, Eigen::Vector3d::Constant(1.0)), options);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      EXPECT_GT(mesh.normals[v].dot(mesh.vertices[v].normalized()), std::cos(1.5 * kPi / 180.0));
    }
  }
}

// A box of a tilted, stretched and shifted lattice holds an ellipsoid; turned and stretched back it is the sphere.
TEST(LayerMesher, WorksInATurnedAndStretchedLatticeFarFromTheOrigin) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  const Eigen::Vector3d axes(3.0, 2.0, 4.5);
  const Eigen::Vector3d centre(120.0, -340.0, 75.0);
  const Field ellipsoid = [&](const Eigen::Vector3d& p) {
    return 1.0 - (turn.transpose() * (p - centre)).cwiseQuotient(axes).squaredNorm();
  };
  for (const Mesher mesher : kMeshers) {
    const MesherOptions options = with(mesher);
    Place place = around_origin(options.lattice(), 0.12, 28, 37, 35);
    const Eigen::Matrix3d frame = turn * axes.asDiagonal();
    place.origin = centre + frame * place.origin + Eigen::Vector3d(0.03, -0.02, 0.05);
    place.steps = frame * place.steps;
    const Mesh mesh = meshed(sampled(ellipsoid, options.lattice(), place, 28, 37, 35), options);
    expect_sound(mesh, true, "ellipsoid");
    EXPECT_NEAR(volume_mm3(mesh) / (4.0 / 3.0 * kPi * axes.prod()), 1.0, 0.02);
    EXPECT_LT((centroid_mm(mesh) - centre).norm(), 0.02);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const Eigen::Vector3d local = turn.transpose() * (mesh.vertices[v] - centre);
      const Eigen::Vector3d normal = turn * local.cwiseQuotient(axes.cwiseProduct(axes)).normalized();
      EXPECT_GT(mesh.normals[v].dot(normal), 0.998);
    }
  }
}

// A cylinder along the layers that leaves the stack at both ends.
TEST(LayerMesher, CapsEndsFlatAndKeepsTheirRim) {
  const Field cylinder = [](const Eigen::Vector3d& p) { return 1.0 - std::hypot(p.x(), p.y()); };
  for (const Mesher mesher : kMeshers) {
    for (const auto placement : {VertexPlacement::kAverage, VertexPlacement::kCurvature}) {
      const MesherOptions options = with(mesher, placement, true);
      const double spacing = 1.0 / 16.0;
      const int layers = 11;
      const int rows = 37;
      const int columns = mesher == Mesher::kCubes ? 37 : 27;
      const Place place = around_origin(options.lattice(), spacing, columns, rows, layers);
      const auto stack = sampled(cylinder, options.lattice(), place, columns, rows, layers);
      const Mesh mesh = meshed(stack, options);
      expect_sound(mesh, true, "cylinder");
      EXPECT_EQ(mesh_topology(mesh).euler_characteristic(), 2);
      const double length = spacing * (layers - 1);
      EXPECT_NEAR(volume_mm3(mesh) / (kPi * length), 1.0, 0.006) << static_cast<int>(mesher);
      const double low = stack.front().origin.z();
      const double high = stack.back().origin.z();
      double top_radius = 0.0;
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Eigen::Vector3d& p = mesh.vertices[v];
        EXPECT_GT(p.z(), low - 1e-4);
        EXPECT_LT(p.z(), high + 1e-4);
        if (p.z() < high - 1e-4) continue;
        const double radius = std::hypot(p.x(), p.y());
        top_radius = std::max(top_radius, radius);
        // In the middle of the cap the plane's normal, on the rim the field's.
        if (radius < 1.0 - 2.0 * spacing) {
          EXPECT_GT(mesh.normals[v].z(), 0.999);
        }
        if (radius > 1.0 - 0.05 * spacing && mesher != Mesher::kCubes) {
          EXPECT_LT(std::abs(mesh.normals[v].z()), 0.02);
        }
      }
      EXPECT_NEAR(top_radius, 1.0, 0.01);
    }
  }
}

TEST(LayerMesher, WithoutCapsIsOpenInThePlanesOfTheEnds) {
  const Field cylinder = [](const Eigen::Vector3d& p) { return 1.0 - std::hypot(p.x(), p.y()); };
  for (const Mesher mesher : kMeshers) {
    const MesherOptions options = with(mesher);
    const int columns = mesher == Mesher::kCubes ? 37 : 27;
    const Place place = around_origin(options.lattice(), 1.0 / 16.0, columns, 37, 9);
    const auto stack = sampled(cylinder, options.lattice(), place, columns, 37, 9);
    const Mesh mesh = meshed(stack, options);
    expect_sound(mesh, false, "cylinder");
    const MeshTopology topology = mesh_topology(mesh);
    EXPECT_GT(topology.boundary_edges, 0);
    EXPECT_EQ(topology.euler_characteristic(), 0);
    const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    EXPECT_NEAR(projected_volume_mm3(mesh, std::span(&axis, 1)) / (kPi * 8.0 / 16.0), 1.0, 0.006);
  }
}

// Layers that turn, come back and lie on each other, as those of a hand-held sweep do.
TEST(LayerMesher, GivesUnitNormalsWhereLayersAreTwistedOrCoincide) {
  for (const Mesher mesher : kMeshers) {
    for (int n = 0; n < 12; ++n) {
      auto stack = random_stack(n, with(mesher).lattice(), 300 + static_cast<std::uint64_t>(n));
      Random random(static_cast<std::uint64_t>(n));
      for (std::size_t k = 0; k < stack.size(); ++k) {
        SampledLayer& layer = stack[k];
        const Eigen::AngleAxisd turn(random.uniform(-1.0, 1.0), Eigen::Vector3d::UnitX());
        layer.column_step = turn * layer.column_step;
        layer.row_step = turn * layer.row_step;
        if (k % 3 != 0) continue;
        const SampledLayer& other = stack[k > 0 ? k - 1 : 0];
        layer.origin = other.origin;
        layer.column_step = other.column_step;
        layer.row_step = other.row_step;
      }
      close_border(stack);
      const Mesh mesh = meshed(stack, mesher);
      EXPECT_TRUE(unit_normals(mesh));
      EXPECT_NO_THROW(require_valid(mesh, "twisted"));
      const MeshTopology topology = mesh_topology(mesh);
      EXPECT_TRUE(topology.manifold() && topology.oriented() && topology.boundary_edges == 0);
    }
  }
}

}  // namespace
}  // namespace fathom
