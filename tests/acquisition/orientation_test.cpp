#include "acquisition/orientation.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

// Made by hand: M and U mark the sides of the probe, the row at the probe is N M . U; deeper there is only M.
const cv::Mat kMf = (cv::Mat_<uchar>(3, 4) << 'N', 'U', '.', 'M', '.', '.', '.', 'm', 'F', '.', '.', '.');

std::string file_with(const std::string& orientation, const std::string& pixels) {
  return "ObjectType = Image\nNDims = 2\nDimSize = 4 3\nElementType = MET_UCHAR\n" +
         (orientation.empty() ? "" : "UltrasoundImageOrientation = " + orientation + "\n") +
         "ElementDataFile = LOCAL\n" + pixels;
}

TEST(Orientation, FourStoredOrientationsGiveTheSameImage) {
  const TestFolder folder;
  for (const auto& [orientation, pixels] : {std::pair("MF", "NU.M...mF..."), std::pair("UF", "M.UNm......F"),
                                            std::pair("MN", "F......mNU.M"), std::pair("UN", "...Fm...M.UN")}) {
    for (const char* ending : {"", "A"}) {
      const auto recording =
          open_recording(folder.write("o.mha", file_with(std::string(orientation) + ending, pixels)));
      EXPECT_TRUE(same_pixels(recording->image(0), kMf)) << orientation;
      EXPECT_TRUE(recording->header().warnings.empty());
    }
  }
}

TEST(Orientation, WhereItIsMissingMfIsAssumedWithAWarning) {
  const TestFolder folder;
  for (const char* orientation : {"", "XX"}) {
    const auto recording = open_recording(folder.write("o.mha", file_with(orientation, "NU.M...mF...")));
    EXPECT_TRUE(same_pixels(recording->image(0), kMf));
    ASSERT_EQ(recording->header().warnings.size(), 1u);
    EXPECT_NE(recording->header().warnings[0].find("assumed MF"), std::string::npos);
  }
}

TEST(Orientation, OthersAreRefused) {
  const TestFolder folder;
  for (const char* orientation : {"FM", "NU", "MFD", "MFAA", "nonsense", "M"}) {
    expect_refused(folder.write("o.mha", file_with(orientation, "NU.M...mF...")), "only MF, MN, UF and UN");
  }
}

TEST(Orientation, WorksForEveryPixelTypeAndByteOrder) {
  const TestFolder folder;
  // 2 x 2 numbers 1 2 / 3 4, stored big-endian and UN: 4 3 / 2 1.
  const std::string head =
      "ObjectType = Image\nNDims = 3\nDimSize = 2 2 1\nBinaryDataByteOrderMSB = True\n"
      "UltrasoundImageOrientation = UNA\nElementType = ";
  const auto shorts = open_recording(
      folder.write("s.mha", head + "MET_SHORT\nElementDataFile = LOCAL\n" + std::string("\0\4\0\3\0\2\0\1", 8)));
  EXPECT_TRUE(same_pixels(shorts->image(0), (cv::Mat_<short>(2, 2) << 1, 2, 3, 4)));
  const std::string floats("\x40\x80\0\0\x40\x40\0\0\x40\0\0\0\x3F\x80\0\0", 16);
  const auto singles = open_recording(folder.write("f.mha", head + "MET_FLOAT\nElementDataFile = LOCAL\n" + floats));
  EXPECT_TRUE(same_pixels(singles->image(0), (cv::Mat_<float>(2, 2) << 1, 2, 3, 4)));
  const std::string zeros(4, '\0');
  const std::string doubles = std::string("\x40\x10\0\0", 4) + zeros + std::string("\x40\x08\0\0", 4) + zeros +
                              std::string("\x40\0\0\0", 4) + zeros + std::string("\x3F\xF0\0\0", 4) + zeros;
  const auto reals = open_recording(folder.write("d.mha", head + "MET_DOUBLE\nElementDataFile = LOCAL\n" + doubles));
  EXPECT_TRUE(same_pixels(reals->image(0), (cv::Mat_<double>(2, 2) << 1, 2, 3, 4)));
  const auto colours = open_recording(
      folder.write("c.mha", head + "MET_UCHAR\nElementNumberOfChannels = 3\nElementDataFile = LOCAL\nabcdefghijkl"));
  EXPECT_EQ(colours->image(0).at<cv::Vec3b>(0, 0), cv::Vec3b('j', 'k', 'l'));
  EXPECT_EQ(colours->image(0).at<cv::Vec3b>(0, 1), cv::Vec3b('g', 'h', 'i'));
  EXPECT_EQ(colours->image(0).at<cv::Vec3b>(1, 1), cv::Vec3b('a', 'b', 'c'));
}

}  // namespace
}  // namespace fathom
