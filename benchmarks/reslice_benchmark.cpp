// Pictures of 512 x 512 pixels from a sweep of 300 frames of 640 x 480: pictures per second, by mode, plane and
// threads.

#include <algorithm>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

#include "core/random.h"
#include "registration/reslice.h"

namespace {

using namespace fathom;

constexpr int kFrames = 300;
constexpr double kStep_mm = 0.35;   // about 100 mm of way
constexpr double kPixel_mm = 0.15;  // 96 x 72 mm
const cv::Size kSize{640, 480};

// A hand that moves on evenly, and trembles.
struct Scan {
  std::unique_ptr<Recording> recording;
  Calibration calibration;
};

Scan make_scan() {
  Random random(11);
  RecordingHeader header;
  header.width = kSize.width;
  header.height = kSize.height;
  header.pixel_type = CV_8U;
  header.transforms = {"ProbeToTracker"};
  std::vector<cv::Mat> images;
  for (int i = 0; i < kFrames; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const auto angle = [&random] { return random.uniform(-0.01, 0.01); };
    pose.rotate(Eigen::AngleAxisd(angle(), Eigen::Vector3d::UnitX()) *
                Eigen::AngleAxisd(angle(), Eigen::Vector3d::UnitY()));
    pose.translation() = Eigen::Vector3d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), kStep_mm * i);
    FrameHeader frame;
    frame.time_s = 0.04 * i;
    frame.poses = {Pose{pose.matrix(), "OK"}};
    header.frames.push_back(frame);
    cv::Mat image(kSize, CV_8U);
    std::generate(image.begin<std::uint8_t>(), image.end<std::uint8_t>(),
                  [&random] { return static_cast<std::uint8_t>(random.uniform(0, 256)); });
    images.push_back(image);
  }
  Calibration calibration;
  calibration.probe_from_image.linear() *= kPixel_mm;
  return {std::make_unique<MemoryRecording>("benchmark", header, std::move(images)), calibration};
}

// All of them through the middle of the sweep: along it, oblique to all of its axes, and almost along its frames.
ReslicePlane plane(const std::string& name) {
  const Eigen::Vector3d middle_mm(0.5 * kPixel_mm * kSize.width, 0.5 * kPixel_mm * kSize.height,
                                  0.5 * kStep_mm * kFrames);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (name == "along") turn = Eigen::AngleAxisd(-0.5 * M_PI, Eigen::Vector3d::UnitY());
  if (name == "oblique") turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d(1, 1, 1));
  if (name == "flat") turn = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY());
  ReslicePlane plane;
  plane.size = {512, 512};
  plane.spacing_mm = 0.14;  // 72 mm: no pixel lies outside of the frames
  plane.x_axis = turn.col(0);
  plane.y_axis = turn.col(1);
  plane.origin_mm = middle_mm - 255.5 * plane.spacing_mm * (plane.x_axis + plane.y_axis);
  return plane;
}

void Pictures(benchmark::State& state, const std::string& plane_name, ResliceMode mode, double thickness_mm) {
  static const Scan scan = make_scan();
  const FrameLocator locator(*scan.recording, scan.calibration);
  const Reslicer reslicer(*scan.recording, locator, {{0, 0, kFrames - 1}});
  cv::setNumThreads(static_cast<int>(state.range(0)));
  const ResliceSurface surface = plane_surface(plane(plane_name));
  double covered = 0.0;
  for (auto _ : state) covered = reslicer.reslice(surface, {mode, thickness_mm}).covered_share();
  state.counters["pictures"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["covered"] = covered;
}

void with_threads(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(Pictures, along_nearest, "along", ResliceMode::kNearest, 0.0)->Apply(with_threads);
BENCHMARK_CAPTURE(Pictures, oblique_nearest, "oblique", ResliceMode::kNearest, 0.0)->Apply(with_threads);
BENCHMARK_CAPTURE(Pictures, flat_nearest, "flat", ResliceMode::kNearest, 0.0)->Apply(with_threads);
BENCHMARK_CAPTURE(Pictures, along_linear, "along", ResliceMode::kLinear, 0.0)->Apply(with_threads);
BENCHMARK_CAPTURE(Pictures, oblique_linear, "oblique", ResliceMode::kLinear, 0.0)->Apply(with_threads);
BENCHMARK_CAPTURE(Pictures, flat_linear, "flat", ResliceMode::kLinear, 0.0)->Apply(with_threads);
BENCHMARK_CAPTURE(Pictures, oblique_mean_of_3_mm, "oblique", ResliceMode::kMean, 3.0)->Apply(with_threads);

}  // namespace
