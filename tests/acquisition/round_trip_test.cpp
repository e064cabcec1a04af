#include <tuple>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "acquisition/recording.h"
#include "core/error.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

using Case = std::tuple<int, std::string, bool>;  // pixel type, extension, compressed

class RoundTrip : public testing::TestWithParam<Case> {};

TEST_P(RoundTrip, KeepsPixelsPosesTimesStatusesAndFields) {
  const auto& [type, extension, compress] = GetParam();
  const TestFolder folder;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const MemoryRecording original = sample_recording({.width = 30 + static_cast<int>(seed),
                                                       .height = 20,
                                                       .frames = 9 + static_cast<int>(seed),
                                                       .pixel_type = type,
                                                       .seed = seed});
    const auto path = folder / ("r" + extension);
    write_recording(original, path, {.compress = compress});
    const auto read = open_recording(path);
    expect_same(*read, original);
    EXPECT_TRUE(read->header().warnings.empty());
    EXPECT_EQ(read->name(), path.string());
  }
}

INSTANTIATE_TEST_SUITE_P(All, RoundTrip,
                         testing::Combine(testing::Values(CV_8UC1, CV_8SC1, CV_16UC1, CV_16SC1, CV_32FC1, CV_64FC1,
                                                          CV_8UC3),
                                          testing::Values(".mha", ".mhd", ".nrrd"), testing::Bool()));

class PosesOnlyRoundTrip : public testing::TestWithParam<Case> {};

TEST_P(PosesOnlyRoundTrip, KeepsEverything) {
  const auto& [type, extension, compress] = GetParam();
  const TestFolder folder;
  const MemoryRecording original = sample_recording({.width = 0, .height = 0, .frames = 40, .pixel_type = type});
  write_recording(original, folder / ("r" + extension), {.compress = compress});
  const auto read = open_recording(folder / ("r" + extension));
  expect_same(*read, original);
  EXPECT_FALSE(read->header().has_images());
  EXPECT_THROW(read->image(0), Error);
}

INSTANTIATE_TEST_SUITE_P(All, PosesOnlyRoundTrip,
                         testing::Combine(testing::Values(CV_8UC1), testing::Values(".mha", ".mhd", ".nrrd"),
                                          testing::Bool()));

TEST(RoundTripChain, ThroughAllFormatsEndsWithTheSameBytes) {
  const TestFolder folder;
  write_recording(sample_recording({.pixel_type = CV_16UC1}), folder / "1.mha");
  write_recording(*open_recording(folder / "1.mha"), folder / "2.nrrd", {.compress = true});
  write_recording(*open_recording(folder / "2.nrrd"), folder / "3.mhd", {.compress = true});
  write_recording(*open_recording(folder / "3.mhd"), folder / "4.nrrd");
  write_recording(*open_recording(folder / "4.nrrd"), folder / "5.mha");
  EXPECT_EQ(read_bytes(folder / "1.mha"), read_bytes(folder / "5.mha"));
}

TEST(RoundTripOrientation, ConvertedRecordingsAreStoredAsMf) {
  const TestFolder folder;
  std::string text = tiny_metaimage(2);
  text.replace(text.find("MFA"), 3, "UNA");
  const auto turned = open_recording(folder.write("turned.mha", text));
  write_recording(*turned, folder / "straight.nrrd");
  expect_same(*open_recording(folder / "straight.nrrd"), *turned);
  EXPECT_EQ(turned->image(0).at<uchar>(0, 0), 11);
}

TEST(WriteRecording, MoreThanTenThousandFramesKeepTheirOrder) {
  const TestFolder folder;
  RecordingHeader header;
  header.transforms = {"ProbeToTracker"};
  for (int f = 0; f < 10003; ++f) {
    Pose pose;
    pose.matrix(0, 3) = f;
    FrameHeader frame;
    frame.time_s = f / 60.0;
    frame.poses = {pose};
    header.frames.push_back(frame);
  }
  const MemoryRecording original("long", header, {});
  for (const char* name : {"long.mha", "long.nrrd"}) {
    write_recording(original, folder / name);
    expect_same(*open_recording(folder / name), original);
  }
}

TEST(WriteRecording, LinesAndSeparatorsInsideFieldsCannotBreakAFile) {
  const TestFolder folder;
  RecordingHeader header = sample_recording({.frames = 2}).header();
  header.width = header.height = 0;
  header.fields = {{"A = b\n:# c", "one\ntwo"}, {"DimSize", "1 1 1"}, {"sizes", "5"}};
  header.frames[0].fields = {{"x=y", "z\r\nElementDataFile = LOCAL"}, {"Status", "frozen"}};
  header.frames[1].fields.clear();
  header.frames[1].image_status.clear();
  for (const char* name : {"f.mha", "f.mhd", "f.nrrd"}) {
    write_recording(MemoryRecording("fields", header, {}), folder / name);
    const auto read = open_recording(folder / name);
    EXPECT_EQ(read->header().frame_count(), 2);
    EXPECT_TRUE(read->header().frames[0].poses == header.frames[0].poses);
    EXPECT_EQ(read->header().frames[0].image_status, "OK");
    EXPECT_EQ(read->header().frames[0].fields[1], (std::pair<std::string, std::string>("Status", "frozen")));
    EXPECT_EQ(read->header().fields[0].second, "one two");
  }
}

TEST(WriteRecording, UnknownExtensionIsRefusedAndNothingIsWritten) {
  const TestFolder folder;
  for (const char* name : {"r.avi", "r", "r.mha.txt"}) {
    EXPECT_THROW(write_recording(sample_recording(), folder / name), Error);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(WriteRecording, PixelFilesGetOnlyNamesThatAHeaderCanHold) {
  const TestFolder folder;
  for (const char* name : {"50%.mhd", "LIST.mhd", "two\nlines.mhd", "back\\slash.mhd", " blank.mhd"}) {
    EXPECT_THROW(write_recording(sample_recording(), folder / name), Error) << name;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  for (const char* name : {"list of scans.mhd", "caf\xC3\xA9.mhd", "a=b.mhd"}) {
    write_recording(sample_recording(), folder / name);
    expect_same(*open_recording(folder / name), sample_recording());
  }
}

TEST(WriteRecording, WhatCouldNotBeReadBackIsRefused) {
  const TestFolder folder;
  RecordingHeader header = sample_recording({.width = 0, .height = 0}).header();
  header.frames[2].poses[0]->matrix(1, 1) = 2.0;
  EXPECT_THROW(write_recording(MemoryRecording("r", header, {}), folder / "r.mha"), Error);
  header = sample_recording({.width = 0, .height = 0}).header();
  header.frames[2].time_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_recording(MemoryRecording("r", header, {}), folder / "r.mha"), Error);
  header.frames.clear();
  EXPECT_THROW(write_recording(MemoryRecording("r", header, {}), folder / "r.mha"), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// Fails while its third frame is read.
class FailingRecording : public Recording {
 public:
  FailingRecording() : Recording("failing", sample_recording().header()) {}
  cv::Mat image(int frame) const override {
    if (frame == 3) throw Error("failing: the cable came off; plug it in");
    return cv::Mat(header_.height, header_.width, header_.pixel_type, cv::Scalar(1));
  }
};

TEST(WriteRecording, FaultOrCancellationLeavesTheOldFilesAndNoOthers) {
  const TestFolder folder;
  for (const char* name : {"r.mha", "r.mhd", "r.nrrd"}) {
    for (const bool compress : {false, true}) {
      write_recording(sample_recording(), folder / name, {.compress = compress});
      const auto count_files = [&] {
        return std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator());
      };
      const std::string before = read_bytes(folder / name);
      const auto files_before = count_files();
      EXPECT_THROW(write_recording(FailingRecording(), folder / name, {.compress = compress}), Error);
      EXPECT_THROW(write_recording(sample_recording({.seed = 2}), folder / name, {.compress = compress},
                                   [](double fraction) { return fraction < 0.5; }),
                   Cancelled);
      EXPECT_EQ(read_bytes(folder / name), before);
      EXPECT_EQ(count_files(), files_before);
      expect_same(*open_recording(folder / name), sample_recording());
    }
  }
}

TEST(WriteRecording, ARecordingMayReplaceItsOwnFile) {
  const TestFolder folder;
  write_recording(sample_recording({.width = 1024, .height = 1024}), folder / "r.mha");
  const auto read = open_recording(folder / "r.mha");
  write_recording(*read, folder / "r.mha", {.compress = true});
  expect_same(*open_recording(folder / "r.mha"), *read);
}

TEST(MemoryRecording, RefusesImagesThatDoNotFitItsHeader) {
  const MemoryRecording sample = sample_recording({.frames = 2});
  const cv::Mat image = sample.image(0);
  EXPECT_NO_THROW(MemoryRecording("m", sample.header(), {image, image}));
  EXPECT_THROW(MemoryRecording("m", sample.header(), {image}), Error);
  EXPECT_THROW(MemoryRecording("m", sample.header(), {image, image.t()}), Error);
  RecordingHeader header = sample.header();
  header.frames[1].poses.pop_back();
  EXPECT_THROW(MemoryRecording("m", header, {image, image}), Error);
  EXPECT_THROW(sample.image(2), Error);
  EXPECT_THROW(sample.image(-1), Error);
}

}  // namespace
}  // namespace fathom
