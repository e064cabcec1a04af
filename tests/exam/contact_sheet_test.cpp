#include "exam/contact_sheet.h"

#include <set>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "tests/exam/scan.h"

namespace fathom {
namespace {

// Lines a pixel wide are blended with the image, here black.
int green(const cv::Mat& picture) {
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  return cv::countNonZero((channels[1] > 40) & (channels[1] > 2 * channels[0]) & (channels[1] > 2 * channels[2]));
}

TEST(ContactSheet, ShowsEveryOutlinedFrameInItsPane) {
  const MemoryRecording recording = box_recording();
  Structure structure = box_structure();
  ContactSheetOptions options;
  options.columns = 100;
  const cv::Mat sheet = contact_sheet(recording, {structure}, options);
  std::set<int> frames;
  for (const Contour& contour : structure.contours) frames.insert(contour.frame);
  const int pane = options.pane_px + 12;
  ASSERT_EQ(sheet.cols, 12 + pane * static_cast<int>(frames.size()));
  for (int i = 0; i < static_cast<int>(frames.size()); ++i) {
    EXPECT_GT(green(sheet.colRange(12 + i * pane, 12 + i * pane + options.pane_px)), 100) << i;
  }
  options.most_frames = 2;
  EXPECT_EQ(contact_sheet(recording, {structure}, options).cols, 12 + 2 * pane);
}

TEST(ContactSheet, LeavesOutOtherRecordingsAndRefusesFramesThatAreNotThere) {
  const MemoryRecording recording = box_recording();
  Structure structure = box_structure();
  for (Contour& contour : structure.contours) contour.recording = 1;
  EXPECT_THROW(contact_sheet(recording, {structure}), Error);
  ContactSheetOptions options;
  options.also = {0};
  EXPECT_EQ(green(contact_sheet(recording, {structure}, options)), 0);
  structure.contours[0].recording = 0;
  structure.contours[0].frame = 1000;
  EXPECT_THROW(contact_sheet(recording, {structure}), Error);
}

}  // namespace
}  // namespace fathom
