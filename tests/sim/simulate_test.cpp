#include "sim/simulate.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "measurement/planimetry.h"
#include "sim/phantom.h"
#include "sim/scan_path.h"
#include "tests/sim/scan_options.h"

namespace fathom {
namespace {

double measured_ml(const SimulatedScan& scan) {
  const FrameLocator locator(*scan.recording, scan.calibration);
  return linear_planimetry_ml(cross_sections(scan.outlines.front(), locator, nullptr));
}

/// The outlines' points as the recorded poses place them.
std::vector<Eigen::Vector3d> points_in_reference(const SimulatedScan& scan) {
  const FrameLocator locator(*scan.recording, scan.calibration);
  std::vector<Eigen::Vector3d> points;
  for (const Contour& contour : scan.outlines.front().contours) {
    const auto reference_from_image = locator.reference_from_image(contour.frame);
    if (!reference_from_image) continue;
    for (const Eigen::Vector2d& point : contour.points_px) {
      points.push_back(*reference_from_image * Eigen::Vector3d(point.x(), point.y(), 0.0));
    }
  }
  return points;
}

/// Largest distance of the points from the ball of 10 mm that fits them best.
double out_of_ball_mm(const std::vector<Eigen::Vector3d>& points) {
  // |p|^2 = 2 p.c + (r^2 - |c|^2) is linear in the centre.
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(points.size()), 4);
  Eigen::VectorXd squares(static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Eigen::Vector3d& p = points[static_cast<std::size_t>(i)];
    rows.row(i) << 2.0 * p.transpose(), 1.0;
    squares[i] = p.squaredNorm();
  }
  const Eigen::Vector4d fit = rows.colPivHouseholderQr().solve(squares);
  double largest = 0.0;
  for (const Eigen::Vector3d& p : points) largest = std::max(largest, std::abs((p - fit.head<3>()).norm() - 10.0));
  return largest;
}

std::vector<std::pair<std::string, std::string>> every_scan() {
  std::vector<std::pair<std::string, std::string>> scans;
  for (const std::string& object : object_names()) {
    for (const std::string& pattern : single_sweep_patterns()) scans.emplace_back(object, pattern);
  }
  return scans;
}

class EveryScan : public testing::TestWithParam<std::pair<std::string, std::string>> {};
INSTANTIATE_TEST_SUITE_P(Simulate, EveryScan, testing::ValuesIn(every_scan()), [](const auto& instance) {
  std::string name = instance.param.first + "_" + instance.param.second;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(EveryScan, HasTheWholeObjectInItsImagesAndMeasuresItsVolume) {
  const SimulatedScan scan = simulate(options_of(GetParam().first, GetParam().second, 20));
  for (const Contour& contour : scan.outlines.front().contours) {
    for (const Eigen::Vector2d& point : contour.points_px) {
      ASSERT_GE(point.minCoeff(), 2.0) << "frame " << contour.frame;
      ASSERT_LE(point.x(), scan.recording->header().width - 3.0) << "frame " << contour.frame;
      ASSERT_LE(point.y(), scan.recording->header().height - 3.0) << "frame " << contour.frame;
    }
  }
  EXPECT_NEAR(measured_ml(scan) / scan.truth.structures.front().volume_ml, 1.0,
              GetParam().first == "ducts" ? 0.05 : 0.03);
}

TEST_P(EveryScan, BeginsAndEndsAtTheObjectsExtremities) {
  const SimulatedScan scan = simulate(options_of(GetParam().first, GetParam().second, 7));
  const bool alone = scan.outlines.size() == 1;  // else the ends may show another structure
  EXPECT_TRUE(!alone || scan.outlines.front().absent.empty());
  for (const int frame : {0, 6}) {
    const auto touched = [&](const Structure& structure) {
      return std::any_of(structure.extremities.begin(), structure.extremities.end(),
                         [&](const Extremity& extremity) { return extremity.frame == frame; });
    };
    const auto touches = std::count_if(scan.outlines.begin(), scan.outlines.end(), touched);
    EXPECT_LE(touches, 1);
    const int white = cv::countNonZero(scan.recording->image(frame));
    if (touches == 0) {
      EXPECT_GT(white, 1000) << "a frame with an area lies in a flat face";
    } else {
      EXPECT_EQ(white, 0);
    }
  }
  for (int frame = 1; frame < 6; ++frame) EXPECT_GT(cv::countNonZero(scan.recording->image(frame)), 20) << frame;
}

TEST(Simulate, ExtremityIsWhereThePlaneBesideItShowsASpeck) {
  const SimulatedScan scan = simulate(options_of("kidney", "linear", 300));
  const Structure& structure = scan.outlines.front();
  ASSERT_EQ(structure.extremities.size(), 2u);
  ASSERT_EQ(structure.contours.front().frame, 1);
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const auto& point : structure.contours.front().points_px) middle += point;
  middle /= static_cast<double>(structure.contours.front().points_px.size());
  EXPECT_LT((middle - structure.extremities.front().point_px).norm(), 3.0);
}

TEST(Simulate, ConeAndCubeShowTheirFlatFacesAtTheEnd) {
  EXPECT_EQ(simulate(options_of("cone", "linear", 5)).outlines.front().extremities.size(), 1u);
  EXPECT_TRUE(simulate(options_of("cube", "linear", 5)).outlines.front().extremities.empty());
  EXPECT_NEAR(measured_ml(simulate(options_of("cube", "linear", 5))), 8.0, 8.0 * 2e-5);
}

TEST(Simulate, PixelsMeasureTheVolumeToo) {
  // Counting white pixels uses neither outlines nor planimetry: the sum over parallel frames, 0.1 mm apart.
  const SimulatedScan scan = simulate(options_of("glove", "linear", 201));
  const FrameLocator locator(*scan.recording, scan.calibration);
  double volume = 0.0;
  const Eigen::Vector3d step = (*locator.reference_from_image(1)) * Eigen::Vector3d::Zero() -
                               (*locator.reference_from_image(0)) * Eigen::Vector3d::Zero();
  for (int frame = 0; frame < 201; ++frame) {
    volume += cv::countNonZero(scan.recording->image(frame)) * 0.12 * 0.12 * step.norm();
  }
  EXPECT_NEAR(volume / 1000.0 / scan.truth.volume_ml, 1.0, 0.002);
}

TEST(Simulate, SameSeedGivesTheSameBytes) {
  SimulateOptions options = options_of("hat", "free", 9);
  options.jitter_mm = 0.5;
  options.jitter_deg = 1.0;
  options.misregister_mm = 0.2;
  options.noise_mm = 0.25;
  options.noise_deg = 0.15;
  const SimulatedScan a = simulate(options);
  const SimulatedScan b = simulate(options);
  options.seed = 2;
  const SimulatedScan c = simulate(options);
  EXPECT_EQ(contours_json(a.outlines), contours_json(b.outlines));
  EXPECT_NE(contours_json(a.outlines), contours_json(c.outlines));
  EXPECT_EQ(truth_json(a, options), truth_json(b, options));
  for (std::size_t frame = 0; frame < 9; ++frame) {
    const auto& pose = a.recording->header().frames[frame].poses[0];
    EXPECT_EQ(pose, b.recording->header().frames[frame].poses[0]);
    EXPECT_NE(pose, c.recording->header().frames[frame].poses[0]);
    const cv::Mat image_a = a.recording->image(static_cast<int>(frame));
    const cv::Mat image_b = b.recording->image(static_cast<int>(frame));
    EXPECT_EQ(cv::norm(image_a, image_b, cv::NORM_INF), 0.0);
  }
}

TEST(Simulate, JitterMovesThePlanesButLeavesThePosesTrue) {
  SimulateOptions options = options_of("sphere", "linear", 15);
  const auto still = points_in_reference(simulate(options));
  options.jitter_mm = 0.5;
  options.jitter_deg = 2.5;
  const SimulatedScan scan = simulate(options);
  EXPECT_LT(out_of_ball_mm(still), 1e-6);
  EXPECT_LT(out_of_ball_mm(points_in_reference(scan)), 1e-6);
  EXPECT_NE(contours_json(scan.outlines), contours_json(simulate(options_of("sphere", "linear", 15)).outlines));
}

TEST(Simulate, AnUnsteadyPlaneThatMissesTheObjectIsMarkedAbsent) {
  SimulateOptions options = options_of("sphere", "linear", 6);
  options.jitter_mm = 1.0;
  bool missed = false;
  for (std::uint64_t seed = 1; seed < 10; ++seed) {
    options.seed = seed;
    const SimulatedScan scan = simulate(options);
    EXPECT_TRUE(scan.outlines.front().extremities.empty());
    for (const AbsentMark& mark : scan.outlines.front().absent) {
      missed = true;
      EXPECT_EQ(cv::countNonZero(scan.recording->image(mark.frame)), 0);
    }
  }
  EXPECT_TRUE(missed);
}

TEST(Simulate, MisregistrationLeavesTheImagesButMovesThePoses) {
  const SimulateOptions exact = options_of("sphere", "linear", 15);
  SimulateOptions options = exact;
  options.misregister_mm = 0.5;
  options.misregister_deg = 2.5;
  const SimulatedScan scan = simulate(options);
  EXPECT_EQ(contours_json(scan.outlines), contours_json(simulate(exact).outlines));
  const double off = out_of_ball_mm(points_in_reference(scan));
  EXPECT_GT(off, 0.2);
  EXPECT_LT(off, 2.0);
}

TEST(Simulate, TrackerNoiseHasTheStatedRms) {
  SimulateOptions options = options_of("sphere", "linear", 300);
  const SimulatedScan exact = simulate(options);
  options.noise_mm = 0.25;
  options.noise_deg = 0.15;
  const SimulatedScan noisy = simulate(options);
  double squared_mm = 0.0;
  double squared_deg = 0.0;
  for (std::size_t frame = 0; frame < 300; ++frame) {
    const Eigen::Matrix4d a = exact.recording->header().frames[frame].poses[0]->matrix;
    const Eigen::Matrix4d b = noisy.recording->header().frames[frame].poses[0]->matrix;
    squared_mm += (a - b).block<3, 1>(0, 3).squaredNorm();
    const Eigen::Matrix3d turn = a.block<3, 3>(0, 0).transpose() * b.block<3, 3>(0, 0);
    squared_deg += std::pow(Eigen::AngleAxisd(turn).angle() * 180.0 / M_PI, 2);
  }
  EXPECT_NEAR(std::sqrt(squared_mm / 300.0), 0.25, 0.02);
  EXPECT_NEAR(std::sqrt(squared_deg / 300.0), 0.15, 0.012);
}

TEST(Simulate, LatencyIsUndoneByTheCalibrationThatStatesIt) {
  SimulateOptions options = options_of("kidney", "free", 80);
  options.jitter_mm = 0.3;
  const SimulatedScan exact = simulate(options);
  options.latency_s = 0.13;  // three and a quarter frames
  const SimulatedScan late = simulate(options);

  const FrameLocator truth(*exact.recording, exact.calibration);
  const FrameLocator corrected(*late.recording, late.calibration);
  const FrameLocator ignored(*late.recording, exact.calibration);
  const Eigen::Vector3d centre(165.0, 210.0, 0.0);
  double largest_ignored = 0.0;
  for (int frame = 0; frame < 76; ++frame) {
    const Eigen::Vector3d where = *truth.reference_from_image(frame) * centre;
    ASSERT_TRUE(corrected.reference_from_image(frame));
    // Between samples the pose is interpolated, and the hand's jitter is not straight.
    EXPECT_LT((*corrected.reference_from_image(frame) * centre - where).norm(), 0.3);
    largest_ignored = std::max(largest_ignored, (*ignored.reference_from_image(frame) * centre - where).norm());
  }
  EXPECT_GT(largest_ignored, 3.0);
  EXPECT_FALSE(corrected.reference_from_image(79));
}

TEST(Simulate, LatencyOfWholeFramesShiftsThePosesExactly) {
  SimulateOptions options = options_of("sphere", "free", 12);
  options.jitter_mm = 0.4;
  options.jitter_deg = 2.0;
  const SimulatedScan exact = simulate(options);
  options.latency_s = 0.08;  // two frames at 25 Hz
  const SimulatedScan late = simulate(options);
  for (std::size_t frame = 2; frame < 12; ++frame) {
    const Eigen::Matrix4d& then = exact.recording->header().frames[frame - 2].poses[0]->matrix;
    const Eigen::Matrix4d& stamped = late.recording->header().frames[frame].poses[0]->matrix;
    EXPECT_LT((then - stamped).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Simulate, FirstFrameDoesNotStartTheClockAndNothingIsTrivial) {
  const SimulatedScan scan = simulate(options_of("kidney", "free", 5));
  const RecordingHeader& header = scan.recording->header();
  EXPECT_GT(*header.frames.front().time_s, 1.0);
  EXPECT_NEAR(*header.frames[1].time_s - *header.frames[0].time_s, 0.04, 1e-12);
  ASSERT_EQ(header.transforms, (std::vector<std::string>{"ProbeToTracker", "ReferenceToTracker"}));
  EXPECT_GT((header.frames[0].poses[1]->matrix - Eigen::Matrix4d::Identity()).norm(), 1.0);
  EXPECT_EQ(header.frames[0].poses[1], header.frames[4].poses[1]);

  const Eigen::Matrix3d columns = scan.calibration.probe_from_image.linear();
  EXPECT_NE(columns.col(0).norm(), columns.col(1).norm());
  EXPECT_NEAR(columns.col(0).dot(columns.col(1)), 0.0, 1e-12);
  const double mean = (columns.col(0).norm() + columns.col(1).norm()) / 2.0;
  EXPECT_LT((columns.col(0).cross(columns.col(1)).normalized() * mean - columns.col(2)).norm(), 1e-12);
  const Eigen::Vector3d centre = scan.calibration.probe_from_image * Eigen::Vector3d(164.5, 209.5, 0.0);
  EXPECT_NEAR(centre.norm(), 100.0, 1e-9);
}

TEST(Simulate, PosesAreRigid) {
  SimulateOptions options = options_of("kidney", "free", 5);
  options.noise_deg = 0.5;
  const SimulatedScan scan = simulate(options);
  for (const FrameHeader& frame : scan.recording->header().frames) {
    for (const auto& pose : frame.poses) {
      const Eigen::Matrix3d turn = pose->matrix.block<3, 3>(0, 0);
      EXPECT_LT((turn.transpose() * turn - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-12);
      EXPECT_GT(turn.determinant(), 0.0);
      EXPECT_EQ(pose->matrix.row(3), Eigen::RowVector4d(0, 0, 0, 1));
    }
  }
}

TEST(Simulate, CanBeStopped) {
  int calls = 0;
  const auto stop = [&](double fraction) {
    EXPECT_GE(fraction, 0.0);
    EXPECT_LT(fraction, 1.0);
    return ++calls < 3;
  };
  EXPECT_THROW(simulate(options_of("sphere", "linear", 1000), stop), Cancelled);
  EXPECT_EQ(calls, 3);
}

TEST(Simulate, OneFrameIsAllowed) {
  const SimulatedScan scan = simulate(options_of("sphere", "free", 1));
  EXPECT_EQ(scan.outlines.front().contours.size(), 1u);
  EXPECT_THROW(scan.recording->image(1), Error);
}

TEST(Simulate, TruthFileStatesTheTruth) {
  SimulateOptions options = options_of("cone", "linear", 4);
  options.latency_s = 0.05;
  options.seed = 18446744073709551615u;
  const SimulatedScan scan = simulate(options);
  const auto json = nlohmann::json::parse(truth_json(scan, options));
  EXPECT_NEAR(json.at("volume_ml").get<double>(), M_PI * 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(json.at("surface_area_cm2").get<double>(), M_PI * (1.0 + std::sqrt(5.0)), 1e-12);
  EXPECT_EQ(json.at("structures").at(0).at("name"), "cone");
  EXPECT_EQ(json.at("seed").get<std::uint64_t>(), options.seed);
  EXPECT_EQ(json.at("frames"), 4);
  EXPECT_EQ(json.at("latency_s"), 0.05);
  EXPECT_EQ(json.at("calibration").at("latency_s"), 0.05);
  EXPECT_EQ(json.at("calibration").at("image_to_probe").size(), 16u);
}

TEST(SimulateOptions, OutOfRangeIsRefusedInOneLineThatSaysWhatToDo) {
  const auto refused = [](auto change) {
    SimulateOptions options;
    change(options);
    try {
      options.check();
    } catch (const Error& error) {
      const std::string text = error.what();
      return text.find("; choose") != std::string::npos && text.find('\n') == std::string::npos;
    }
    return false;
  };
  EXPECT_NO_THROW(SimulateOptions().check());
  EXPECT_TRUE(refused([](SimulateOptions& o) { o.object = "ball"; }));
  EXPECT_TRUE(refused([](SimulateOptions& o) { o.pattern = "zigzag"; }));
  EXPECT_TRUE(refused([](SimulateOptions& o) { o.pattern = ""; }));
  EXPECT_TRUE(refused([](SimulateOptions& o) { o.frames = 0; }));
  EXPECT_TRUE(refused([](SimulateOptions& o) { o.frames = 1000000; }));
  EXPECT_TRUE(refused([](SimulateOptions& o) { o.jitter_mm = -1.0; }));
  EXPECT_TRUE(refused([](SimulateOptions& o) { o.jitter_deg = std::nan(""); }));
  EXPECT_TRUE(refused([](SimulateOptions& o) { o.noise_mm = INFINITY; }));
  EXPECT_TRUE(refused([](SimulateOptions& o) { o.latency_s = 60.0; }));
}

TEST(Simulate, SpeckleChangesThePixelsAndNotTheTruth) {
  SimulateOptions options;
  options.frames = 5;
  const SimulatedScan plain = simulate(options);
  options.speckle.emplace();
  const SimulatedScan speckled = simulate(options);
  ASSERT_EQ(plain.outlines[0].contours.size(), speckled.outlines[0].contours.size());
  for (std::size_t i = 0; i < plain.outlines[0].contours.size(); ++i) {
    EXPECT_EQ(plain.outlines[0].contours[i].points_px, speckled.outlines[0].contours[i].points_px);
  }
  const cv::Mat inside = plain.recording->image(2);
  const cv::Mat image = speckled.recording->image(2);
  EXPECT_GT(cv::mean(image, inside == 0)[0], cv::mean(image, inside != 0)[0] + 20.0);
  EXPECT_EQ(cv::countNonZero(image != simulate(options).recording->image(2)), 0);
}

}  // namespace
}  // namespace fathom
