#pragma once

#include "acquisition/recording.h"
#include "registration/calibration.h"
#include "segmentation/contours.h"

namespace fathom {

/// Eleven frames of 200 x 100 pixels of 0.5 mm, 4 mm apart along z: a box of 20 x 10 x 40 mm, 8 ml.
inline MemoryRecording box_recording() {
  RecordingHeader header;
  header.width = 200;
  header.height = 100;
  header.pixel_type = CV_8UC1;
  header.transforms = {"ProbeToTracker"};
  std::vector<cv::Mat> images;
  for (int i = 0; i < 11; ++i) {
    Pose pose;
    pose.matrix(2, 3) = 4.0 * i;
    header.frames.push_back({.time_s = 0.04 * i, .image_status = "OK", .poses = {pose}, .fields = {}});
    images.emplace_back(100, 200, CV_8UC1, cv::Scalar(0));
  }
  return MemoryRecording("box.mha", std::move(header), std::move(images));
}

inline Calibration box_calibration() {
  Calibration calibration;
  calibration.probe_from_image.linear() *= 0.5;
  return calibration;
}

inline Structure box_structure() {
  Structure structure;
  structure.name = "box";
  structure.color = "#10c020";
  for (int i = 0; i < 11; ++i)
    structure.contours.push_back({i, {{60, 40}, {100, 40}, {100, 60}, {60, 60}}, true, {}, 0});
  return structure;
}

}  // namespace fathom
