#include "registration/calibration.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/text_file.h"
#include "tests/real_recordings.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

class CalibrationFile : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) {
    const auto path = folder_ / "calibration";
    put(path, text);
    return path;
  }

  std::string complaint(const std::string& text) {
    return message_of<Error>([&] { read_calibration(file(text)); });
  }

  ScratchFolder folder_;
};

// Anisotropic, turned and shifted, with its third column as the convention wants it.
Calibration example() {
  Calibration calibration;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  calibration.probe_from_image.linear() = turn * Eigen::Vector3d(0.08, 0.12, 0.10).asDiagonal();
  calibration.probe_from_image.translation() = Eigen::Vector3d(11.5, -48.25, 3.0);
  calibration.latency_s = 0.0625;
  calibration.probe_frame = "Transducer";
  calibration.reference_frame = "Bed";
  calibration.rms_mm = 0.41;
  calibration.parameters = {"tx_mm", "latency_s"};
  calibration.covariance = Eigen::Matrix2d{{0.04, -0.001}, {-0.001, 0.0009}};
  calibration.image_size = cv::Size(820, 616);
  calibration.depth_mm = 45.0;
  calibration.probe = "L14-5/38";
  calibration.date = "2026-01-31";
  return calibration;
}

TEST_F(CalibrationFile, ReadsBackAllThatWasWritten) {
  const Calibration written = example();
  const Calibration read = read_calibration(file(calibration_json(written)));
  EXPECT_TRUE(read.probe_from_image.isApprox(written.probe_from_image, 1e-14));
  EXPECT_EQ(read.latency_s, written.latency_s);
  EXPECT_EQ(read.probe_frame, written.probe_frame);
  EXPECT_EQ(read.reference_frame, written.reference_frame);
  EXPECT_EQ(read.rms_mm, written.rms_mm);
  EXPECT_EQ(read.parameters, written.parameters);
  EXPECT_EQ(read.covariance, written.covariance);
  EXPECT_EQ(read.image_size, written.image_size);
  EXPECT_EQ(read.depth_mm, written.depth_mm);
  EXPECT_EQ(read.probe, written.probe);
  EXPECT_EQ(read.date, written.date);
}

TEST_F(CalibrationFile, ThirdColumnIsBroughtToTheImageNormalTimesTheMeanPixelSize) {
  Calibration other = example();
  other.probe_from_image.linear().col(2) *= -7.0;
  const Calibration read = read_calibration(file(calibration_json(other)));
  const Eigen::Matrix3d m = read.probe_from_image.linear();
  EXPECT_NEAR(m.col(2).norm(), 0.10, 1e-12);
  EXPECT_GT(m.determinant(), 0.0);
}

TEST_F(CalibrationFile, PlusTransformIsFoundInBothOfItsSections) {
  const std::string transform =
      R"(<Transform From="Image" To="Probe" Matrix="0 0.1 0 1  -0.2 0 0 2  0 0 0.15 3e-001  0 0 0 1"/>)";
  for (const std::string section : {"CoordinateDefinitions", "CalibrationResults"}) {
    const Calibration read = read_calibration(
        file("<?xml version='1.0'?>\n<Plus><" + section + ">" + transform + "</" + section + "></Plus>"));
    EXPECT_TRUE((read.probe_from_image * Eigen::Vector3d(10, 100, 0)).isApprox(Eigen::Vector3d(11, 0, 0.3), 1e-12));
    EXPECT_EQ(read.latency_s, 0.0);
  }
}

TEST_F(CalibrationFile, RealPlusResultIsReadAsItsTextSays) {
  const std::filesystem::path data = real_recordings();
  FATHOM_NEEDS_REAL_RECORDINGS();
  const Calibration read = read_calibration(data / "FreehandCalibration3NWires_fCal2.0.results.xml");
  EXPECT_EQ(read.probe_from_image.translation(), Eigen::Vector3d(11.2137, 48.4162, -0.398993));
  EXPECT_EQ(read.probe_from_image.linear().col(0), Eigen::Vector3d(-0.000519165, -0.0803067, 0.00181709));
  EXPECT_EQ(read.probe_from_image.linear().col(1), Eigen::Vector3d(0.0744587, -6.68987e-5, -0.000804192));
}

TEST_F(CalibrationFile, FaultsAreNamed) {
  const std::string head = R"({"fathom_calibration": 1, "image_to_probe": )";
  EXPECT_NE(complaint("").find("empty"), std::string::npos);
  EXPECT_NE(complaint(R"({"fathom_contours": 1})").find("fathom_calibration"), std::string::npos);
  EXPECT_NE(complaint(head + "[1, 2]}").find("16 numbers"), std::string::npos);
  EXPECT_NE(complaint(head + "[0.1,0,0,0, 0,0.1,0,0, 0,0,0.1,0, 0,0,0,2]}").find("0 0 0 1"), std::string::npos);
  EXPECT_NE(complaint(head + "[0.1,0.1,0,0, 0,0,0,0, 0,0,0.1,0, 0,0,0,1]}").find("singular"), std::string::npos);
  // Metres per pixel, as some laboratories store it.
  EXPECT_NE(complaint(head + "[1e-4,0,0,0, 0,1e-4,0,0, 0,0,1e-4,0, 0,0,0,1]}").find("millimetres"), std::string::npos);
  const std::string good = head + "[0.1,0,0,0, 0,0.1,0,0, 0,0,0.1,0, 0,0,0,1]";
  EXPECT_NE(complaint(good + R"(, "width": 820})").find("height"), std::string::npos);
  EXPECT_NE(complaint(good + R"(, "parameters": ["tx_mm"], "covariance": [[-1]]})").find("covariance"),
            std::string::npos);
  EXPECT_NE(complaint("<Plus><CoordinateDefinitions/></Plus>").find("no transform"), std::string::npos);
  EXPECT_NE(complaint("<Plus><Coord").find("XML"), std::string::npos);
  EXPECT_NE(complaint("<?xml version='1.0'?>\n<!-- nothing -->").find("without any element"), std::string::npos);
  std::string attributes = "<Plus><a";
  for (int i = 0; i < 100'000; ++i) attributes += " a" + std::to_string(i) + "=''";
  EXPECT_NE(complaint(attributes + "/></Plus>").find("attributes"), std::string::npos);
  // Each of these small elements would be parsed into a hundred bytes.
  std::string many = "<Plus>";
  while (many.size() <= 8u << 20) many += "<a/>";
  EXPECT_NE(complaint(many + "</Plus>").find("8 MB"), std::string::npos);
}

}  // namespace
}  // namespace fathom
