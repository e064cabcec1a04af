#include "sim/studies/outlining_study.h"

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace fathom {
namespace {

// One rule for all scenes, without a number to choose: the user works for the Dice that counts.
constexpr double kWanted = 0.95;
constexpr double kLeastArea_px = 300.0;

void expect_few_clicks(const std::string& object, std::uint64_t first_seed, int scans, int frames, int most_clicks) {
  int clicks = 0;
  int most = 0;
  int outlines = 0;
  double worst = 1.0;
  for (int i = 0; i < scans; ++i) {
    SimulateOptions scan;
    scan.object = object;
    scan.frames = frames;
    scan.seed = first_seed + static_cast<std::uint64_t>(i);
    scan.speckle.emplace();
    for (const OutliningTrial& trial : live_wire_study(scan, 3, kLeastArea_px, kWanted)) {
      EXPECT_GE(trial.dice, kWanted) << object << ", seed " << scan.seed << ", frame " << trial.frame;
      EXPECT_LE(trial.clicks, most_clicks) << object << ", seed " << scan.seed << ", frame " << trial.frame;
      clicks += trial.clicks;
      most = std::max(most, trial.clicks);
      worst = std::min(worst, trial.dice);
      ++outlines;
    }
  }
  ASSERT_GT(outlines, 0);
  std::cout << object << ": " << outlines << " outlines, clicks mean " << static_cast<double>(clicks) / outlines
            << ", most " << most << "; worst Dice " << worst << "\n";
}

TEST(ScriptedOutline, ABladderNeedsEightClicksAtMost) { expect_few_clicks("bladder", 1, 1, 7, 8); }

TEST(LiveWireStudy, ABladderNeedsEightClicksAtMost) { expect_few_clicks("bladder", 8001, 10, 41, 8); }

TEST(LiveWireStudy, AFoetusNeedsFourteenClicksAtMost) { expect_few_clicks("foetus", 8001, 10, 41, 14); }

}  // namespace
}  // namespace fathom
