#include <algorithm>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <unistd.h>

#include "acquisition/recording.h"
#include "core/error.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

constexpr std::uint64_t kMegabyte = 1 << 20;

std::uint64_t resident_bytes() {
  std::ifstream status("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  status >> all >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// A header for `frames` frames of 640 x 480 bytes with three transforms each, as a tracker with four-digit frames
/// gives.
std::string long_header(int frames) {
  std::ostringstream text;
  text << "ObjectType = Image\nNDims = 3\nDimSize = 640 480 " << frames
       << "\nElementType = MET_UCHAR\nUltrasoundImageOrientation = MFA\n";
  for (int f = 0; f < frames; ++f) {
    char prefix[32];
    std::snprintf(prefix, sizeof prefix, "Seq_Frame%04d_", f);
    for (const char* name : {"ProbeToTracker", "ReferenceToTracker", "StylusToTracker"}) {
      text << prefix << name << "Transform = 0.36 0.48 -0.8 10.125 -0.8 0.6 0 -20.25 0.48 0.64 0.6 " << f
           << " 0 0 0 1\n"
           << prefix << name << "TransformStatus = OK\n";
    }
    text << prefix << "Timestamp = " << f / 30.0 << "\n" << prefix << "ImageStatus = OK\n";
  }
  text << "ElementDataFile = LOCAL\n";
  return text.str();
}

TEST(MappedRecording, OfOneAndAHalfGigabytesTakesTheMemoryOfAFewFrames) {
  const TestFolder folder;
  constexpr int kFrames = 5000;
  constexpr std::uint64_t kFrameBytes = 640 * 480;
  const std::string header = long_header(kFrames);
  const auto path = folder.write("long.mha", header);
  std::filesystem::resize_file(path, header.size() + kFrames * kFrameBytes);  // a hole: takes no disk
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(header.size() + 4321 * kFrameBytes + 640 * 7 + 5));
    file.put('\x2A');
  }
  const std::uint64_t before = resident_bytes();
  const auto recording = open_recording(path);
  const cv::Mat first = recording->image(0);
  EXPECT_EQ(cv::countNonZero(first), 0);
  EXPECT_EQ(recording->image(4321).at<uchar>(7, 5), 42);
  EXPECT_LT(resident_bytes(), before + 100 * kMegabyte);
}

TEST(MappedRecording, ReadingAllOfItKeepsMemoryBounded) {
  const TestFolder folder;
  const auto path = folder.write("long.mha", long_header(1500));
  std::filesystem::resize_file(path, std::filesystem::file_size(path) + 1500ull * 640 * 480);
  const auto recording = open_recording(path);
  const cv::Mat kept = recording->image(17);
  const std::uint64_t before = resident_bytes();
  std::uint64_t most = before;
  for (int f = 0; f < 1500; ++f) {
    const cv::Mat image = recording->image(f);
    for (int y = 0; y < image.rows; y += 6) ASSERT_EQ(image.at<uchar>(y, 0), 0);
    if (f % 50 == 0) most = std::max(most, resident_bytes());
  }
  EXPECT_LT(most, before + 320 * kMegabyte);
  EXPECT_EQ(cv::countNonZero(kept), 0);  // a view outlives the pages under it
}

TEST(MappedRecording, FramesAreViewsOfTheFileWhereNoConversionIsNeeded) {
  const TestFolder folder;
  for (const int type : {CV_8UC1, CV_16SC1, CV_64FC1, CV_8UC3}) {
    const MemoryRecording original =
        sample_recording({.width = 1021, .height = 1019, .frames = 10, .pixel_type = type, .smooth = true});
    for (const char* name : {"r.mha", "r.mhd", "r.nrrd"}) {
      write_recording(original, folder / name);
      const auto recording = open_recording(folder / name);
      const cv::Mat image = recording->image(3);
      EXPECT_TRUE(image.u == nullptr) << name << ": the pixels were copied";
      EXPECT_EQ(image.data, recording->image(3).data);
      EXPECT_TRUE(same_pixels(image, original.image(3)));
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(image.data) % image.elemSize1(), 0u);
    }
  }
}

TEST(MappedRecording, PixelsAtAnOddPlaceAreCopied) {
  const TestFolder folder;
  std::string head =
      "ObjectType = Image\nNDims = 3\nDimSize = 2000 1500 3\nElementType = MET_USHORT\n"
      "UltrasoundImageOrientation = MF\nElementDataFile = LOCAL\n";
  if (head.size() % 2 == 0) head.insert(head.find("MF\n"), " ");
  std::string pixels(2000 * 1500 * 3 * 2, '\0');
  pixels[2000 * 1500 * 2 + 2] = 7;
  const auto recording = open_recording(folder.write("odd.mha", head + pixels));
  EXPECT_EQ(recording->image(1).at<std::uint16_t>(0, 1), 7);
  EXPECT_EQ(cv::countNonZero(recording->image(0)), 0);
}

TEST(MappedRecording, ASmallFileThatIsCutWhileOpenGivesAnError) {
  const TestFolder folder;
  const auto path = folder.write("r.mha", tiny_metaimage(5));
  const auto recording = open_recording(path);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 1);
  EXPECT_NO_THROW(recording->image(3));
  EXPECT_THROW(recording->image(4), Error);
}

}  // namespace
}  // namespace fathom
