// Opening and reading recordings. The files are made in the folder for temporary files and removed afterwards.
#include <filesystem>
#include <memory>
#include <string>

#include <Eigen/Geometry>
#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <stdlib.h>

#include "acquisition/recording.h"
#include "core/random.h"

namespace fathom {
namespace {

/// Speckle-like images of a phantom: some structure, noise, a black border, as in a scanner's capture.
class GeneratedRecording : public Recording {
 public:
  GeneratedRecording(int width, int height, int frames) : Recording("generated", {}) {
    header_.width = width;
    header_.height = height;
    header_.pixel_type = CV_8UC1;
    header_.transforms = {"ProbeToTracker", "ReferenceToTracker", "StylusToTracker"};
    Random random(1);
    for (int f = 0; f < frames; ++f) {
      FrameHeader frame;
      frame.time_s = f / 30.0;
      frame.image_status = "OK";
      for (int t = 0; t < 3; ++t) {
        Eigen::Isometry3d pose(Eigen::AngleAxisd(random.normal(), Eigen::Vector3d(1, 2, 3).normalized()));
        pose.pretranslate(Eigen::Vector3d(random.normal(), random.normal(), random.normal()) * 100.0);
        frame.poses.push_back(Pose{pose.matrix(), "OK"});
      }
      header_.frames.push_back(std::move(frame));
    }
    noise_ = cv::Mat(height, 2 * width, CV_8UC1, cv::Scalar(0));
    for (int y = height / 8; y < height * 7 / 8; ++y) {
      for (int x = 0; x < 2 * width; ++x) {
        noise_.at<uchar>(y, x) = cv::saturate_cast<uchar>(60 + 40 * std::sin(y / 30.0) + 12 * random.normal());
      }
    }
  }
  cv::Mat image(int frame) const override {
    return noise_(cv::Rect(frame * 7 % header_.width, 0, header_.width, header_.height));
  }

 private:
  cv::Mat noise_;
};

/// A file that is written once for all benchmarks that use it.
class GeneratedFile {
 public:
  GeneratedFile(int width, int height, int frames, bool compress) {
    std::string name = (std::filesystem::temp_directory_path() / "fathom_benchmark.XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw Error(name + ": cannot be created");
    folder_ = name;
    write_recording(GeneratedRecording(width, height, frames), path(), {.compress = compress});
  }
  ~GeneratedFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::filesystem::path path() const { return folder_ / "r.mha"; }

 private:
  std::filesystem::path folder_;
};

const GeneratedFile& long_file() {
  static const GeneratedFile file(640, 480, 5000, false);  // 1.54 GB
  return file;
}

const GeneratedFile& compressed_file() {
  static const GeneratedFile file(820, 616, 300, true);  // 152 MB of pixels, nine restart points
  return file;
}

void open_1500_megabytes_and_get_the_first_frame(benchmark::State& state) {
  const auto path = long_file().path();
  for (auto _ : state) {
    const auto recording = open_recording(path);
    benchmark::DoNotOptimize(cv::sum(recording->image(0)));
  }
}
BENCHMARK(open_1500_megabytes_and_get_the_first_frame)->Unit(benchmark::kMillisecond);

void random_frames_uncompressed(benchmark::State& state) {
  const auto recording = open_recording(long_file().path());
  Random random(3);
  for (auto _ : state) {
    benchmark::DoNotOptimize(cv::sum(recording->image(static_cast<int>(random.uniform(0, 5000)))));
  }
}
BENCHMARK(random_frames_uncompressed)->Unit(benchmark::kMillisecond);

void inflate_all_frames_in_order(benchmark::State& state) {
  const auto path = compressed_file().path();
  for (auto _ : state) {
    const auto recording = open_recording(path);
    for (int f = 0; f < recording->header().frame_count(); ++f) benchmark::DoNotOptimize(recording->image(f).data);
  }
  state.SetBytesProcessed(state.iterations() * 820 * 616 * 300);
}
BENCHMARK(inflate_all_frames_in_order)->Unit(benchmark::kMillisecond);

void random_frames_compressed(benchmark::State& state) {
  const auto recording = open_recording(compressed_file().path());
  recording->image(299);  // makes the restart points
  Random random(3);
  for (auto _ : state) {
    benchmark::DoNotOptimize(recording->image(static_cast<int>(random.uniform(0, 300))).data);
  }
}
BENCHMARK(random_frames_compressed)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fathom
