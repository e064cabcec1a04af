#include "acquisition/metaimage.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <zlib.h>

#include "acquisition/recording.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

const std::string kPose = " = 1 0 0 5  0 1 0 6  0 0 1 7  0 0 0 1 \n";

std::unique_ptr<Recording> open_text(const TestFolder& folder, const std::string& text) {
  return open_recording(folder.write("t.mha", text));
}

TEST(MetaImage, TheFilesFirstBytesDecideNotItsName) {
  const TestFolder folder;
  EXPECT_EQ(open_recording(folder.write("t.nrrd", tiny_metaimage(2)))->header().frame_count(), 2);
  EXPECT_EQ(open_recording(folder.write("noname", tiny_metaimage(2)))->header().frame_count(), 2);
}

TEST(MetaImage, WindowsLineEndsAndBlankLinesAreRead) {
  const TestFolder folder;
  std::string text = tiny_metaimage(2, "Seq_Frame0001_ProbeToTrackerTransform" + kPose + "\n");
  const std::size_t pixels = text.size() - 24;
  for (std::size_t at = pixels; at-- > 0;) {
    if (text[at] == '\n') text.insert(at, "\r");
  }
  const auto recording = open_text(folder, text);
  EXPECT_EQ(recording->image(1).at<uchar>(0, 0), 12);
  EXPECT_EQ(recording->header().frames[1].poses[0]->matrix(1, 3), 6.0);
  EXPECT_FALSE(recording->header().frames[0].poses[0].has_value());
}

TEST(MetaImage, NamesDecideWhatAFrameFieldIs) {
  const TestFolder folder;
  const auto recording = open_text(folder, tiny_metaimage(1,
                                                          "Seq_Frame0000_ATransformStatus = INVALID \n"
                                                          "Seq_Frame0000_ATransform" +
                                                              kPose +
                                                              "Seq_Frame0000_Timestamp = 1.50 \n"
                                                              "Seq_Frame0000_UnfilteredTimestamp = 2\n"
                                                              "Seq_Frame0000_Transform = any text\n"
                                                              "Seq_Frame0000_ImageStatus = INVALID\n"
                                                              "Seq_Frame0000_BTransformStatus = MISSING\n"
                                                              "Remark = a = b\n"));
  const RecordingHeader& header = recording->header();
  const FrameHeader& frame = header.frames[0];
  EXPECT_EQ(header.transforms, std::vector<std::string>{"A"});
  EXPECT_EQ(frame.poses[0]->status, "INVALID");
  EXPECT_FALSE(frame.poses[0]->valid());
  EXPECT_EQ(frame.time_s, 1.5);
  EXPECT_FALSE(frame.image_valid());
  // A status without a matrix is no pose.
  EXPECT_EQ(frame.fields,
            (std::vector<std::pair<std::string, std::string>>{
                {"UnfilteredTimestamp", "2"}, {"Transform", "any text"}, {"BTransformStatus", "MISSING"}}));
  EXPECT_EQ(header.fields, (std::vector<std::pair<std::string, std::string>>{{"Remark", "a = b"}}));
}

TEST(MetaImage, FrameNumbersMayHaveMoreThanFourDigits) {
  const TestFolder folder;
  std::string text =
      "ObjectType = Image\nNDims = 3\nDimSize = 1 1 10002\nElementType = MET_UCHAR\n"
      "Seq_Frame9999_Timestamp = 1\nSeq_Frame10001_Timestamp = 2\nElementDataFile = LOCAL\n";
  text.resize(text.size() + 10002);
  const auto recording = open_text(folder, text);
  EXPECT_EQ(recording->header().frames[9999].time_s, 1.0);
  EXPECT_FALSE(recording->header().frames[10000].time_s);
  EXPECT_EQ(recording->header().frames[10001].time_s, 2.0);
}

TEST(MetaImage, PixelsMayLieInAFileBesideOrBelowAfterAHeaderOfTheirOwn) {
  const TestFolder folder;
  std::filesystem::create_directory(folder / "below");
  folder.write("below/pixels.raw", "skipped" + std::string(12, 'a') + std::string(12, 'b'));
  std::string text = tiny_metaimage(2, "HeaderSize = 7\n");
  text.resize(text.find("LOCAL"));
  const auto recording = open_recording(folder.write("t.mhd", text + "below/pixels.raw"));
  EXPECT_EQ(recording->image(0).at<uchar>(2, 3), 'a');
  EXPECT_EQ(recording->image(1).at<uchar>(0, 0), 'b');
}

TEST(MetaImage, CompressedPixelsAreReadWithoutTheirStatedSize) {
  const TestFolder folder;
  std::string text = tiny_metaimage(3, "CompressedData = True\n");
  const std::string pixels = text.substr(text.size() - 36);
  std::string packed(100, '\0');
  uLongf length = packed.size();
  ASSERT_EQ(
      ::compress(reinterpret_cast<Bytef*>(packed.data()), &length, reinterpret_cast<const Bytef*>(pixels.data()), 36),
      Z_OK);
  text.resize(text.size() - 36);
  const auto recording = open_text(folder, text + packed.substr(0, length));
  EXPECT_EQ(recording->image(2).at<uchar>(2, 3), 35);
  EXPECT_EQ(recording->image(0).at<uchar>(0, 1), 1);
}

TEST(MetaImage, PosesAloneNeedNoPixelsNorTheirFile) {
  const TestFolder folder;
  const std::string text =
      "ObjectType = Image\nNDims = 3\nDimSize = 0 0 2\n"
      "Seq_Frame0000_ProbeToTrackerTransform" +
      kPose + "Seq_Frame0001_ProbeToTrackerTransform" + kPose;
  for (const std::string& ending : {std::string(), std::string("ElementDataFile = LOCAL\n")}) {
    const auto recording = open_text(folder, text + ending);
    EXPECT_EQ(recording->header().frame_count(), 2);
    EXPECT_FALSE(recording->header().has_images());
    EXPECT_TRUE(recording->header().warnings.empty());
  }
}

TEST(MetaImage, OneImageAndFlatVolumesAreFrames) {
  const TestFolder folder;
  const auto one = open_text(folder,
                             "ObjectType = Image\nNDims = 2\nDimSize = 2 1\nElementType = MET_UCHAR\n"
                             "ElementDataFile = LOCAL\nab");
  EXPECT_EQ(one->header().frame_count(), 1);
  EXPECT_EQ(one->image(0).at<uchar>(0, 1), 'b');
  const auto two = open_text(folder,
                             "ObjectType = Image\nNDims = 4\nDimSize = 2 1 1 2\nElementType = MET_UCHAR\n"
                             "ElementDataFile = LOCAL\nabcd");
  EXPECT_EQ(two->image(1).at<uchar>(0, 1), 'd');
}

TEST(MetaImage, ColoursMayBeAnAxisAsPlusWritesThem) {
  const TestFolder folder;
  const std::string text =
      "ObjectType = Image\nNDims = 3\nDimSize = 3 2 1       2\nElementNumberOfChannels = 3\n"
      "ElementType = MET_UCHAR\nKinds = vector domain domain  list\nElementDataFile = LOCAL\nabcdefghijkl";
  const auto recording = open_text(folder, text);
  EXPECT_EQ(recording->header().pixel_type, CV_8UC3);
  EXPECT_EQ(recording->header().width, 2);
  EXPECT_EQ(recording->image(1).at<cv::Vec3b>(0, 1), cv::Vec3b('j', 'k', 'l'));
  std::string wrong = text;
  expect_refused(folder.write("w.mha", wrong.replace(wrong.find("Channels = 3"), 12, "Channels = 1")), "Channels");
}

TEST(MetaImage, AxesInAnotherOrderAreRefusedNotMisread) {
  const TestFolder folder;
  expect_refused(folder.write("t.mha", tiny_metaimage(2, "Kinds = list domain domain\n")), "in this order");
  expect_refused(folder.write("t.mha", tiny_metaimage(2, "Kinds = domain list\n")), "kinds");
  EXPECT_NO_THROW(open_text(folder, tiny_metaimage(2, "Kinds = domain domain list\n")));
}

TEST(MetaImage, AnInvalidPoseMayHoldAnyFiniteNumbersAndAnImagePoseAnyScale) {
  const TestFolder folder;
  const auto recording = open_text(folder, tiny_metaimage(1,
                                                          "Seq_Frame0000_ATransform = 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"
                                                          "Seq_Frame0000_ATransformStatus = INVALID\n"
                                                          "Seq_Frame0000_ImageToProbeTransform = 0.1 0 0 1 0 0.2 0 2 0 "
                                                          "0 0.15 3 0 0 0 1\n"));
  EXPECT_EQ(recording->header().frames[0].poses[0]->matrix(3, 3), 0.0);
  EXPECT_EQ(recording->header().frames[0].poses[1]->matrix(1, 1), 0.2);
}

TEST(MetaImage, IsWrittenAsPlusAndMetaIoExpectIt) {
  const TestFolder folder;
  write_recording(sample_recording({.smooth = true}), folder / "r.mha", {.compress = true});
  const std::string text = read_bytes(folder / "r.mha");
  EXPECT_TRUE(text.starts_with("ObjectType = Image\nNDims = 3\n"));
  EXPECT_NE(text.find("\nDimSize = 37 23 11\nKinds = domain domain list\n"), std::string::npos);
  EXPECT_NE(text.find("\nUltrasoundImageOrientation = MFA\n"), std::string::npos);
  EXPECT_NE(text.find("\nSeq_Frame0000_ProbeToTrackerTransform = "), std::string::npos);
  // The size of the stream is what remains of the file behind the header's last line.
  const std::string last = "\nElementDataFile = LOCAL\n";
  const std::size_t pixels = text.find(last) + last.size();
  const std::size_t size = text.find("\nCompressedDataSize = ") + 22;
  EXPECT_EQ(std::stoull(text.substr(size)), text.size() - pixels);
  std::string inflated(37 * 23 * 11, '\0');
  uLongf length = inflated.size();
  EXPECT_EQ(::uncompress(reinterpret_cast<Bytef*>(inflated.data()), &length,
                         reinterpret_cast<const Bytef*>(text.data() + pixels), text.size() - pixels),
            Z_OK);
  EXPECT_EQ(length, inflated.size());
}

}  // namespace
}  // namespace fathom
