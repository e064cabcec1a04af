#include "sim/studies/surface_study.h"

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
}

TEST(SurfaceTableStudy, VolumesAt20Planes) {
  std::vector<SurfaceVolumeRow> rows;
  for (const SurfaceVolumeRow& row : published_surface_rows()) {
    rows.push_back(measure_surface_row(row));
    const SurfaceVolumeRow& measured = rows.back();
    for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(measured.closed[i]) << row.object << " " << row.pattern;
    EXPECT_LE(std::abs(measured.error_percent[2]), std::max(std::abs(row.published_percent[2]), 1.1))
        << row.object << " " << row.pattern;
  }
  std::cout << surface_table_text(rows);
}

// Spacings that give marching cubes about the published 2320 triangles.
TEST(RenderingVariation, OfRegularisedTrianglesIsLessThanHalfOfThatOfMarchingCubes) {
  constexpr double kSpacing = 0.105;
  const MesherOptions cubes{Mesher::kCubes, VertexPlacement::kAverage, false};
  const MesherOptions tetrahedra{Mesher::kTetrahedra, VertexPlacement::kAverage, false};
  const MesherOptions regularised{Mesher::kRegularised, VertexPlacement::kAverage, false};
  const RenderingVariation mc = rendering_variation(cubes, kSpacing);
  const RenderingVariation mt = rendering_variation(tetrahedra, kSpacing);
  const RenderingVariation rmt = rendering_variation(regularised, kSpacing);
  for (const auto& [name, v] : {std::pair{"MC", mc}, {"MT", mt}, {"RMT", rmt}}) {
    std::printf("| %s | %zu | %.2f | %.2f | %.2f | %.2f |\n", name, v.triangles, v.mean_image, v.mean_sphere,
                v.largest_sphere, v.border_percent);
  }
  EXPECT_NEAR(static_cast<double>(mc.triangles), 2320.0, 0.05 * 2320.0);
  EXPECT_LE(rmt.mean_sphere, 0.45 * mc.mean_sphere);
}

}  // namespace
}  // namespace fathom
