// Recordings of real scanners and trackers, made by others; see the README beside them.
#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <zlib.h>

#include "acquisition/recording.h"
#include "tests/acquisition/sample_recording.h"
#include "tests/real_recordings.h"

namespace fathom {
namespace {

const std::filesystem::path kFolder = real_recordings();

struct Facts {
  const char* file;
  int width, height, frames, pixel_type;
  std::size_t transforms;
  double first_time_s, last_time_s;
  unsigned long adler;  ///< of all pixels, inflated by an independent program
};

/// For the names of the tests, in place of the bytes.
void PrintTo(const Facts& facts, std::ostream* stream) { *stream << facts.file; }

class PlusRecordings : public testing::TestWithParam<Facts> {
 protected:
  void SetUp() override { FATHOM_NEEDS_REAL_RECORDINGS(); }
};

unsigned long adler_of_pixels(const Recording& recording) {
  uLong sum = ::adler32(0, nullptr, 0);
  for (int f = 0; f < recording.header().frame_count(); ++f) {
    const cv::Mat image = recording.image(f);
    sum = ::adler32(sum, image.data, static_cast<uInt>(image.total() * image.elemSize()));
  }
  return sum;
}

TEST_P(PlusRecordings, HaveTheKnownSizesTimesAndPixels) {
  const Facts& facts = GetParam();
  const auto recording = open_recording(kFolder / facts.file);
  const RecordingHeader& header = recording->header();
  EXPECT_EQ(header.width, facts.width);
  EXPECT_EQ(header.height, facts.height);
  ASSERT_EQ(header.frame_count(), facts.frames);
  EXPECT_EQ(header.pixel_type, facts.pixel_type);
  EXPECT_EQ(header.transforms.size(), facts.transforms);
  EXPECT_TRUE(header.warnings.empty());
  EXPECT_EQ(header.frames.front().time_s, facts.first_time_s);
  EXPECT_EQ(header.frames.back().time_s, facts.last_time_s);
  EXPECT_EQ(adler_of_pixels(*recording), facts.adler);
  for (const FrameHeader& frame : header.frames) EXPECT_TRUE(frame.image_valid());
}

TEST_P(PlusRecordings, SurviveEveryFormat) {
  const TestFolder folder;
  const auto original = open_recording(kFolder / GetParam().file);
  for (const char* name : {"r.mha", "r.mhd", "r.nrrd"}) {
    write_recording(*original, folder / name);
    expect_same(*open_recording(folder / name), *original);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, PlusRecordings,
    testing::Values(Facts{"SpinePhantomFreehand.igs.mha", 820, 616, 21, CV_8UC1, 3, 215.102186, 216.947186, 0xaecf96db},
                    Facts{"NwirePhantomFreehand.igs.mha", 820, 616, 97, CV_8UC1, 3, 345.627957, 355.783014, 0x756d1985},
                    Facts{"fCal_Test_Calibration_3NWires_fCal2.0.igs.mha", 820, 616, 190, CV_8UC1, 3, 2572.905343,
                          2588.069843, 0x27af8e68},
                    Facts{"fCal_Test_Validation_3NWires_fCal2.0.igs.mha", 820, 616, 103, CV_8UC1, 3, 2588.141729,
                          2596.109214, 0x3280a22c},
                    Facts{"SyntheticVideoBuffer20.igs.mha", 320, 240, 20, CV_8UC1, 1, 0.5, 10.0, 0xb38859ed},
                    Facts{"SyntheticTrackerBuffer20.igs.mha", 1, 1, 20, CV_8UC1, 1, 1.0, 10.5, 0x277403c1}),
    [](const auto& test) {
      std::string name = test.param.file;
      return name.substr(0, name.find("_3N") < name.find('.') ? name.find("_3N") : name.find('.'));
    });

TEST_F(PlusRecordings, ANwireSweepHasEveryProbePoseAndNoStylus) {
  const auto recording = open_recording(kFolder / "NwirePhantomFreehand.igs.mha");
  const RecordingHeader& header = recording->header();
  EXPECT_EQ(header.transforms, (std::vector<std::string>{"ProbeToTracker", "ReferenceToTracker", "StylusToTracker"}));
  int probe = 0, stylus = 0;
  for (const FrameHeader& frame : header.frames) {
    probe += frame.poses[0] && frame.poses[0]->valid();
    stylus += frame.poses[2] && frame.poses[2]->valid();
  }
  EXPECT_EQ(probe, 97);
  EXPECT_EQ(stylus, 0);
  const Pose& first = *header.frames[0].poses[0];
  EXPECT_EQ(first.matrix(0, 3), -190.886);
  EXPECT_EQ(first.matrix(2, 1), 0.0635588);
  EXPECT_EQ(header.frames[0].poses[2]->matrix(0, 1), -8.43482e-5);  // written as e-005
}

TEST_F(PlusRecordings, TrackerBufferKeepsItsOtherFields) {
  const auto recording = open_recording(kFolder / "SyntheticTrackerBuffer20.igs.mha");
  const FrameHeader& frame = recording->header().frames[3];
  EXPECT_EQ(frame.poses[0]->status, "OK");  // "OK " in the file, and before its matrix
  EXPECT_EQ(frame.poses[0]->matrix(0, 1), 0.48);
  EXPECT_EQ(frame.fields,
            (std::vector<std::pair<std::string, std::string>>{{"FrameNumber", "4"}, {"UnfilteredTimestamp", "2.5"}}));
}

TEST_F(PlusRecordings, ASingleNrrdImageIsOneFrame) {
  const auto recording = open_recording(kFolder / "NrrdSample.igs.nrrd");
  const RecordingHeader& header = recording->header();
  EXPECT_EQ(header.width, 256);
  EXPECT_EQ(header.height, 256);
  ASSERT_EQ(header.frame_count(), 1);
  EXPECT_EQ(header.pixel_type, CV_16SC1);
  EXPECT_TRUE(header.transforms.empty());
  EXPECT_FALSE(header.frames[0].time_s);
  EXPECT_EQ(header.frames[0].image_status, "OK");
  EXPECT_EQ(adler_of_pixels(*recording), 0x7a6b8156u);
}

}  // namespace
}  // namespace fathom
