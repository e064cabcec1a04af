#include "exam/report_picture.h"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "tests/exam/scan.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

const cv::Vec3b kGreen(0x20, 0xc0, 0x10);  // the structure's #10c020, in BGR
const cv::Vec3b kAmber(70, 180, 255);      // the highlighted frame

int count(const cv::Mat& picture, const cv::Vec3b& color) {
  cv::Mat same;
  cv::inRange(picture, color, color, same);
  return cv::countNonZero(same);
}

// In space the sections shine through each other, so that their colour is mixed.
int greenish(const cv::Mat& picture) {
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  cv::Mat most = (channels[1] > channels[0]) & (channels[1] > channels[2]);
  return cv::countNonZero(most);
}

TEST(ReportPicture, ShowsTheContourOnItsFrameAndAllContoursInSpace) {
  const MemoryRecording recording = box_recording();
  const FrameLocator locator(recording, box_calibration());
  const cv::Mat picture = report_picture(recording, locator, {box_structure()}, 5, {"a box"});
  ASSERT_EQ(picture.type(), CV_8UC3);
  const cv::Mat left = picture.colRange(0, picture.cols / 2);
  const cv::Mat right = picture.colRange(picture.cols / 2, picture.cols);
  EXPECT_GT(count(left, kGreen), 400);
  EXPECT_GT(greenish(right), 4000);
  EXPECT_GT(count(right, kAmber), 200);

  // The outline lies where the frame shows it: 200 pixels are 820 wide, so pixel 60 is at 40 + 60.5 * 4.1.
  std::vector<cv::Point> drawn;
  cv::Mat same;
  cv::inRange(left, kGreen, kGreen, same);
  cv::findNonZero(same, drawn);
  const cv::Rect box = cv::boundingRect(drawn);
  EXPECT_NEAR(box.x, 40 + 60.5 * 4.1, 3);
  EXPECT_NEAR(box.br().x, 40 + 100.5 * 4.1, 3);
  EXPECT_NEAR(box.height, 20 * 4.1, 4);
}

TEST(ReportPicture, NeedsAnOutlinedFrameWithAPose) {
  const MemoryRecording recording = box_recording();
  const FrameLocator locator(recording, box_calibration());
  EXPECT_THROW(report_picture(recording, locator, {Structure{}}, 5, {}), Error);
  EXPECT_THROW(report_picture(recording, locator, {box_structure()}, 11, {}), Error);
}

TEST(ReportPicture, PngReadsBackAsDrawn) {
  const ScratchFolder folder;
  const auto path = folder / "picture.png";
  cv::Mat picture(40, 60, CV_8UC3);
  cv::randu(picture, 0, 256);
  write_png(picture, path);
  const cv::Mat read = cv::imread(path.string());
  ASSERT_EQ(read.size(), picture.size());
  EXPECT_EQ(cv::norm(read, picture, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace fathom
