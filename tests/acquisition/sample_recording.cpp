#include "tests/acquisition/sample_recording.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <stdlib.h>

#include "core/error.h"
#include "core/random.h"

namespace fathom {

namespace {

Eigen::Matrix4d random_pose(Random& random) {
  const Eigen::Vector3d axis = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  Eigen::Isometry3d pose(Eigen::AngleAxisd(random.uniform(0.0, std::numbers::pi), axis));
  pose.pretranslate(Eigen::Vector3d(random.normal(), random.normal(), random.normal()) * 300.0);
  return pose.matrix();
}

cv::Mat random_image(const SampleOptions& options, Random& random) {
  cv::Mat image(options.height, options.width, options.pixel_type);
  const bool is_float = image.depth() >= CV_32F;
  if (is_float) {
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const double value = options.smooth ? x : random.normal() * 1e3;
        if (image.depth() == CV_32F) {
          image.at<float>(y, x) = static_cast<float>(value);
        } else {
          image.at<double>(y, x) = value;
        }
      }
    }
    return image;
  }
  const auto offset = static_cast<std::size_t>(random.uniform(0, 200));
  const std::size_t row_bytes = image.elemSize() * static_cast<std::size_t>(image.cols);
  for (int y = 0; y < image.rows; ++y) {
    for (std::size_t x = 0; x < row_bytes; ++x) {
      image.ptr(y)[x] =
          static_cast<uchar>(options.smooth ? offset + x / 8 : static_cast<std::size_t>(random.uniform(0, 256)));
    }
  }
  return image;
}

auto sorted(std::vector<std::pair<std::string, std::string>> fields) {
  std::sort(fields.begin(), fields.end());
  return fields;
}

}  // namespace

TestFolder::TestFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "fathom_test.XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for temporary files");
  path_ = name;
}

TestFolder::~TestFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TestFolder::write(const std::string& name, const std::string& bytes) const {
  std::ofstream(path_ / name, std::ios::binary) << bytes;
  return path_ / name;
}

std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

MemoryRecording sample_recording(const SampleOptions& options) {
  Random random(options.seed);
  RecordingHeader header;
  header.width = options.width;
  header.height = options.height;
  header.pixel_type = options.pixel_type;
  header.transforms = {"ProbeToTracker", "ReferenceToTracker", "ImageToProbe"};
  header.fields = {{"ElementSpacing", "0.3 0.2 1"},
                   {"Offset", "1.5 -2 0"},
                   {"latency_applied_s", "0"},
                   {"Operator", "M. O'Neill = \"MON\", caf\xC3\xA9"}};
  std::vector<cv::Mat> images;
  for (int f = 0; f < options.frames; ++f) {
    FrameHeader frame;
    if (f != 3) frame.time_s = 345.627957 + f / 3.0 + 0.001 * random.uniform();
    frame.image_status = f == 2 ? "INVALID" : f == 5 ? "" : "OK";
    frame.poses.resize(3);
    if (f != 4) frame.poses[0] = Pose{random_pose(random), f == 6 ? "OUT_OF_VIEW" : "OK"};
    frame.poses[1] = Pose{random_pose(random), f % 2 == 0 ? "OK" : ""};
    Eigen::Matrix4d scaled = random_pose(random);
    scaled.leftCols<3>() *= 0.17;
    if (f % 3 == 0) frame.poses[2] = Pose{scaled, "OK"};
    if (f == 7) frame.poses[1] = Pose{Eigen::Matrix4d::Zero(), "MISSING"};
    frame.fields = {{"FrameNumber", std::to_string(1000 + 3 * f)}};
    if (f == 1) frame.fields.emplace_back("Remark", "");
    header.frames.push_back(std::move(frame));
    if (header.has_images()) images.push_back(random_image(options, random));
  }
  return {"sample", std::move(header), std::move(images)};
}

bool same_pixels(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  const std::size_t row_bytes = a.elemSize() * static_cast<std::size_t>(a.cols);
  for (int y = 0; y < a.rows; ++y) {
    if (!std::equal(a.ptr(y), a.ptr(y) + row_bytes, b.ptr(y))) return false;
  }
  return true;
}

void expect_same(const Recording& actual, const Recording& expected) {
  const RecordingHeader& a = actual.header();
  const RecordingHeader& e = expected.header();
  EXPECT_EQ(a.width, e.width);
  EXPECT_EQ(a.height, e.height);
  EXPECT_EQ(a.pixel_type, e.pixel_type);
  EXPECT_EQ(a.transforms, e.transforms);
  EXPECT_EQ(sorted(a.fields), sorted(e.fields));
  ASSERT_EQ(a.frame_count(), e.frame_count());
  for (int f = 0; f < e.frame_count(); ++f) {
    SCOPED_TRACE("frame " + std::to_string(f));
    const FrameHeader& af = a.frames[static_cast<std::size_t>(f)];
    const FrameHeader& ef = e.frames[static_cast<std::size_t>(f)];
    EXPECT_EQ(af.time_s, ef.time_s);  // to the last bit
    EXPECT_EQ(af.image_status, ef.image_status);
    EXPECT_TRUE(af.poses == ef.poses);
    EXPECT_EQ(sorted(af.fields), sorted(ef.fields));
    if (e.has_images()) {
      EXPECT_TRUE(same_pixels(actual.image(f), expected.image(f)));
    }
  }
}

void expect_refused(const std::filesystem::path& path, const std::string& what) {
  try {
    const auto recording = open_recording(path);
    for (int f = 0; recording->header().has_images() && f < recording->header().frame_count(); ++f) recording->image(f);
    ADD_FAILURE() << "was read, though " << what;
  } catch (const Error& e) {
    const std::string message = e.what();
    EXPECT_NE(message.find(path.stem().string()), std::string::npos) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_LT(message.size(), 900u) << message;
  }
}

std::string tiny_metaimage(int frames, const std::string& fields) {
  std::string text = "ObjectType = Image\nNDims = 3\nDimSize = 4 3 " + std::to_string(frames) +
                     "\nElementType = MET_UCHAR\nUltrasoundImageOrientation = MFA\n" + fields +
                     "ElementDataFile = LOCAL\n";
  for (int i = 0; i < 12 * frames; ++i) text += static_cast<char>(i);
  return text;
}

}  // namespace fathom
