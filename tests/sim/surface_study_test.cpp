#include "sim/studies/surface_study.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>

#include <gtest/gtest.h>

#include "sim/studies/rendering_study.h"

namespace fathom {
namespace {

TEST(SurfaceTable, OfTheSphereIsClosedAndAsSmallAsLinearInterpolationMakesIt) {
  const SurfaceVolumeRow row = measure_surface_row(published_surface_rows().front());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(row.closed[i]);
    EXPECT_NEAR(row.error_percent[i], -0.95, 0.2) << kSurfaceMethods[i];
  }
  EXPECT_TRUE(row.closed[3]);
  EXPECT_LT(std::abs(row.error_percent[3]), 0.5);
}

TEST(SurfaceTableStudy, VolumesAt20Planes) {
  std::vector<SurfaceVolumeRow> rows;
  for (const SurfaceVolumeRow& row : published_surface_rows()) {
    rows.push_back(measure_surface_row(row));
    const SurfaceVolumeRow& measured = rows.back();
    for (const bool closed : measured.closed) EXPECT_TRUE(closed) << row.object << " " << row.pattern;
    // Discs lead more steeply inwards than straight lines do at the ends of fans, and are better everywhere else.
    EXPECT_LE(std::abs(measured.error_percent[2]), std::abs(measured.error_percent[0]) + 0.25)
        << row.object << " " << row.pattern;
    // The second order is better, or there is nothing to better.
    EXPECT_LE(std::abs(measured.error_percent[3]), std::abs(measured.error_percent[2]) + 0.05)
        << row.object << " " << row.pattern;
  }
  std::cout << surface_table_text(rows);
}

// The spacing gives marching cubes about the published 2320 triangles. The published variation is that of normals taken
// from the triangles; the field's own normals leave little of it, whatever the triangles.
TEST(RenderingVariation, OfRegularisedTrianglesIsLessThanHalfOfThatOfMarchingCubes) {
  constexpr double kSpacing = 0.1275;
  std::array<std::array<RenderingVariation, 3>, 2> found;
  for (const ShadingNormals normals : {ShadingNormals::kTriangles, ShadingNormals::kField}) {
    auto& row = found[static_cast<std::size_t>(normals)];
    for (const Mesher mesher : {Mesher::kCubes, Mesher::kTetrahedra, Mesher::kRegularised}) {
      MesherOptions options;
      options.mesher = mesher;
      RenderingVariation& v = row[static_cast<std::size_t>(mesher)];
      v = rendering_variation(options, kSpacing, normals);
      std::printf("| %s | %s | %zu | %.2f | %.2f | %.2f | %.2f |\n",
                  normals == ShadingNormals::kField ? "field" : "triangles",
                  mesher == Mesher::kCubes        ? "MC"
                  : mesher == Mesher::kTetrahedra ? "MT"
                                                  : "RMT",
                  v.triangles, v.mean_image, v.mean_sphere, v.largest_sphere, v.border_percent);
    }
  }
  const auto at = [&](ShadingNormals normals, Mesher mesher) {
    return found[static_cast<std::size_t>(normals)][static_cast<std::size_t>(mesher)];
  };
  EXPECT_NEAR(static_cast<double>(at(ShadingNormals::kField, Mesher::kCubes).triangles), 2320.0, 0.05 * 2320.0);
  EXPECT_LE(at(ShadingNormals::kTriangles, Mesher::kRegularised).mean_sphere,
            0.45 * at(ShadingNormals::kTriangles, Mesher::kCubes).mean_sphere);
  for (const Mesher mesher : {Mesher::kCubes, Mesher::kTetrahedra, Mesher::kRegularised}) {
    EXPECT_LE(at(ShadingNormals::kField, mesher).mean_sphere,
              0.25 * at(ShadingNormals::kTriangles, Mesher::kCubes).mean_sphere);
  }
}

}  // namespace
}  // namespace fathom
