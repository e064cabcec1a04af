#include "acquisition/nrrd.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "acquisition/recording.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

std::unique_ptr<Recording> open_text(const TestFolder& folder, const std::string& text) {
  return open_recording(folder.write("t.nrrd", text));
}

std::string field_of(const Recording& recording, const std::string& name) {
  for (const auto& [field, value] : recording.header().fields) {
    if (field == name) return value;
  }
  return "missing";
}

TEST(Nrrd, FieldsAndKeyValuePairsAreRead) {
  const TestFolder folder;
  const auto recording = open_text(folder,
                                   "NRRD0005\r\n# comment: with a colon\r\ntype: unsigned short int\r\n"
                                   "dimension: 3\r\nsizes: 2 1 2\r\nencoding: raw\r\nendian: big\r\n"
                                   "space dimension: 2\r\nspace directions: (0.3,0.4) (0,0.25) none\r\n"
                                   "space origin: (1,-2)\r\nultrasound image orientation:=UFA\r\n"
                                   "ultrasound image type:=BRIGHTNESS\r\ncontent: a:=b\r\nOperator:=M. C\r\n"
                                   "Seq_Frame0001_Timestamp:=2.5\r\nSeq_Frame0001_Status:=INVALID\r\n\r\n" +
                                       std::string("\0\1\0\2\0\3\0\4", 8));
  EXPECT_EQ(recording->image(1).at<std::uint16_t>(0, 0), 4);
  EXPECT_EQ(recording->header().frames[1].time_s, 2.5);
  EXPECT_FALSE(recording->header().frames[1].image_valid());
  EXPECT_TRUE(recording->header().frames[0].image_valid());
  EXPECT_EQ(field_of(*recording, "ElementSpacing"), "0.5 0.25 1");
  EXPECT_EQ(field_of(*recording, "Offset"), "1 -2 0");
  EXPECT_EQ(field_of(*recording, "UltrasoundImageType"), "BRIGHTNESS");
  EXPECT_EQ(field_of(*recording, "Operator"), "M. C");
  EXPECT_EQ(field_of(*recording, "content"), "a:=b");
}

TEST(Nrrd, ColoursAreTheFirstAxis) {
  const TestFolder folder;
  for (const char* kind : {"vector", "RGB-color", "3-color"}) {
    const auto recording = open_text(
        folder, "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 2 1 2\nencoding: raw\nkinds: " + std::string(kind) +
                    " domain domain list\n\nabcdefghijkl");
    EXPECT_EQ(recording->header().pixel_type, CV_8UC3);
    EXPECT_EQ(recording->image(1).at<cv::Vec3b>(0, 0), cv::Vec3b('g', 'h', 'i'));
    const auto single = open_text(folder, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 2 1\nencoding: raw\nkinds: " +
                                              std::string(kind) + " domain domain\n\nabcdef");
    EXPECT_EQ(single->header().frame_count(), 1);
    EXPECT_EQ(single->image(0).at<cv::Vec3b>(0, 1), cv::Vec3b('d', 'e', 'f'));
  }
}

TEST(Nrrd, FramesThatAreNotTheLastAxisAreRefused) {
  const TestFolder folder;
  expect_refused(folder.write("t.nrrd",
                              "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 2 1\nencoding: raw\n"
                              "kinds: list domain domain\n\nabcdef"),
                 "in this order");
}

TEST(Nrrd, PixelsMayLieInAFileBeside) {
  const TestFolder folder;
  folder.write("p.raw", "..abcd");
  const auto recording = open_text(folder,
                                   "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 2\nencoding: raw\n"
                                   "byte skip: 2\ndata file: p.raw\n");
  EXPECT_EQ(recording->image(1).at<uchar>(0, 1), 'd');
}

TEST(Nrrd, RepeatedFieldsAreHarmlessUnlessTheyDisagree) {
  const TestFolder folder;
  const std::string head =
      "NRRD0004\ntype: uint8\ndimension: 2\nsizes: 2 1\nencoding: raw\n"
      "ultrasound image orientation: UF\nultrasound image orientation:=";
  EXPECT_EQ(open_text(folder, head + "UF\n\nab")->image(0).at<uchar>(0, 0), 'b');
  expect_refused(folder.write("t.nrrd", head + "MF\n\nab"), "given twice");
}

TEST(Nrrd, AMissingByteOrderIsAssumedWithAWarning) {
  const TestFolder folder;
  const auto recording = open_text(folder,
                                   "NRRD0004\ntype: int16\ndimension: 2\nsizes: 2 1\nencoding: raw\n"
                                   "ultrasound image orientation:=MF\n\n" +
                                       std::string("\1\0\2\0", 4));
  EXPECT_EQ(recording->image(0).at<short>(0, 1), 2);
  ASSERT_EQ(recording->header().warnings.size(), 1u);
}

TEST(Nrrd, IsWrittenAsPlusAndTeemExpectIt) {
  const TestFolder folder;
  write_recording(sample_recording({.pixel_type = CV_8UC3}), folder / "r.nrrd", {.compress = true});
  const std::string text = read_bytes(folder / "r.nrrd");
  EXPECT_TRUE(text.starts_with("NRRD0004\n#"));
  EXPECT_NE(text.find("\ndimension: 4\nencoding: gz\nendian: little\nkinds: vector domain domain list\n"
                      "sizes: 3 37 23 11\nspace dimension: 2\nspace directions: none (0.3,0) (0,0.2) none\n"
                      "space origin: (1.5,-2)\ntype: uint8\nultrasound image orientation:=MFA\n"),
            std::string::npos);
  EXPECT_NE(text.find("\nSeq_Frame0002_Status:=INVALID\n"), std::string::npos);
  const std::size_t pixels = text.find("\n\n") + 2;
  EXPECT_EQ(text.substr(pixels, 2), "\x1F\x8B");
}

}  // namespace
}  // namespace fathom
