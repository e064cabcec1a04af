#include "sim/studies/planimetry_study.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "measurement/planimetry.h"

namespace fathom {
namespace {

// A pattern stands for the published one when linear planimetry errs as much in both at 20 planes.
constexpr double kSameScan_percent = 0.15;

class PlanimetryTable : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Table21, PlanimetryTable, testing::Range<std::size_t>(0, published_planimetry_rows().size()),
                         [](const auto& instance) {
                           const PlanimetryRow row = published_planimetry_rows()[instance.param];
                           std::string name = row.object + "_" + row.pattern;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(PlanimetryTable, IsReproducedAndCubicPlanimetryIsAsGoodAsPublished) {
  const PlanimetryRow row = published_planimetry_rows()[GetParam()];
  const std::vector<MethodAccuracy> methods = measure_planimetry_row(row);
  EXPECT_NEAR(methods[0].error_percent_at_20, row.published[0]->error_percent_at_20, kSameScan_percent);
  const int allowance = is_rough(row) ? 3 : 0;
  const double rms_limit = is_rough(row) ? 0.5 : 0.1;
  for (const std::size_t method : {1u, 2u}) {
    ASSERT_TRUE(methods[method].planes_below_1_percent);
    EXPECT_LE(*methods[method].planes_below_1_percent, *row.published[method]->planes_below_1_percent + allowance);
    EXPECT_LE(std::abs(methods[method].rms_percent_17_to_20), rms_limit);
  }
}

double error_percent(const char* object, const char* pattern, int planes, std::size_t method) {
  SimulateOptions options;
  options.object = object;
  options.pattern = pattern;
  options.frames = planes;
  const SimulatedScan scan = simulate(options);
  const FrameLocator locator(*scan.recording, scan.calibration);
  const auto volumes = measure_planimetry(cross_sections(scan.outlines.front(), locator, nullptr)).volumes;
  const double measured = method == 0 ? volumes.linear_ml.value() : volumes.cubic_ml.value();
  return 100.0 * (measured / scan.truth.volume_ml - 1.0);
}

TEST(PlanimetryConvergence, LinearIsOfSecondOrderInTheNumberOfPlanes) {
  for (const char* object : {"sphere", "ellipsoid", "glove"}) {
    const double coarse = error_percent(object, "free", 17, 0);
    const double fine = error_percent(object, "free", 33, 0);
    EXPECT_NEAR(coarse / fine, 4.0, 0.4) << object;
  }
}

TEST(PlanimetryConvergence, CubicIsOfHigherOrderAndReachesTheTrueVolume) {
  for (const char* object : {"sphere", "ellipsoid", "glove"}) {
    const double coarse = error_percent(object, "free", 17, 1);
    const double fine = error_percent(object, "free", 33, 1);
    EXPECT_GT(coarse / fine, 5.0) << object;
    EXPECT_LT(std::abs(error_percent(object, "free", 65, 1)), 0.02) << object;
  }
}

}  // namespace
}  // namespace fathom
