// One move of a point in an open exam of 40 sections of 200 points: the command, and the volume that follows it.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include <Eigen/Geometry>
#include <benchmark/benchmark.h>

#include "core/text_file.h"
#include "exam/document.h"
#include "exam/live_results.h"

namespace {

using namespace fathom;

constexpr int kSections = 40;
constexpr int kPoints = 200;
constexpr double kBend_rad = 2.2;  // bananas, whose outlines no point sees all of: the slow case

Structure outlines() {
  Structure structure{"organ", "#33ccff", {}, {}, {}};
  for (int frame = 0; frame < kSections; ++frame) {
    const double u = (2.0 * frame + 1.0) / kSections - 1.0;
    const double radius = 60.0 * std::sqrt(1.0 - u * u);
    Contour contour;
    contour.frame = frame;
    for (int i = 0; i < kPoints; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kPoints;
      const double bent = kBend_rad * 2.0 * radius * std::cos(angle) / 120.0;
      const double across = 120.0 / kBend_rad + 0.4 * radius * std::sin(angle);
      contour.points_px.emplace_back(320.0 + across * std::sin(bent), 240.0 + across * std::cos(bent));
    }
    structure.contours.push_back(std::move(contour));
  }
  return structure;
}

MemoryRecording scan() {
  RecordingHeader header;
  header.width = 640;
  header.height = 480;
  header.pixel_type = CV_8UC1;
  header.transforms = {"ProbeToTracker"};
  std::vector<cv::Mat> images;
  for (int frame = 0; frame < kSections; ++frame) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(Eigen::Vector3d(0.1 * frame, 0.2 * frame, 1.5 * frame));
    pose.rotate(Eigen::AngleAxisd(0.01 * frame, Eigen::Vector3d(1.0, 0.3, 0.2).normalized()));
    FrameHeader record;
    record.time_s = 0.04 * frame;
    record.poses.emplace_back(Pose{pose.matrix(), "OK"});
    header.frames.push_back(record);
    images.emplace_back(480, 640, CV_8UC1, cv::Scalar(0));
  }
  return MemoryRecording("sweep", header, std::move(images));
}

// An exam on the disk, removed at the end of the program.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "fathom-benchmark-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
    ::setenv("XDG_STATE_HOME", path_.c_str(), 1);
    write_recording(scan(), path_ / "sweep.mha");
    Calibration calibration;
    calibration.probe_from_image.linear() *= 0.2;
    write_text_file(path_ / "probe.json", calibration_json(calibration));
    write_text_file(path_ / "contours.json", contours_json({outlines()}));
  }
  ~Folder() { std::filesystem::remove_all(path_); }

  DocumentOptions options() const {
    DocumentOptions options;
    options.calibration = path_ / "probe.json";
    options.contours = path_ / "contours.json";
    return options;
  }
  std::filesystem::path recording() const { return path_ / "sweep.mha"; }

 private:
  std::filesystem::path path_;
};

// As a drag does it, once per event of the mouse.
void move_a_point(benchmark::State& state, bool measured, int sweeps) {
  static const Folder folder;
  Document document(folder.recording(), folder.options());
  if (sweeps > 1) {
    document.split_sweep(0, kSections / 2);
    document.place_planes();
  }
  Worker worker;
  LiveResults live(document, worker);
  live.volume(0);
  const Eigen::Vector2d from = document.structures()[0].contours[20].points_px[7];
  document.begin_action("Drag");
  double way = 0.0;
  for (auto _ : state) {
    way = way > 1.0 ? 0.0 : way + 0.01;
    document.move_point(0, 20, 7, from + Eigen::Vector2d(way, 0.0));
    if (measured) benchmark::DoNotOptimize(live.volume(0).volumes.cubic_ml);
  }
  if (measured && !live.volume(0).volumes.cubic_ml) state.SkipWithError("there is no volume");
}

void MovePoint(benchmark::State& state) { move_a_point(state, false, 1); }
void MovePointAndMeasure(benchmark::State& state) { move_a_point(state, true, 1); }
void MovePointAndMeasureTwoSweeps(benchmark::State& state) { move_a_point(state, true, 2); }

BENCHMARK(MovePoint)->Unit(benchmark::kMicrosecond);
BENCHMARK(MovePointAndMeasure)->Unit(benchmark::kMicrosecond);
BENCHMARK(MovePointAndMeasureTwoSweeps)->Unit(benchmark::kMicrosecond);

}  // namespace
