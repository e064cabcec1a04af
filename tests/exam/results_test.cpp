#include "exam/results.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/exam/scan.h"

namespace fathom {
namespace {

TEST(Results, HoldTheVolumeOfEveryStructureUnderTheNamesOtherProgramsRead) {
  const MemoryRecording recording = box_recording();
  Structure single = box_structure();
  single.name = "one section";
  single.contours.resize(1);
  const auto results =
      measure_structures({box_structure(), single}, recording, FrameLocator(recording, box_calibration()));
  const auto json = results_json(results);

  const auto& box = json["structures"][0];
  EXPECT_EQ(box["name"], "box");
  EXPECT_EQ(box["sections"], 11);
  for (const char* method : {"linear_planimetry", "cubic_planimetry", "cubic_planimetry_3d"}) {
    EXPECT_NEAR(box["volume_ml"][method].get<double>(), 8.0, 1e-9) << method;
  }
  for (const char* method : {"shape_based", "centroid_guided", "disc_guided", "disc_guided_curved"}) {
    EXPECT_NEAR(box["volume_ml"][method].get<double>(), 8.0, 0.05) << method;
  }
  // The box's flat ends might as well be an organ that goes on.
  ASSERT_EQ(box["warnings"].size(), 1u);
  EXPECT_NE(box["warnings"][0].get<std::string>().find("what lies beyond is not measured"), std::string::npos);

  // One section has no volume: null and the reason, never a number.
  const auto& one = json["structures"][1];
  EXPECT_TRUE(one["volume_ml"]["cubic_planimetry"].is_null());
  EXPECT_FALSE(one["warnings"].empty());
}

TEST(Results, NameFramesWhosePoseWasLost) {
  const MemoryRecording good = box_recording();
  RecordingHeader header = good.header();
  header.frames[10].poses[0]->status = "INVALID";
  std::vector<cv::Mat> images(11, cv::Mat(100, 200, CV_8UC1, cv::Scalar(0)));
  const MemoryRecording recording("box.mha", header, images);
  const auto results = measure_structures({box_structure()}, recording, FrameLocator(recording, box_calibration()));
  EXPECT_EQ(results[0].measurement.sections, 10);
  ASSERT_FALSE(results[0].measurement.warnings.empty());
  EXPECT_NE(results[0].measurement.warnings[0].find("10"), std::string::npos);
}

}  // namespace
}  // namespace fathom
