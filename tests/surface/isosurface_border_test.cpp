#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "surface/mesh_measure.h"
#include "surface/mesh_quality.h"
#include "tests/surface/isosurfaces.h"

// Surfaces that run into the faces of a volume or box.
namespace fathom {
namespace {

using namespace isosurfaces;

constexpr double kHalfMm = 5.0;

// Outward, of the six faces of a box.
Eigen::Vector3d face_normal(int face) { return (face % 2 == 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(face / 2); }

// A ball of radius 4 in cube(5), cut by a face 0.63 beyond its centre, and what is left of it.
constexpr double kRadiusMm = 4.0;
constexpr double kDepthMm = 0.63;

PointField cut_ball(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d aside(0.11, 0.23, -0.17);
  return ball((kHalfMm - kDepthMm) * normal + aside - normal.dot(aside) * normal, kRadiusMm);
}

constexpr double kRestMm3 =
    kPi * (kRadiusMm + kDepthMm) * (kRadiusMm + kDepthMm) * (3.0 * kRadiusMm - (kRadiusMm + kDepthMm)) / 3.0;

std::vector<std::array<std::int32_t, 2>> border_edges(const Mesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const Mesh::Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[std::minmax(t[i], t[(i + 1) % 3])];
  }
  std::vector<std::array<std::int32_t, 2>> border;
  for (const auto& [edge, count] : edges) {
    if (count == 1) border.push_back({edge.first, edge.second});
  }
  return border;
}

double distance_to_faces(const Eigen::Vector3d& place_mm) {
  return (kHalfMm - place_mm.array().abs()).abs().minCoeff();
}

TEST(IsosurfaceBorder, VolumeOfABallCutByAnyFaceConvergesWithTheSquareOfTheSpacing) {
  for (const Mesher mesher : kMeshers) {
    std::vector<double> fine_errors;
    for (int face = 0; face < 6; ++face) {
      const auto error = [&](double spacing_mm) {
        IsosurfaceOptions options = options_for(mesher, spacing_mm);
        options.cap = true;
        const Mesh mesh = isosurface(cut_ball(face_normal(face)), cube(kHalfMm), options);
        expect_sound(mesh);
        EXPECT_TRUE(mesh_topology(mesh).closed());
        EXPECT_EQ(mesh_quality(mesh).zero_area_triangles, 0);
        return volume_mm3(mesh) / kRestMm3 - 1.0;
      };
      const double coarse = error(0.4);
      const double fine = error(0.2);
      EXPECT_LT(std::abs(coarse), 0.0075) << face;
      EXPECT_NEAR(coarse / fine, 4.0, 0.4) << face;
      fine_errors.push_back(fine);
    }
    // No face is worse than another.
    const auto [least, most] = std::ranges::minmax(fine_errors);
    EXPECT_NEAR(least / most, 1.0, 0.05) << static_cast<int>(mesher);
  }
}

TEST(IsosurfaceBorder, OpenSurfacesEndOnTheFaces) {
  constexpr double kSpacingMm = 0.3;
  for (const Mesher mesher : kMeshers) {
    for (const auto placement : {VertexPlacement::kAverage, VertexPlacement::kCurvature}) {
      for (int face = 0; face < 6; ++face) {
        IsosurfaceOptions options = options_for(mesher, kSpacingMm);
        options.mesher.placement = placement;
        const Eigen::Vector3d normal = face_normal(face);
        const Mesh mesh = isosurface(cut_ball(normal), cube(kHalfMm), options);
        expect_sound(mesh);
        EXPECT_EQ(mesh_topology(mesh).euler_characteristic(), 1);
        EXPECT_EQ(mesh_quality(mesh).zero_area_triangles, 0);
        const auto border = border_edges(mesh);
        ASSERT_FALSE(border.empty());
        double length_mm = 0.0;
        for (const auto& [a, b] : border) {
          const Eigen::Vector3d& from = mesh.vertices[static_cast<std::size_t>(a)];
          const Eigen::Vector3d& to = mesh.vertices[static_cast<std::size_t>(b)];
          EXPECT_LT(std::abs(normal.dot(from) - kHalfMm), 1e-6 * kSpacingMm);
          length_mm += (to - from).norm();
        }
        // The rim is a circle, not a zigzag.
        const double circle_mm = 2.0 * kPi * std::sqrt(kRadiusMm * kRadiusMm - kDepthMm * kDepthMm);
        EXPECT_NEAR(length_mm / circle_mm, 1.0, 0.01);
      }
    }
  }
}

// The same in a stored volume, whose faces are the centres of its outermost voxels, in a turned frame.
TEST(IsosurfaceBorder, OfAStoredVolumeEndsAtItsOutermostVoxels) {
  for (const Mesher mesher : {Mesher::kRegularised, Mesher::kTetrahedra}) {
    std::vector<double> errors;
    for (int face = 0; face < 6; ++face) {
      const int sizes[] = {21, 21, 21};
      Volume volume;
      volume.voxels = cv::Mat(3, sizes, CV_32F);
      const PointField field = cut_ball(face_normal(face));
      for (int k = 0; k < 21; ++k) {
        for (int j = 0; j < 21; ++j) {
          for (int i = 0; i < 21; ++i) {
            volume.voxels.at<float>(k, j, i) = static_cast<float>(field(0.5 * Eigen::Vector3d(i - 10, j - 10, k - 10)));
          }
        }
      }
      const Eigen::AngleAxisd turn(0.4, Eigen::Vector3d(1.0, 2.0, -1.0).normalized());
      volume.reference_from_voxel = Eigen::Translation3d(30.0, -70.0, 11.0) * turn * Eigen::Scaling(0.5) *
                                    Eigen::Translation3d(-10.0, -10.0, -10.0);
      const Eigen::Affine3d box_from_reference = (Eigen::Translation3d(30.0, -70.0, 11.0) * turn).inverse();
      IsosurfaceOptions options = options_for(mesher);
      const Mesh open = isosurface(volume, options);
      expect_sound(open);
      for (const auto& [a, b] : border_edges(open)) {
        EXPECT_LT(distance_to_faces(box_from_reference * open.vertices[static_cast<std::size_t>(a)]), 1e-6);
      }
      options.cap = true;
      errors.push_back(volume_mm3(isosurface(volume, options)) / kRestMm3 - 1.0);
    }
    const auto [least, most] = std::ranges::minmax(errors);
    EXPECT_GT(least, -0.02);
    EXPECT_NEAR(least / most, 1.0, 0.03) << static_cast<int>(mesher);
  }
}

// Through the whole box, at any angle: the polygon in which a plane cuts it.
TEST(IsosurfaceBorder, APlaneThroughTheBoxHasTheAreaOfItsCrossSection) {
  const std::vector<Eigen::Vector3d> normals = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0},  {0.0, 0.0, 1.0},
                                                {0.3, 1.0, 0.2}, {0.25, 0.1, 1.0}, {1.0, 0.35, -0.2}};
  for (const Mesher mesher : kMeshers) {
    for (const Eigen::Vector3d& direction : normals) {
      const Eigen::Vector3d normal = direction.normalized();
      const PointField field = [&](const Eigen::Vector3d& p) { return 0.137 - normal.dot(p); };
      const Mesh mesh = isosurface(field, cube(kHalfMm), options_for(mesher, 0.7));
      expect_sound(mesh);
      EXPECT_EQ(mesh_topology(mesh).euler_characteristic(), 1);
      EXPECT_EQ(mesh_quality(mesh).zero_area_triangles, 0);
      for (const auto& [a, b] : border_edges(mesh)) {
        EXPECT_LT(distance_to_faces(mesh.vertices[static_cast<std::size_t>(a)]), 1e-6);
        EXPECT_LT(distance_to_faces(mesh.vertices[static_cast<std::size_t>(b)]), 1e-6);
      }
      // It meets the four faces around its steepest axis only, in a parallelogram.
      const double area_mm2 = 4.0 * kHalfMm * kHalfMm / normal.cwiseAbs().maxCoeff();
      EXPECT_NEAR(fathom::area_mm2(mesh) / area_mm2, 1.0, 2e-6)
          << static_cast<int>(mesher) << ": " << direction.transpose();
    }
  }
}

// Cut in half by each of the faces in turn.
TEST(IsosurfaceBorder, CapsAreFlatOnEveryFace) {
  constexpr double kSpacingMm = 0.25;
  for (const Mesher mesher : kMeshers) {
    for (int face = 0; face < 6; ++face) {
      const double side = face % 2 == 0 ? 1.0 : -1.0;
      const Eigen::Vector3d normal = side * Eigen::Vector3d::Unit(face / 2);
      IsosurfaceOptions options = options_for(mesher, kSpacingMm);
      options.cap = true;
      const Mesh mesh = isosurface(ball(5.0 * normal, 4.0), cube(5.0), options);
      expect_sound(mesh);
      EXPECT_NEAR(volume_mm3(mesh) / (0.5 * ball_mm3(4.0)), 1.0, 0.01) << face;
      for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const double beyond_mm = normal.dot(mesh.vertices[i]) - 5.0;
        EXPECT_LT(beyond_mm, 0.01 * kSpacingMm);
        // The middle of the cap, away from its rim.
        if ((mesh.vertices[i] - 5.0 * normal).norm() > 3.0) continue;
        EXPECT_GT(beyond_mm, -0.01 * kSpacingMm);
        EXPECT_GT(mesh.normals[i].dot(normal), 0.9);
      }
    }
  }
}

TEST(IsosurfaceBorder, OfAFieldThatIsInsideEverywhereIsTheCappedBox) {
  const PointField field = [](const Eigen::Vector3d& p) { return 3.0 + std::sin(p.x()) + std::cos(p.y() + p.z()); };
  const Eigen::AlignedBox3d box_mm(Eigen::Vector3d{1.0, 2.0, 3.0}, Eigen::Vector3d{4.0, 7.0, 10.0});
  for (const Mesher mesher : kMeshers) {
    IsosurfaceOptions options = options_for(mesher, 0.2);
    EXPECT_THROW(isosurface(field, box_mm, options), Error);
    options.cap = true;
    const Mesh mesh = isosurface(field, box_mm, options);
    expect_sound(mesh);
    EXPECT_NEAR(volume_mm3(mesh) / box_mm.volume(), 1.0, 1e-3);
  }
}

}  // namespace
}  // namespace fathom
