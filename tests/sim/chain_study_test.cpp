#include "sim/studies/chain_study.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/studies/chain_links.h"

namespace fathom {
namespace {

double link_ml(const ChainVolumes& volumes, ChainLink link) { return volumes.link_ml[static_cast<std::size_t>(link)]; }

TEST(MeasuringChain, WithoutNoiseErrsByItsSectionsOnly) {
  const MeasuringSystem system({.tracker_mm = 0.0, .outline_mm = 0.0, .latency_s = 0.12, .drawn_px = 0.0}, 3);
  EXPECT_LT(system.point_mm(), 0.02);
  EXPECT_LT(std::abs(system.latency_error_s()), 0.001);
  const ChainVolumes volumes = system.measure({"bladder", "free"}, 10, 4);
  const double sections_ml = link_ml(volumes, ChainLink::kSections);
  EXPECT_NEAR(sections_ml / volumes.true_ml, 1.0, 0.01);
  EXPECT_EQ(link_ml(volumes, ChainLink::kTracker), sections_ml);
  EXPECT_NEAR(link_ml(volumes, ChainLink::kOutlining), sections_ml, 1e-9);
  EXPECT_NEAR(volumes.all_ml / sections_ml, 1.0, 1e-3);
}

TEST(MeasuringChain, LinksAddUpAndGrowInProportion) {
  const MeasuringSystem system({.tracker_mm = 0.25, .outline_mm = 0.1, .latency_s = 0.12, .drawn_px = 1.0}, 3);
  const MeasuringSystem rougher({.tracker_mm = 0.25, .outline_mm = 0.2, .latency_s = 0.12, .drawn_px = 1.0}, 3);
  const ChainVolumes little = system.measure({"kidney", "free"}, 10, 4);
  const ChainVolumes much = rougher.measure({"kidney", "free"}, 10, 4);
  const auto change_ml = [](const ChainVolumes& volumes, ChainLink link) {
    return link_ml(volumes, link) - link_ml(volumes, ChainLink::kSections);
  };
  EXPECT_NEAR(change_ml(much, ChainLink::kOutlining), 2.0 * change_ml(little, ChainLink::kOutlining),
              0.1 * std::abs(change_ml(much, ChainLink::kOutlining)) + 0.05);
  double sum_ml = link_ml(little, ChainLink::kSections);
  for (const ChainLink link :
       {ChainLink::kTracker, ChainLink::kCalibration, ChainLink::kLatency, ChainLink::kOutlining, ChainLink::kPixels}) {
    sum_ml += change_ml(little, link);
  }
  EXPECT_NEAR(little.all_ml, sum_ml, 0.002 * little.true_ml);
  EXPECT_LT(little.low_ml, little.all_ml);
  EXPECT_GT(little.high_ml, little.all_ml);
}

TEST(ChainStudy, MeetsItsGoals) {
  const Study& study = chain_study();
  std::vector<nlohmann::ordered_json> results;
  for (int i = 0; i < study.cases({}); ++i) results.push_back(study.run_case({}, i));
  for (const StudyGoal& goal : study.report({}, results).goals) {
    EXPECT_TRUE(goal.met) << goal.what << ": wanted " << goal.wanted << ", measured " << goal.measured;
  }
}

}  // namespace
}  // namespace fathom
