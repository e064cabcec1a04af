#include "segmentation/threshold_recording.h"

#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "core/error.h"

namespace fathom {
namespace {

// Frame i shows a square of side i + 3; `invalid` frames are marked so.
MemoryRecording squares(int frames, const std::set<int>& invalid, int type = CV_8UC1) {
  RecordingHeader header;
  header.width = 40;
  header.height = 30;
  header.pixel_type = type;
  std::vector<cv::Mat> images;
  for (int i = 0; i < frames; ++i) {
    FrameHeader frame;
    frame.time_s = 0.1 * i;
    if (invalid.count(i) > 0) frame.image_status = "INVALID";
    header.frames.push_back(frame);
    images.push_back(cv::Mat::zeros(30, 40, type));
    images.back()(cv::Rect(4, 4, i + 3, i + 3)).setTo(cv::Scalar::all(255));
  }
  return MemoryRecording("squares.mha", header, images);
}

std::vector<int> outlined(const Structure& structure) {
  std::vector<int> frames;
  for (const Contour& contour : structure.contours) frames.push_back(contour.frame);
  return frames;
}

TEST(SegmentByThreshold, OutlinesEveryNthFrameFromTheFirstValidOne) {
  ThresholdRecordingOptions options;
  options.every = 4;
  options.structure = "prism";
  const Structure structure = segment_by_threshold(squares(20, {0, 1, 6}), options);
  EXPECT_EQ(structure.name, "prism");
  EXPECT_EQ(outlined(structure), (std::vector<int>{2, 10, 14, 18}));
  EXPECT_DOUBLE_EQ(structure.contours[0].points_px[0].x(), 3.5);
  options.every = std::numeric_limits<int>::max();
  EXPECT_EQ(outlined(segment_by_threshold(squares(5, {}), options)), (std::vector<int>{0}));
  EXPECT_TRUE(segment_by_threshold(squares(3, {0, 1, 2}), options).contours.empty());
}

TEST(SegmentByThreshold, OutlinesTheFirstAndLastFrameThatShowTheStructureWhereAsked) {
  RecordingHeader header;
  header.width = header.height = 20;
  header.pixel_type = CV_8UC1;
  header.frames.resize(40);
  header.frames[8].image_status = "INVALID";
  std::vector<cv::Mat> images;
  for (int i = 0; i < 40; ++i) {
    images.push_back(cv::Mat::zeros(20, 20, CV_8UC1));
    if (i >= 7 && i <= 33) images.back()(cv::Rect(2, 2, 10, 10)).setTo(255);
    if (i == 20) images.back()(cv::Rect(15, 15, 4, 4)).setTo(255);
  }
  ThresholdRecordingOptions options;
  options.every = 10;
  const MemoryRecording recording("slab.mha", header, images);
  EXPECT_EQ(outlined(segment_by_threshold(recording, options)), (std::vector<int>{10, 20, 20, 30}));
  options.ends = true;
  const Structure structure = segment_by_threshold(recording, options);
  EXPECT_EQ(outlined(structure), (std::vector<int>{7, 10, 20, 20, 30, 33}));
  EXPECT_EQ(outlined_frames(structure), 5);
}

TEST(SegmentByThreshold, CanBeStopped) {
  int calls = 0;
  const auto stop = [&](double fraction) {
    EXPECT_GE(fraction, 0.0);
    EXPECT_LE(fraction, 1.0);
    return ++calls < 3;
  };
  EXPECT_THROW(segment_by_threshold(squares(20, {}), {}, stop), Cancelled);
  EXPECT_EQ(calls, 3);
}

TEST(SegmentByThreshold, RefusesColourPosesOnlyAndBadOptions) {
  EXPECT_THROW(segment_by_threshold(squares(3, {}, CV_8UC3), {}), Error);
  EXPECT_THROW(segment_by_threshold(MemoryRecording("poses.mha", RecordingHeader(), {}), {}), Error);
  ThresholdRecordingOptions options;
  options.every = 0;
  EXPECT_THROW(segment_by_threshold(squares(3, {}), options), Error);
  options.every = 1;
  for (const std::string& unreadable : {std::string(), std::string("a\nb"), std::string(1000, 'a')}) {
    options.structure = unreadable;  // would make a contours file that cannot be read back
    EXPECT_THROW(segment_by_threshold(squares(3, {}), options), Error);
  }
}

}  // namespace
}  // namespace fathom
