#include "sim/studies/outlining_study.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace fathom {
namespace {

// Clicks on the true outline until the line is good; a user who wants more clicks more often.
void expect_few_clicks(const std::string& object, int frames, int every, double tolerance, int most_clicks) {
  SimulateOptions scan;
  scan.object = object;
  scan.frames = frames;
  scan.speckle.emplace();
  const std::vector<OutliningTrial> trials = live_wire_study(scan, every, 300.0, tolerance);
  ASSERT_FALSE(trials.empty());
  for (const OutliningTrial& trial : trials) {
    EXPECT_GE(trial.dice, 0.95) << object << ", frame " << trial.frame;
    EXPECT_LE(trial.clicks, most_clicks) << object << ", frame " << trial.frame;
  }
}

TEST(ScriptedOutline, ABladderNeedsEightClicksAtMost) { expect_few_clicks("bladder", 7, 3, 0.07, 8); }

TEST(LiveWireStudy, ABladderNeedsEightClicksAtMost) { expect_few_clicks("bladder", 41, 2, 0.07, 8); }

TEST(LiveWireStudy, AFoetusNeedsFourteenClicksAtMost) { expect_few_clicks("foetus", 41, 2, 0.05, 14); }

}  // namespace
}  // namespace fathom
