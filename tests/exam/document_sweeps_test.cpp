#include <cstdlib>

#include <gtest/gtest.h>

#include "core/text_file.h"
#include "exam/document.h"
#include "tests/exam/scan.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

constexpr int kFrames = 11;  // of each of two sweeps along the same way

/// The frames of box_recording, and the same again after a pause.
MemoryRecording twice() {
  const MemoryRecording once = box_recording();
  RecordingHeader header = once.header();
  std::vector<cv::Mat> images;
  for (int i = 0; i < 2 * kFrames; ++i) images.push_back(once.image(i % kFrames));
  for (int i = 0; i < kFrames; ++i) {
    FrameHeader frame = header.frames[static_cast<std::size_t>(i)];
    frame.time_s = *frame.time_s + 10.0;
    header.frames.push_back(frame);
  }
  return {"twice.mha", std::move(header), std::move(images)};
}

TEST(DocumentSweeps, WhatOneStructureMakesOfTheScanChangesTheOthersResults) {
  const ScratchFolder folder;
  ::setenv("XDG_STATE_HOME", (folder / "state").c_str(), 1);
  write_recording(twice(), folder / "twice.mha");
  write_text_file(folder / "probe.json", calibration_json(box_calibration()));
  DocumentOptions options;
  options.calibration = folder / "probe.json";
  Document document(folder / "twice.mha", options);
  Structure box = box_structure();
  document.add_structure(box);
  EXPECT_FALSE(document.division()) << "outlined in one sweep only";
  const auto alone = document.result_revision(0);

  for (int i = 0; i < kFrames; ++i) {
    box.contours.push_back(box.contours[static_cast<std::size_t>(i)]);
    box.contours.back().frame += kFrames;
  }
  box.name = "seen twice";
  document.add_structure(box);
  ASSERT_TRUE(document.division());
  const auto beside = document.result_revision(0);
  EXPECT_GT(beside, alone);

  document.undo();
  EXPECT_FALSE(document.division());
  EXPECT_GT(document.result_revision(0), beside);
}

}  // namespace
}  // namespace fathom
