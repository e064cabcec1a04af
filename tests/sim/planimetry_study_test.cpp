#include "sim/studies/planimetry_study.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "measurement/planimetry.h"
#include "sim/studies/volume_study.h"

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

TEST(VolumeStudy, RowsHaveCountsByMethodAndThePublishedOnes) {
  using Json = nlohmann::ordered_json;
  const Study& study = volume_study();
  std::vector<Json> results;
  for (int i = 0; i < study.cases({}); ++i) {
    const int planes = kFewestPlanes + i % (kMostPlanes - kFewestPlanes + 1);
    Json volumes;
    for (const VolumeMethod& method : kVolumeMethods)
      volumes[method.name] = 2.0 * (1.0 - 1.0 / std::pow(planes - 1, 2));
    volumes["cubic_planimetry"] = planes == 6 || planes > 8 ? 2.0 : 1.9;
    volumes["shape_based"] = nullptr;
    results.push_back({{"true_ml", 2.0}, {"volume_ml", volumes}});
  }
  const Json rows = study.rows({}, results);
  ASSERT_EQ(rows.size(), 14u);
  const Json& row = rows.at(0);
  EXPECT_EQ(row.at("object"), "sphere");
  EXPECT_EQ(row.at("pattern"), "linear");
  EXPECT_EQ(row.at("planes_below_1_percent").at("linear_planimetry"), 12);  // 1.000 % at 11
  EXPECT_EQ(row.at("planes_below_1_percent").at("cubic_planimetry"), 9);
  EXPECT_EQ(row.at("first_below_1_percent").at("cubic_planimetry"), 6);
  EXPECT_TRUE(row.at("planes_below_1_percent").at("shape_based").is_null());
  EXPECT_NEAR(row.at("error_percent_at_20").at("linear_planimetry").get<double>(), -100.0 / 361.0, 1e-9);
  EXPECT_EQ(row.at("published").at("planes_below_1_percent").at("linear_planimetry"), 11);
  EXPECT_TRUE(rows.at(1).at("published").at("planes_below_1_percent").at("linear_planimetry").is_null());
  EXPECT_EQ(row.at("published").at("error_percent_at_20").at("disc_guided"), -0.8);
}

TEST(VolumeStudy, ACaseIsAScanMeasuredByEveryMethod) {
  const auto value = volume_study().run_case({}, 2);
  EXPECT_EQ(volume_study().case_name({}, 2), "sphere linear, 6 planes");
  const double ball_ml = 4.0 / 3.0 * std::numbers::pi;
  EXPECT_NEAR(value.at("true_ml").get<double>(), ball_ml, 1e-9);
  const auto& volume_ml = value.at("volume_ml");
  EXPECT_EQ(volume_ml.size(), kVolumeMethods.size());
  EXPECT_NEAR(volume_ml.at("linear_planimetry").get<double>(), ball_ml * 24.0 / 25.0, 1e-3);
  EXPECT_NEAR(volume_ml.at("cubic_planimetry_quadric").get<double>(), ball_ml, 1e-3);
  // Straight lines between outlines make cones of a ball: radii are 0, 0.8 and 0.96^0.5 at 0, 0.4 and 0.8.
  const double cones_ml =
      std::numbers::pi * 0.4 / 3.0 * (2.0 * (0.64 + 0.64 + 0.8 * std::sqrt(0.96) + 0.96) + 3.0 * 0.96);
  for (const char* straight : {"shape_based", "centroid_guided", "disc_guided"}) {
    EXPECT_NEAR(volume_ml.at(straight).get<double>(), cones_ml, 0.01) << straight;
  }
  EXPECT_GT(volume_ml.at("disc_guided_curved").get<double>(), cones_ml + 0.1);
}

}  // namespace
}  // namespace fathom
