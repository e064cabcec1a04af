// Volume after an edited contour: 40 sections of 200 points, from outlines to volumes by all methods.

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <benchmark/benchmark.h>

#include "acquisition/recording.h"
#include "measurement/cross_section.h"
#include "measurement/planimetry.h"
#include "registration/frame_locator.h"

namespace {

using namespace fathom;

constexpr int kSections = 40;
constexpr int kPoints = 200;

// Sections of an ellipsoid, in a sweep that moves and turns. `bend_rad` above 0 bends them into bananas, whose outlines
// no point sees all of.
Structure outlines(double bend_rad) {
  Structure structure;
  for (int frame = 0; frame < kSections; ++frame) {
    const double u = (2.0 * frame + 1.0) / kSections - 1.0;
    const double radius = 60.0 * std::sqrt(1.0 - u * u);
    Contour contour;
    contour.frame = frame;
    for (int i = 0; i < kPoints; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kPoints;
      const double along = 2.0 * radius * std::cos(angle);
      const double across = (bend_rad > 0.0 ? 0.4 : 1.0) * radius * std::sin(angle);
      const double bent = bend_rad * along / 120.0;
      const double turn_radius = bend_rad > 0.0 ? 120.0 / bend_rad : 0.0;
      const bool straight = bend_rad == 0.0;
      contour.points_px.emplace_back(320.0 + (straight ? along : (turn_radius + across) * std::sin(bent)),
                                     240.0 + (straight ? across : (turn_radius + across) * std::cos(bent)));
    }
    structure.contours.push_back(std::move(contour));
  }
  return structure;
}

MemoryRecording sweep() {
  RecordingHeader header;
  header.transforms = {"ProbeToTracker"};
  for (int frame = 0; frame < kSections; ++frame) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(Eigen::Vector3d(0.1 * frame, 0.2 * frame, 1.5 * frame));
    pose.rotate(Eigen::AngleAxisd(0.01 * frame, Eigen::Vector3d(1.0, 0.3, 0.2).normalized()));
    FrameHeader record;
    record.time_s = 0.04 * frame;
    record.poses.emplace_back(Pose{pose.matrix(), "OK"});
    header.frames.push_back(record);
  }
  return MemoryRecording("sweep", header, {});
}

void measure(benchmark::State& state, double bend_rad) {
  const MemoryRecording recording = sweep();
  Calibration calibration;
  calibration.probe_from_image.linear() *= 0.2;
  const FrameLocator locator(recording, calibration);
  const Structure structure = outlines(bend_rad);
  for (auto _ : state) {
    std::vector<std::string> warnings;
    const auto sections = cross_sections(structure, locator, &warnings);
    benchmark::DoNotOptimize(measure_planimetry(sections));
  }
}

void MeasureRoundOutlines(benchmark::State& state) { measure(state, 0.0); }
void MeasureBentOutlines(benchmark::State& state) { measure(state, 2.2); }

BENCHMARK(MeasureRoundOutlines)->Unit(benchmark::kMicrosecond);
BENCHMARK(MeasureBentOutlines)->Unit(benchmark::kMicrosecond);

}  // namespace
