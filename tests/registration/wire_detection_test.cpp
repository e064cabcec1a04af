#include "registration/wire_detection.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/random.h"
#include "tests/real_recordings.h"

namespace fathom {
namespace {

NPattern n_pattern(const std::string& name, const Eigen::Vector3d& x_front_mm, const Eigen::Vector3d& x_back_mm,
                   double z_mm) {
  NPattern pattern;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    pattern[at] = {name + std::to_string(i), {x_front_mm[i], 0, z_mm}, {x_back_mm[i], 40, z_mm}};
  }
  return pattern;
}

// The fCal phantom, version 2.0, wiring 2.0.
WirePhantom three_ns() {
  WirePhantom phantom;
  phantom.name = "fCAL";
  phantom.patterns = {n_pattern("a", {30, 55, 60}, {30, 35, 60}, 20), n_pattern("b", {30, 35, 60}, {30, 55, 60}, 10),
                      n_pattern("c", {35, 55, 60}, {35, 40, 60}, 0)};
  return phantom;
}

const cv::Size kSize(640, 480);

// A probe above the phantom that looks down at it, wire 0 on the right.
Eigen::Affine3d plane_over(double y_mm, double yaw_rad, double pitch_rad, double roll_rad, double pixel_mm) {
  Eigen::Matrix3d facing;
  facing << -1, 0, 0, 0, 0, -1, 0, -1, 0;
  Eigen::Affine3d plane = Eigen::Affine3d::Identity();
  plane.linear() =
      facing *
      (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix() *
      pixel_mm;
  plane.translation() = Eigen::Vector3d(46, y_mm, 10) - plane.linear() * Eigen::Vector3d(320, 240, 0);
  return plane;
}

Eigen::Vector2d seen(const Wire& wire, const Eigen::Affine3d& phantom_from_image) {
  const Eigen::Vector3d front = phantom_from_image.inverse() * wire.front;
  const Eigen::Vector3d back = phantom_from_image.inverse() * wire.back;
  return (front + (back - front) * front.z() / (front.z() - back.z())).head<2>();
}

cv::Mat drawn(const std::vector<Eigen::Vector2d>& spots, double background, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(kSize, CV_32FC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<float>(y, x) = static_cast<float>(background * std::hypot(random.normal(), random.normal()));
    }
  }
  cv::GaussianBlur(image, image, cv::Size(0, 0), 1.5);
  for (const Eigen::Vector2d& spot : spots) {
    for (int y = 0; y < image.rows; ++y) {
      const double v = (y - spot.y()) / 2.0;
      if (std::abs(v) > 5.0) continue;
      for (int x = 0; x < image.cols; ++x) {
        const double u = (x - spot.x()) / 4.0;
        image.at<float>(y, x) += static_cast<float>(200.0 * std::exp(-(u * u + v * v) / 2.0));
      }
    }
  }
  cv::Mat bytes;
  image.convertTo(bytes, CV_8U);
  return bytes;
}

TEST(BrightSpots, CentresAreFoundToAFewHundredthsOfAPixelOnBlack) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d truth(random.uniform(100, 500), random.uniform(100, 400));
    const auto spots = find_bright_spots(drawn({truth}, 0.0, 1));
    ASSERT_EQ(spots.size(), 1u);
    EXPECT_LT((spots[0].centre_px - truth).norm(), 0.08);
    EXPECT_FALSE(spots[0].cut_off);
  }
}

TEST(BrightSpots, AFloorLineIsNoSpotAndAnEmptyImageHasNone) {
  cv::Mat image(kSize, CV_8UC1, cv::Scalar(0));
  EXPECT_TRUE(find_bright_spots(image).empty());
  cv::line(image, {20, 400}, {600, 405}, cv::Scalar(255), 3);
  EXPECT_TRUE(find_bright_spots(image).empty());
}

TEST(BrightSpots, ASpotAtTheBorderIsMarkedAsCutOff) {
  const auto spots = find_bright_spots(drawn({{1.0, 200.0}}, 0.0, 1));
  ASSERT_EQ(spots.size(), 1u);
  EXPECT_TRUE(spots[0].cut_off);
}

class WireScan : public ::testing::Test {
 protected:
  WireScan() : phantom(three_ns()) {}

  // A free-hand sweep to and fro over the wires, among clutter and speckle.
  std::vector<cv::Mat> images(int count, double background, int clutter, std::uint64_t seed) {
    Random random(seed);
    truth.clear();
    std::vector<cv::Mat> result;
    for (int frame = 0; frame < count; ++frame) {
      const Eigen::Affine3d plane = plane_over(random.uniform(12, 28), random.uniform(-0.3, 0.3),
                                               random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 0.085);
      std::vector<Eigen::Vector2d> spots;
      for (std::size_t k = 0; k < phantom.patterns.size(); ++k) {
        for (std::size_t w = 0; w < 3; ++w) {
          spots.push_back(seen(phantom.patterns[k][w], plane));
          truth[{frame, k, w}] = spots.back();
        }
      }
      for (int i = 0; i < clutter; ++i) spots.emplace_back(random.uniform(20, 620), random.uniform(20, 460));
      result.push_back(drawn(spots, background, seed + static_cast<std::uint64_t>(frame)));
    }
    return result;
  }

  static MemoryRecording recording_of(const std::vector<cv::Mat>& images) {
    RecordingHeader header;
    header.width = images[0].cols;
    header.height = images[0].rows;
    header.pixel_type = CV_8UC1;
    header.frames.resize(images.size());
    return MemoryRecording("scan", std::move(header), images);
  }

  WirePhantom phantom;
  std::map<std::tuple<int, std::size_t, std::size_t>, Eigen::Vector2d> truth;
};

TEST_F(WireScan, WiresAreFoundAmongClutterAndNoneIsWrong) {
  const auto recording = recording_of(images(40, 12.0, 6, 5));
  const WireDetection found = find_wires(recording, phantom);
  EXPECT_GE(found.frames_with_wires(), 39);
  EXPECT_FALSE(found.wire_0_left);
  EXPECT_FALSE(found.side_unknown);
  EXPECT_NEAR(found.pixel_mm.x(), 0.085, 0.002);
  EXPECT_NEAR(found.pixel_mm.y(), 0.085, 0.002);
  Eigen::Vector2d bias = Eigen::Vector2d::Zero();
  for (const WirePoint& point : found.points) {
    const Eigen::Vector2d off = point.position_px - truth.at({point.frame, point.pattern, point.wire});
    bias += off / static_cast<double>(found.points.size());
    EXPECT_LT(off.norm(), 6.0) << "frame " << point.frame;
  }
  EXPECT_GE(found.points.size(), 9u * 37u);
  EXPECT_LT(bias.norm(), 0.2);
}

TEST_F(WireScan, MirroredImagesAreSeenFromTheOtherSide) {
  std::vector<cv::Mat> mirrored = images(20, 0.0, 0, 6);
  for (cv::Mat& image : mirrored) cv::flip(image, image, 1);
  const WireDetection found = find_wires(recording_of(mirrored), phantom);
  EXPECT_TRUE(found.wire_0_left);
  EXPECT_EQ(found.frames_with_wires(), 20);
  for (const WirePoint& point : found.points) {
    Eigen::Vector2d expected = truth.at({point.frame, point.pattern, point.wire});
    expected.x() = kSize.width - 1 - expected.x();
    EXPECT_LT((point.position_px - expected).norm(), 1.0);
  }
}

std::string message_of(const Recording& recording, const WirePhantom& phantom) {
  try {
    find_wires(recording, phantom);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST_F(WireScan, UpsideDownAndTurnedImagesAreRefused) {
  std::vector<cv::Mat> flipped = images(20, 0.0, 0, 7);
  std::vector<cv::Mat> turned = flipped;
  for (cv::Mat& image : flipped) cv::flip(image, image, 0);
  for (cv::Mat& image : turned) cv::rotate(image, image, cv::ROTATE_90_CLOCKWISE);
  EXPECT_NE(message_of(recording_of(flipped), phantom).find("upside down"), std::string::npos);
  EXPECT_NE(message_of(recording_of(turned), phantom).find("right angle"), std::string::npos);
}

TEST_F(WireScan, AnotherPhantomsWiresAreNotFound) {
  const auto recording = recording_of(images(20, 0.0, 0, 8));
  WirePhantom other = phantom;
  other.patterns[2] = n_pattern("c", {30, 55, 45}, {30, 35, 45}, -15);
  EXPECT_NE(message_of(recording, other).find("are not seen"), std::string::npos);
}

TEST_F(WireScan, SymmetricPhantomsAreSaidToBeSo) {
  phantom.patterns.pop_back();  // what is left looks the same from both sides
  const WireDetection found = find_wires(recording_of(images(20, 0.0, 0, 9)), phantom);
  EXPECT_TRUE(found.side_unknown);
  EXPECT_FALSE(found.wire_0_left);
  EXPECT_EQ(found.frames_with_wires(), 20);
}

TEST_F(WireScan, UnusablePhantomsAreNamed) {
  const auto recording = recording_of({cv::Mat(kSize, CV_8UC1, cv::Scalar(0))});
  EXPECT_NE(message_of(recording, {}).find("no N"), std::string::npos);
  WirePhantom straight = phantom;
  straight.patterns[1][1] = straight.patterns[1][0];
  EXPECT_NE(message_of(recording, straight).find("middle wire"), std::string::npos);
  EXPECT_NE(message_of(recording, phantom).find("fewer bright spots"), std::string::npos);
}

// Wire names of the recordings' own phantom description.
const std::map<std::string, std::pair<std::size_t, std::size_t>> kPlusWires = {
    {"7", {0, 0}}, {"8", {0, 1}}, {"9", {0, 2}}, {"4", {1, 0}}, {"5", {1, 1}},
    {"6", {1, 2}}, {"1", {2, 0}}, {"2", {2, 1}}, {"3", {2, 2}}};

std::map<std::tuple<int, std::size_t, std::size_t>, Eigen::Vector2d> plus_points(const std::string& section) {
  std::ifstream file(real_recordings() / "FreehandCalibration3NWires_fCal2.0.results.xml");
  std::map<std::tuple<int, std::size_t, std::size_t>, Eigen::Vector2d> points;
  const std::regex frame_start("<Frame Index=\"(\\d+)\"");
  const std::regex point_start("<Point WireName=\"(\\d):[^\"]*\" Position=\"([-\\d.e+]+) ([-\\d.e+]+)");
  bool inside = false;
  int frame = 0;
  std::smatch match;
  for (std::string line; std::getline(file, line);) {
    if (line.find("<" + section + ">") != std::string::npos) inside = true;
    if (line.find("</" + section + ">") != std::string::npos) inside = false;
    if (!inside) continue;
    if (std::regex_search(line, match, frame_start)) frame = std::stoi(match[1]);
    if (std::regex_search(line, match, point_start)) {
      const auto [pattern, wire] = kPlusWires.at(match[1]);
      points[{frame, pattern, wire}] = {std::stod(match[2]), std::stod(match[3])};
    }
  }
  return points;
}

void expect_as_plus(const std::string& file, const std::string& section) {
  FATHOM_NEEDS_REAL_RECORDINGS();
  const auto recording = open_recording(real_recordings() / file);
  const WireDetection found = find_wires(*recording, three_ns());
  const int frames = recording->header().frame_count();
  EXPECT_GE(found.frames_with_wires(), 0.97 * frames);
  const auto expected = plus_points(section);
  ASSERT_GT(expected.size(), 900u);
  std::vector<double> distances;
  for (const WirePoint& point : found.points) {
    const auto at = expected.find({point.frame, point.pattern, point.wire});
    if (at != expected.end()) distances.push_back((point.position_px - at->second).norm());
  }
  EXPECT_GE(static_cast<double>(distances.size()), 0.97 * static_cast<double>(expected.size()));
  std::sort(distances.begin(), distances.end());
  EXPECT_LT(distances[distances.size() / 2], 1.0);
  EXPECT_LT(distances.back(), 10.0);  // wires are more than 50 pixels apart
}

TEST(RealWires, CalibrationSweepIsReadAsPlusReadsIt) {
  expect_as_plus("fCal_Test_Calibration_3NWires_fCal2.0.igs.mha", "CalibrationData");
}

TEST(RealWires, ValidationSweepIsReadAsPlusReadsIt) {
  expect_as_plus("fCal_Test_Validation_3NWires_fCal2.0.igs.mha", "ValidationData");
}

}  // namespace
}  // namespace fathom
