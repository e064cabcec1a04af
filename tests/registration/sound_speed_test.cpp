#include "registration/sound_speed.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "registration/point_calibration.h"
#include "tests/registration/target_scans.h"

namespace fathom {
namespace {

// Del Grosso and Mader 1972, JASA 52, 1442, m/s. Other measurements, which the polynomial averages, differ by 0.05 m/s.
TEST(SoundSpeed, IsThatOfTheTables) {
  struct Measured {
    double celsius;
    double m_s;
  };
  for (const Measured& measured : {Measured{0, 1402.39}, {10, 1447.27}, {20, 1482.34}, {30, 1509.13}, {40, 1528.86}}) {
    EXPECT_NEAR(water_sound_speed_m_s(measured.celsius), measured.m_s, 0.05) << measured.celsius;
  }
}

// Bilaniuk and Wong 1993 (148 points, corrected 1996): another fit to such measurements.
TEST(SoundSpeed, AgreesWithAnotherPolynomialEverywhere) {
  constexpr std::array<double, 6> kBilaniukWong = {1.40238744e3,  5.03836171,     -5.81172916e-2,
                                                   3.34638117e-4, -1.48259672e-6, 3.16585020e-9};
  for (double celsius = 0.0; celsius <= 95.0; celsius += 1.0) {
    double speed = 0.0;
    for (std::size_t i = kBilaniukWong.size(); i-- > 0;) speed = speed * celsius + kBilaniukWong[i];
    EXPECT_NEAR(water_sound_speed_m_s(celsius), speed, 0.05) << celsius;
  }
}

TEST(SoundSpeed, OnlyWaterThatIsLiquid) {
  for (const double celsius : {-0.1, 95.1, std::nan("")}) EXPECT_THROW(water_sound_speed_m_s(celsius), Error);
}

// A scanner shows the target of a bath at 20 degrees 3.9 % too deep; corrected, the calibration is the tissue's.
TEST(DepthCorrection, GivesTheCalibrationForTissueFromABathOfWater) {
  Random random(41);
  TargetScanning how;
  how.noise_px = 0.0;
  const TargetScan scan = scan_target(how, false, random);  // as in tissue
  constexpr double kFaceRow = 30.0;
  TargetScan bath = scan;
  for (SpotPoint& point : bath.points) {
    point.position_px.y() = kFaceRow + (point.position_px.y() - kFaceRow) * 1540.0 / 1482.34;
  }
  SpatialOptions options = point_options();
  options.try_latency = options.try_skew = false;
  const SpatialFit uncorrected = calibrate_with_point(bath.tracked(), bath.points, options);
  EXPECT_NEAR(std::exp(uncorrected.state.log_sy - scan.truth.log_sy), 1482.34 / 1540.0, 1e-4);
  EXPECT_NEAR(uncorrected.state.log_sx, scan.truth.log_sx, 1e-4);
  for (SpotPoint& point : bath.points) point.position_px = water_correction(20.0, kFaceRow)(point.position_px);
  const SpatialFit corrected = calibrate_with_point(bath.tracked(), bath.points, options);
  EXPECT_LT(farthest_mm(corrected.state, scan.truth, kScanWidth_px, kScanHeight_px), 0.01);
}

}  // namespace
}  // namespace fathom
