#include "measurement/tapered_end.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace fathom {
namespace {

/// Sections of an ellipsoid of half-axes 12, 9 and `half` mm about the origin whose centres lie on a slanting line.
struct Ellipsoid {
  double half = 20.0;

  Eigen::Vector2d centre(double z) const { return {0.3 * z, -0.2 * z}; }
  double scale(double z) const { return std::sqrt(1.0 - z * z / (half * half)); }

  bool inside(const Eigen::Vector2d& ab, double z) const {
    const Eigen::Vector2d off = (ab - centre(z)) / scale(z);
    return std::hypot(off.x() / 12.0, off.y() / 9.0) < 1.0;
  }

  PlacedSection section(double z) const {
    PlacedSection placed;
    placed.plane.origin_mm.z() = z;
    if (std::abs(z) > half + 1e-9) {
      placed.shape = std::make_shared<SectionShape>();
    } else if (std::abs(z) > half - 1e-9) {
      placed.shape = std::make_shared<SectionShape>(centre(z), 0.2);
    } else {
      Polygon outline;
      for (int i = 0; i < 120; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 120.0;
        outline.emplace_back(centre(z) + scale(z) * Eigen::Vector2d(12.0 * std::cos(angle), 9.0 * std::sin(angle)));
      }
      std::vector<Polygon> outlines = {outline};
      const SectionRaster raster = section_raster(outlines, 0.2);
      placed.shape = std::make_shared<SectionShape>(std::move(outlines), raster);
    }
    return placed;
  }
};

double dice(const Ellipsoid& truth, const TaperedEnd& end, double w, double z) {
  int mine = 0;
  int theirs = 0;
  int both = 0;
  for (double a = -25.0; a <= 25.0; a += 0.2) {
    for (double b = -25.0; b <= 25.0; b += 0.2) {
      const bool found = end.value_mm({a, b}, w).distance_mm > 0.0F;
      const bool is = truth.inside({a, b}, z);
      mine += found;
      theirs += is;
      both += found && is;
    }
  }
  return mine + theirs == 0 ? 1.0 : 2.0 * both / (mine + theirs);
}

TEST(TaperedEnd, OfAnEllipsoidIsExactWhereItsTipIsMarked) {
  const Ellipsoid truth;
  const std::vector<PlacedSection> sections = {truth.section(15.0), truth.section(10.0)};
  const TaperedEnd end(truth.section(20.0), sections);
  for (const double w : {0.1, 0.3, 0.5, 0.8}) EXPECT_GT(dice(truth, end, w, 20.0 - 5.0 * w), 0.985) << w;
}

TEST(TaperedEnd, FindsTheTipOfAnEllipsoidFromThreeSections) {
  const Ellipsoid truth;
  const std::vector<PlacedSection> sections = {truth.section(17.5), truth.section(12.5), truth.section(7.5)};
  const TaperedEnd end(truth.section(22.5), sections);
  for (const double w : {0.65, 0.8}) EXPECT_GT(dice(truth, end, w, 22.5 - 5.0 * w), 0.98) << w;
  // Beyond the tip, at half of the way, there is nothing.
  EXPECT_LT(end.value_mm(truth.centre(20.5), 0.4).distance_mm, 0.0F);
  EXPECT_TRUE(end.open_parts().empty());
}

TEST(TaperedEnd, LeavesOpenWhereAThinPartEndsAndTakesWhatIsSaid) {
  const Ellipsoid stem{1e6};  // of even thickness, far longer than thick, seen from planes far apart
  const auto at = [&](double z) { return stem.section(z); };
  const std::vector<PlacedSection> sections = {at(0.0), at(-40.0)};
  PlacedSection absent;
  absent.plane.origin_mm.z() = 40.0;
  absent.shape = std::make_shared<SectionShape>();
  TaperedEnd end(absent, sections);
  ASSERT_EQ(end.open_parts().size(), 1U);
  const auto inside = [&](double w) { return end.value_mm(stem.centre(40.0 * (1.0 - w)), w).distance_mm > 0.0F; };
  EXPECT_TRUE(inside(0.6));
  EXPECT_FALSE(inside(0.4));
  end.end_at(0, 0.2);
  EXPECT_TRUE(inside(0.3));
  EXPECT_FALSE(inside(0.15));
}

}  // namespace
}  // namespace fathom
