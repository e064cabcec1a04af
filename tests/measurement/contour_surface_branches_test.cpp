#include <vector>

#include <gtest/gtest.h>

#include "measurement/contour_surface.h"
#include "surface/mesh_measure.h"
#include "tests/measurement/parallel_stack.h"
#include "tests/measurement/surface_checks.h"

namespace fathom {
namespace {

using stacks::bladder_and_prostate;
using stacks::ducts;
using stacks::every;
using stacks::Outlines;
using surfaces::expect_sound;

constexpr double kPixelMm = 0.1;
const Eigen::Vector2d kShiftMm(80.0, 60.0);  // of outlines, so that no pixel is negative

Structure drawn(const Outlines& object, const std::vector<double>& places) {
  Structure structure;
  structure.name = "object";
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (const Polygon& outline : object(places[i])) {
      Contour contour;
      contour.frame = static_cast<int>(i);
      for (const Eigen::Vector2d& point : outline) contour.points_px.push_back((point + kShiftMm) / kPixelMm);
      structure.contours.push_back(contour);
    }
  }
  return structure;
}

// Of closed surfaces without handles.
int parts(const Outlines& object, const std::vector<double>& places, double spacing_mm, Guide guide,
          std::optional<GapOrder> order = {}) {
  const FrameLocator locator = scan_of(turning_sweep(places), kPixelMm);
  ContourSurfaceOptions options;
  options.guide = guide;
  options.order = order;
  options.spacing_mm = spacing_mm;
  ContourSurface surface(locator, options);
  surface.update(drawn(object, places));
  expect_sound(surface.mesh());
  EXPECT_EQ(mesh_topology(surface.mesh()).genus(), 0);
  return static_cast<int>(mesh_topology(surface.mesh()).components);
}

TEST(ContourSurface, KeepsABladderAndTheProstateBesideItApart) {
  for (const GapOrder order : {GapOrder::kLinear, GapOrder::kCurved}) {
    for (const double spacing_mm : {0.9, 1.0, 1.1}) {
      EXPECT_EQ(parts(bladder_and_prostate, evenly(-10.0, 20.0, 4), spacing_mm, Guide::kDiscs, order), 2);
    }
  }
  EXPECT_EQ(parts(bladder_and_prostate, {0.0, 10.0}, 1.0, Guide::kShape), 1);
}

// Treece 2000, figure 3.2: straight across, thin ducts that move aside fall to pieces.
TEST(ContourSurface, FollowsADuctThroughItsFork) {
  for (const GapOrder order : {GapOrder::kLinear, GapOrder::kCurved}) {
    EXPECT_EQ(parts(ducts, every(0.0, 39.0, 3.0), 0.6, Guide::kDiscs, order), 1);
  }
  const std::vector<double> few = every(0.0, 40.0, 5.0);
  EXPECT_LE(parts(ducts, few, 0.6, Guide::kDiscs), 2);
  EXPECT_GE(parts(ducts, few, 0.6, Guide::kShape, GapOrder::kLinear), 5);
}

TEST(ContourSurface, OfParallelPlanesIsTheSameFromEitherEnd) {
  const std::vector<double> places = every(0.0, 40.0, 5.0);
  const FrameLocator forward = scan_of(turning_sweep(places), kPixelMm);
  const std::vector<double> reversed(places.rbegin(), places.rend());
  const FrameLocator backward = scan_of(turning_sweep(reversed), kPixelMm);
  for (const GapOrder order : {GapOrder::kLinear, GapOrder::kCurved}) {
    ContourSurfaceOptions options;
    options.order = order;
    options.mesher.mesher = Mesher::kTetrahedra;
    ContourSurface ahead(forward, options);
    ContourSurface back(backward, options);
    const Mesh& a = ahead.update(drawn(ducts, places));
    const Mesh& b = back.update(drawn(ducts, reversed));
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    EXPECT_NEAR(volume_mm3(a) / volume_mm3(b), 1.0, 1e-5);
    // Cuts of the same lattice edges: each vertex has its twin.
    const auto sorted = [](std::vector<Eigen::Vector3d> vertices) {
      const auto key = [](const Eigen::Vector3d& v) { return std::lround(v.z() / 1e-2); };
      std::sort(vertices.begin(), vertices.end(),
                [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) { return key(p) < key(q); });
      return vertices;
    };
    const std::vector<Eigen::Vector3d> others = sorted(b.vertices);
    double farthest = 0.0;
    for (const Eigen::Vector3d& vertex : a.vertices) {
      double nearest = 1e300;
      const auto from = std::lower_bound(others.begin(), others.end(), vertex.z() - 0.05,
                                         [](const Eigen::Vector3d& v, double z) { return v.z() + 0.02 < z; });
      for (auto other = from; other != others.end() && other->z() < vertex.z() + 0.05; ++other) {
        nearest = std::min(nearest, (*other - vertex).norm());
      }
      farthest = std::max(farthest, nearest);
    }
    EXPECT_LT(farthest, 0.01 * ahead.spacing_mm());
  }
}

}  // namespace
}  // namespace fathom
