#include "surface/isosurface.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "core/random.h"
#include "surface/mesh_check.h"
#include "surface/mesh_measure.h"
#include "tests/surface/isosurfaces.h"
#include "tests/surface/shapes.h"

namespace fathom {
namespace {

using namespace isosurfaces;

// The field at the centres of voxels, of OpenCV's type `depth`.
Volume sampled(const PointField& field, const std::array<int, 3>& slices_rows_columns,
               const Eigen::Affine3d& reference_from_voxel, int depth = CV_32F) {
  Volume volume;
  volume.reference_from_voxel = reference_from_voxel;
  volume.voxels = cv::Mat(3, slices_rows_columns.data(), CV_64F);
  for (int k = 0; k < slices_rows_columns[0]; ++k) {
    for (int j = 0; j < slices_rows_columns[1]; ++j) {
      for (int i = 0; i < slices_rows_columns[2]; ++i) {
        volume.voxels.at<double>(k, j, i) = field(reference_from_voxel * Eigen::Vector3d(i, j, k));
      }
    }
  }
  volume.voxels.convertTo(volume.voxels, depth);
  return volume;
}

void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_TRUE(a.vertices == b.vertices);
  EXPECT_TRUE(a.triangles == b.triangles);
  EXPECT_TRUE(a.normals == b.normals);
}

void expect_refused(const std::function<void()>& work, const std::vector<std::string>& words) {
  try {
    work();
    ADD_FAILURE() << "accepted; expected " << words.front();
  } catch (const Error& error) {
    for (const std::string& word : words) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  }
}

TEST(Isosurface, VolumeOfABallConvergesWithTheSquareOfTheSpacing) {
  const Eigen::Vector3d centre_mm(0.13, -0.21, 0.34);
  for (const Mesher mesher : kMeshers) {
    const auto error = [&](double spacing_mm) {
      const Mesh mesh = isosurface(ball(centre_mm, 10.0), cube(12.0), options_for(mesher, spacing_mm));
      expect_sound(mesh);
      return volume_mm3(mesh) / ball_mm3(10.0) - 1.0;
    };
    const double coarse = error(1.0);
    const double fine = error(0.5);
    EXPECT_LT(std::abs(coarse), 0.02);
    EXPECT_NEAR(coarse / fine, 4.0, 0.6);
  }
}

TEST(Isosurface, NormalsPointOutward) {
  const Eigen::Vector3d centre_mm(0.1, 0.2, 0.3);
  for (const Mesher mesher : kMeshers) {
    const Mesh mesh = isosurface(ball(centre_mm, 5.0), cube(6.0), options_for(mesher, 0.5));
    ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      EXPECT_GT(mesh.normals[i].dot((mesh.vertices[i] - centre_mm).normalized()), 0.97);
    }
  }
}

// Origin, anisotropic voxels, rotation, and a ball off the middle, all at once.
TEST(Isosurface, LiesWhereTheVoxelsAre) {
  Random random(3);
  for (const double handedness : {1.0, -1.0}) {
    const Eigen::Affine3d reference_from_voxel =
        shapes::random_motion(random, 130.0) * Eigen::Scaling(handedness * 0.5, 0.7, 0.4);
    const Eigen::Vector3d centre_mm = reference_from_voxel * Eigen::Vector3d(23.3, 17.9, 31.2);
    const Volume volume = sampled(ball(centre_mm, 8.0), {64, 35, 47}, reference_from_voxel);
    for (const Mesher mesher : kMeshers) {
      for (const std::optional<double> spacing_mm : {std::optional<double>(), std::optional<double>(0.55)}) {
        const Mesh mesh = isosurface(volume, options_for(mesher, spacing_mm));
        expect_sound(mesh);
        EXPECT_NEAR(volume_mm3(mesh) / ball_mm3(8.0), 1.0, 0.01);  // positive: outward in both frames
        EXPECT_LT((centroid_mm(mesh) - centre_mm).norm(), 0.02);
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
          const Eigen::Vector3d from_centre = mesh.vertices[i] - centre_mm;
          EXPECT_NEAR(from_centre.norm(), 8.0, 0.12);
          EXPECT_GT(mesh.normals[i].dot(from_centre.normalized()), 0.95);
        }
      }
    }
  }
}

TEST(Isosurface, OfAFunctionThatIsLinearIsThatOfItsVolume) {
  // No whole numbers, so that no two samples lie equally far from the surface.
  const Eigen::Vector3d fall(1.0 / kPi, -std::numbers::sqrt3 / 8.0, std::numbers::egamma / 4.0);
  const PointField field = [fall](const Eigen::Vector3d& p) { return std::numbers::sqrt2 / 5.0 - fall.dot(p); };
  const Eigen::Affine3d reference_from_voxel(Eigen::Translation3d(-4.0, -5.0, -6.0) *
                                             Eigen::Affine3d(Eigen::Scaling(0.5, 0.25, 0.5)));
  const Volume volume = sampled(field, {25, 41, 17}, reference_from_voxel, CV_64F);
  const Eigen::AlignedBox3d box_mm(Eigen::Vector3d{-4.0, -5.0, -6.0}, Eigen::Vector3d{4.0, 5.0, 6.0});
  for (const Mesher mesher : kMeshers) {
    for (const double spacing_mm : {0.25, 0.4}) {
      const Mesh of_volume = isosurface(volume, options_for(mesher, spacing_mm));
      const Mesh of_function = isosurface(field, box_mm, options_for(mesher, spacing_mm));
      ASSERT_EQ(of_volume.vertices.size(), of_function.vertices.size());
      for (const Eigen::Vector3d& vertex : of_volume.vertices) EXPECT_NEAR(field(vertex), 0.0, 1e-3);
      for (std::size_t i = 0; i < of_volume.vertices.size(); ++i) {
        EXPECT_LT((of_volume.vertices[i] - of_function.vertices[i]).norm(), 1e-3);
      }
    }
  }
}

// One row of voxels after another, blended or not, in every type.
TEST(Isosurface, IsTheSameForEveryTypeOfVoxel) {
  Random random(5);
  const PointField noise = [&](const Eigen::Vector3d&) { return std::floor(100.0 * random.uniform()); };
  const Volume reals = sampled(noise, {9, 10, 12}, Eigen::Affine3d::Identity(), CV_64F);
  for (const Mesher mesher : kMeshers) {
    IsosurfaceOptions options = options_for(mesher);
    options.value = 49.3;  // no two voxels are equally far from it
    const Mesh expected = isosurface(reals, options);
    EXPECT_GT(expected.triangles.size(), 1000U);
    for (const int depth : {CV_8U, CV_8S, CV_16U, CV_16S, CV_32S, CV_32F}) {
      Volume volume = reals;
      reals.voxels.convertTo(volume.voxels, depth);
      const Mesh mesh = isosurface(volume, options);
      ASSERT_TRUE(mesh.triangles == expected.triangles);
      for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        EXPECT_LT((mesh.vertices[i] - expected.vertices[i]).norm(), 1e-3);
      }
    }
  }
}

TEST(Isosurface, DoesNotDependOnBatchesAndThreads) {
  Random random(7);
  const PointField noise = [&](const Eigen::Vector3d&) { return random.normal(); };
  const Volume volume = sampled(noise, {37, 14, 15}, Eigen::Affine3d::Identity());
  const int threads = cv::getNumThreads();
  for (const Mesher mesher : kMeshers) {
    for (const bool cap : {false, true}) {
      IsosurfaceOptions options = options_for(mesher);
      options.cap = cap;
      options.batch_layers = 1000;
      cv::setNumThreads(1);
      const Mesh whole = isosurface(volume, options);
      expect_sound(whole);
      EXPECT_EQ(mesh_topology(whole).closed(), cap);
      cv::setNumThreads(2);
      for (const int batch : {0, 1, 2, 3, 4, 7, 36}) {
        options.batch_layers = batch;
        expect_same(isosurface(volume, options), whole);
      }
    }
  }
  cv::setNumThreads(threads);
}

TEST(Isosurface, InsideMayLieBelowTheValue) {
  const Volume volume = sampled([](const Eigen::Vector3d& p) { return (p - Eigen::Vector3d(10, 11, 12)).norm(); },
                                {25, 23, 22}, Eigen::Affine3d::Identity(), CV_32F);
  for (const Mesher mesher : kMeshers) {
    IsosurfaceOptions options = options_for(mesher);
    options.value = 8.0;
    options.inside_below = true;
    EXPECT_NEAR(volume_mm3(isosurface(volume, options)) / ball_mm3(8.0), 1.0, 0.02);
    options.inside_below = false;
    options.cap = true;
    const double outside_mm3 = volume_mm3(isosurface(volume, options));
    EXPECT_NEAR(outside_mm3 / (21.0 * 22.0 * 24.0 - ball_mm3(8.0)), 1.0, 0.01);
  }
}

TEST(Isosurface, AValueOnTheSurfaceIsInsideOnEitherSide) {
  const PointField field = [](const Eigen::Vector3d& p) { return p == Eigen::Vector3d(3, 3, 3) ? 1.0 : 0.0; };
  const Volume volume = sampled(field, {7, 7, 7}, Eigen::Affine3d::Identity(), CV_8U);
  IsosurfaceOptions options = options_for(Mesher::kCubes);
  options.value = 1.0;
  const Mesh mesh = isosurface(volume, options);
  expect_sound(mesh);
  EXPECT_GT(volume_mm3(mesh), 0.0);
  Volume other = volume;
  other.voxels = 1.0 - volume.voxels;
  options.value = 0.0;
  options.inside_below = true;
  expect_same(isosurface(other, options), mesh);
}

TEST(Isosurface, DoesNotLookOutsideOfTheBox) {
  const Eigen::AlignedBox3d box_mm(Eigen::Vector3d{-1.1, 0.3, 2.7}, Eigen::Vector3d{2.2, 4.1, 5.9});
  Eigen::AlignedBox3d allowed_mm = box_mm;
  allowed_mm.extend(box_mm.max() + Eigen::Vector3d::Constant(1e-12));
  allowed_mm.extend(box_mm.min() - Eigen::Vector3d::Constant(1e-12));
  std::atomic<int> outside = 0;
  const PointField field = [&](const Eigen::Vector3d& place_mm) {
    if (!allowed_mm.contains(place_mm)) ++outside;
    return 1.5 - (place_mm - box_mm.center()).norm();
  };
  for (const Mesher mesher : kMeshers) {
    IsosurfaceOptions options = options_for(mesher, 0.31);
    options.cap = true;
    EXPECT_FALSE(isosurface(field, box_mm, options).triangles.empty());
  }
  EXPECT_EQ(outside, 0);
}

TEST(Isosurface, OfRowsIsThatOfPoints) {
  const RowField rows = [](const Eigen::Vector3d& start, const Eigen::Vector3d& step, std::span<double> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = 2.0 - (start + static_cast<double>(i) * step).norm();
    }
  };
  const IsosurfaceOptions options = options_for(Mesher::kRegularised, 0.2);
  expect_same(isosurface(rows, cube(3.0), options), isosurface(ball({0, 0, 0}, 2.0), cube(3.0), options));
}

TEST(Isosurface, SaysWhereTheFieldIsNoNumber) {
  const PointField field = [](const Eigen::Vector3d& p) {
    return p.z() > 1.0 ? std::numeric_limits<double>::quiet_NaN() : p.x();
  };
  for (const Mesher mesher : kMeshers) {
    expect_refused([&] { isosurface(field, cube(2.0), options_for(mesher, 0.5)); }, {", -2, 1.5) mm"});
  }
  const PointField pole = [](const Eigen::Vector3d& p) { return 1.0 / (p - Eigen::Vector3d(0, 0, 1)).norm() - 1.0; };
  expect_refused([&] { isosurface(pole, cube(2.0), options_for(Mesher::kCubes, 0.5)); }, {"(0, 0, 1) mm"});
  for (const float fault : {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    Volume volume = sampled(ball({10, 10, 10}, 5.0), {20, 20, 20}, Eigen::Affine3d(Eigen::Scaling(2.0, 1.0, 1.0)));
    volume.voxels.at<float>(14, 6, 3) = fault;
    for (const Mesher mesher : kMeshers) {
      expect_refused([&] { isosurface(volume, options_for(mesher)); }, {"voxel (3, 6, 14)", "(6, 6, 14) mm"});
      expect_refused([&] { isosurface(volume, options_for(mesher, 0.8)); }, {"voxel (3, 6, 14)"});
    }
  }
}

TEST(Isosurface, TakesValuesThatAFloatDoesNotHold) {
  const PointField huge = [](const Eigen::Vector3d& p) { return 1e200 * (4.0 - p.squaredNorm()); };
  const PointField tiny = [](const Eigen::Vector3d& p) { return 1e-200 * (4.0 - p.squaredNorm()); };
  for (const PointField& field : {huge, tiny}) {
    const Mesh mesh = isosurface(field, cube(3.0), options_for(Mesher::kRegularised, 0.1));
    expect_sound(mesh);
    EXPECT_NEAR(volume_mm3(mesh) / ball_mm3(2.0), 1.0, 0.1);
  }
}

TEST(Isosurface, RefusesAValueThatNothingCrosses) {
  const Volume volume =
      sampled([](const Eigen::Vector3d& p) { return 3.0 + p.x(); }, {6, 5, 4}, Eigen::Affine3d::Identity(), CV_16S);
  IsosurfaceOptions options;
  options.value = 200.0;
  expect_refused([&] { isosurface(volume, options); }, {"no value crosses 200", "between 3 and 6"});
  options.value = 3.0;
  expect_refused([&] { isosurface(volume, options); }, {"no value crosses 3"});
  options = options_for(Mesher::kTetrahedra, 0.5);
  expect_refused([&] { isosurface(ball({0, 0, 0}, -1.0), cube(1.0), options); }, {"no value crosses 0"});
  Volume dot = sampled([](const Eigen::Vector3d&) { return 0.0; }, {21, 21, 21}, Eigen::Affine3d::Identity());
  dot.voxels.at<float>(10, 10, 9) = 1.0F;
  options.value = 0.5;
  options.spacing_mm = 4.0;
  expect_refused([&] { isosurface(dot, options); }, {"smaller spacing"});
}

TEST(Isosurface, RefusesASpacingThatDoesNotFit) {
  const PointField field = ball({0, 0, 0}, 80.0);
  for (const Mesher mesher : kMeshers) {
    expect_refused([&] { isosurface(field, cube(100.0), options_for(mesher, 1e-3)); },
                   {"a spacing of 0.001 mm takes", "GB", "mm or more"});
    expect_refused([&] { isosurface(field, cube(100.0), options_for(mesher, 1e-300)); }, {"mm or more"});
    expect_refused([&] { isosurface(field, cube(100.0), options_for(mesher, 201.0)); }, {"smaller spacing"});
    for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
      expect_refused([&] { isosurface(field, cube(100.0), options_for(mesher, bad)); }, {"spacing"});
    }
    expect_refused([&] { isosurface(field, cube(100.0), options_for(mesher)); }, {"needs a spacing"});
    expect_refused([&] { isosurface(field, cube(-1.0), options_for(mesher, 1.0)); }, {"box is empty"});
  }
}

TEST(Isosurface, RefusesWhatIsNoVolume) {
  const IsosurfaceOptions options;
  expect_refused([&] { isosurface(Volume{}, options); }, {"one channel"});
  Volume volume = sampled(ball({2, 2, 0}, 1.5), {1, 5, 5}, Eigen::Affine3d::Identity());
  expect_refused([&] { isosurface(volume, options); }, {"5 x 5 x 1", "at least two"});
  volume = sampled(ball({2, 2, 2}, 1.5), {5, 5, 5}, Eigen::Affine3d::Identity());
  volume.reference_from_voxel.linear().col(2) = Eigen::Vector3d(1.0, 1.0, 0.0);
  expect_refused([&] { isosurface(volume, options); }, {"span no space"});
}

TEST(Isosurface, CanBeCancelledAndReportsItsProgress) {
  IsosurfaceOptions options = options_for(Mesher::kRegularised, 0.5);
  options.batch_layers = 4;
  std::vector<double> fractions;
  isosurface(ball({0, 0, 0}, 4.0), cube(5.0), options, [&](double fraction) {
    fractions.push_back(fraction);
    return true;
  });
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_GE(fractions.size(), 5U);
  EXPECT_EQ(fractions.back(), 1.0);
  EXPECT_THROW(isosurface(ball({0, 0, 0}, 4.0), cube(5.0), options, [](double fraction) { return fraction < 0.4; }),
               Cancelled);
}

TEST(Isosurface, PassesOnWhatAFunctionThrows) {
  const PointField field = [](const Eigen::Vector3d& p) -> double {
    if (p.z() > 0.0) throw Error("no field here");
    return p.x();
  };
  expect_refused([&] { isosurface(field, cube(5.0), options_for(Mesher::kCubes, 0.5)); }, {"no field here"});
}

TEST(SetNormals, TakesTheDirectionGiven) {
  Mesh mesh = isosurface(ball({0, 0, 0}, 4.0), cube(5.0), options_for(Mesher::kRegularised, 0.5));
  set_normals(mesh, [](const Eigen::Vector3d& place_mm) { return Eigen::Vector3d(3.0 * place_mm); });
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_LT((mesh.normals[i] - mesh.vertices[i].normalized()).norm(), 1e-14);
  }
  // Without a direction: what was there, or that of the triangles.
  const Mesh before = mesh;
  set_normals(mesh, [](const Eigen::Vector3d& place_mm) -> Eigen::Vector3d {
    return (place_mm.x() > 0.0 ? 0.0 : std::numeric_limits<double>::infinity()) * place_mm;
  });
  EXPECT_TRUE(mesh.normals == before.normals);
  mesh.normals.clear();
  set_normals(mesh, [](const Eigen::Vector3d&) -> Eigen::Vector3d { return Eigen::Vector3d::Zero(); });
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_GT(mesh.normals[i].dot(mesh.vertices[i].normalized()), 0.9);
  }
}

}  // namespace
}  // namespace fathom
