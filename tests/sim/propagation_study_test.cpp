#include "sim/studies/propagation_study.h"

#include <algorithm>
#include <initializer_list>
#include <iomanip>
#include <iostream>

#include <gtest/gtest.h>

#include "sim/simulate.h"

namespace fathom {
namespace {

void print(const std::vector<PropagationStudySweep>& sweeps, const PropagationSummary& summary) {
  std::cout << std::fixed << std::setprecision(4);
  for (const PropagationStudySweep& sweep : sweeps) {
    std::cout << sweep.object << " " << sweep.pattern << " seed " << sweep.seed << ": Dice " << sweep.dice
              << ", without images " << sweep.image_free_dice << ", volume error";
    for (const double error : sweep.volume_errors_percent) std::cout << " " << std::setprecision(2) << error << " %";
    std::cout << std::setprecision(4) << "\n";
  }
  std::cout << summary.contours << " frames: mean Dice " << summary.mean_dice << ", 5th percentile "
            << summary.fifth_percentile << " (without images " << summary.image_free_mean_dice << ", "
            << summary.image_free_fifth_percentile << "); of sweeps: 5th percentile "
            << summary.fifth_percentile_of_sweeps << ", worst " << summary.worst_sweep_dice << "\nvolume error: mean "
            << summary.mean_volume_error_percent << " %, largest " << summary.largest_volume_error_percent
            << " %\nconfidence >= 0.9: " << summary.sure << " frames, right " << summary.right_of_sure << " (of all "
            << summary.right << ")\nhard sweeps: " << summary.hard_sweeps << ", 1 - Dice against interpolation's: mean "
            << summary.mean_fault_ratio << ", largest " << summary.largest_fault_ratio
            << "\nseconds per frame: " << summary.seconds_per_frame << "\n";
}

TEST(Propagation, FillsSpeckledScenesBetterThanInterpolation) {
  PropagationStudyOptions options;
  options.sweeps = 1;  // of the bladder
  options.frames = 25;
  options.first_seed = 501;
  const auto sweeps = propagation_study(options);
  const PropagationSummary summary = summary_of(sweeps);
  EXPECT_GT(summary.mean_dice, summary.image_free_mean_dice);
  EXPECT_GT(summary.mean_dice, 0.9);
  for (const auto& sweep : sweeps) {
    for (const double error : sweep.volume_errors_percent) EXPECT_LT(std::abs(error), 4.0) << sweep.object;
  }
}

// Two outlines alike far apart say nothing of what lies between, whatever the pixels nearby seem to say.
TEST(Propagation, IsNotSureBetweenTwoOutlinesFarApart) {
  SimulateOptions options;
  options.object = "bladder";
  options.pattern = "linear";
  options.frames = 16;
  options.speckle.emplace();
  const SimulatedScan scan = simulate(options);
  const FrameLocator locator(*scan.recording, scan.calibration);
  Structure drawn = scan.outlines.front();
  const auto keep = [&](std::initializer_list<int> frames, const FrameLocator* placed) {
    Structure kept = drawn;
    std::erase_if(kept.contours, [&](const Contour& contour) {
      return std::find(frames.begin(), frames.end(), contour.frame) == frames.end();
    });
    kept.extremities.clear();
    const Propagation result = propagate(*scan.recording, {kept}, placed, {}, {}, {});
    double surest = 0.0;
    for (const PropagatedFrame& frame : result.frames) surest = std::max(surest, frame.confidence);
    return surest;
  };
  EXPECT_LT(keep({2, 12}, &locator), kSureContour);
  EXPECT_LT(keep({2, 12}, nullptr), kSureContour) << "how far frames are apart is not known";
  EXPECT_GT(keep({2, 4, 6, 8, 10, 12}, &locator), kSureContour) << "the more are drawn the surer";
}

TEST(PropagationStudy, FortySpeckledSweepsWithEveryEighthFrameDrawn) {
  const auto sweeps = propagation_study({});
  const PropagationSummary summary = summary_of(sweeps);
  print(sweeps, summary);
  EXPECT_GE(summary.mean_dice, 0.95);
  EXPECT_GE(summary.fifth_percentile, 0.88);
  EXPECT_LE(summary.largest_volume_error_percent, 2.0);
  EXPECT_GE(summary.right_of_sure, 0.95);
  EXPECT_LE(summary.largest_fault_ratio, 0.6);
}

}  // namespace
}  // namespace fathom
