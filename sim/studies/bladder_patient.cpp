#include "sim/studies/bladder_patient.h"

#include <cmath>
#include <numbers>

#include "core/random.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
// What leaves the bladder, as shares of what is in it: about 25, 74, 156 and 234 ml of Treece 2000, table 2.3.
constexpr std::array<double, kBladderVoids> kVoidedShares = {0.07, 0.20, 0.48, 0.95};
constexpr double kShareSpread = 0.15;  // from patient to patient, of the share
constexpr double kSyringe_ml = 1.0;    // either way
const Eigen::Vector3d kProportions(36.0, 30.0, 24.0);
constexpr double kProportionSpread = 0.12;
const Eigen::Array3d kEmptying(0.25, 0.30, 0.45);  // exponents; their sum is 1, so that volumes are exact
constexpr double kFewest_ml = 250.0;
constexpr double kMost_ml = 450.0;
constexpr double kSlowest_ml_per_min = 8.0;  // published, estimated: 8 to 31
constexpr double kFastest_ml_per_min = 25.0;
constexpr double kRateSwing = 0.3;  // of the rate, either way
constexpr double kRatePeriod_min = 20.0;
constexpr double kDepthPixel_mm = 0.30;  // 192 x 144 mm: the depth setting that shows all of a full bladder

}  // namespace

double pair_time_min(std::size_t i) { return (kBladderScans_min.at(2 * i) + kBladderScans_min.at(2 * i + 1)) / 2.0; }

double void_time_min(std::size_t i) {
  return (kBladderScans_min.at(2 * i + 1) + kBladderScans_min.at(2 * i + 2)) / 2.0;
}

BladderPatient::BladderPatient(std::uint64_t seed) {
  Random random(seed);
  full_ml_ = random.uniform(kFewest_ml, kMost_ml);
  for (int axis = 0; axis < 3; ++axis) {
    full_mm_[axis] = kProportions[axis] * random.uniform(1.0 - kProportionSpread, 1.0 + kProportionSpread);
  }
  full_mm_ *= std::cbrt(full_ml_ * kMm3PerMl / (4.0 / 3.0 * std::numbers::pi * full_mm_.prod()));
  rate_ml_per_min_ = random.uniform(kSlowest_ml_per_min, kFastest_ml_per_min);
  rate_phase_rad_ = random.uniform(0.0, 2.0 * std::numbers::pi);
  double in_it_ml = full_ml_;
  double since_min = 0.0;
  for (std::size_t i = 0; i < kBladderVoids; ++i) {
    in_it_ml += filled_ml(since_min, void_time_min(i));
    since_min = void_time_min(i);
    const double spread = random.uniform(1.0 - kShareSpread, 1.0 + kShareSpread);
    voided_ml_[i] = in_it_ml * std::min(kVoidedShares[i] * spread, kVoidedShares.back());
    measured_void_ml_[i] = voided_ml_[i] + random.uniform(-kSyringe_ml, kSyringe_ml);
    in_it_ml -= voided_ml_[i];
  }
}

double BladderPatient::filled_ml(double from_min, double to_min) const {
  const double speed = 2.0 * std::numbers::pi / kRatePeriod_min;
  const auto swung = [&](double minutes) { return -std::cos(speed * minutes + rate_phase_rad_) / speed; };
  return rate_ml_per_min_ * (to_min - from_min + kRateSwing * (swung(to_min) - swung(from_min)));
}

double BladderPatient::volume_ml(double minutes) const {
  double volume_ml = full_ml_ + filled_ml(0.0, minutes);
  for (std::size_t i = 0; i < kBladderVoids; ++i) {
    if (void_time_min(i) < minutes) volume_ml -= voided_ml_[i];
  }
  return volume_ml;
}

Phantom BladderPatient::bladder(double volume_ml) const {
  const double share = volume_ml / full_ml_;
  const Eigen::Vector3d semi_axes_mm = (full_mm_.array() * Eigen::Array3d(share, share, share).pow(kEmptying)).matrix();
  return make_bladder(semi_axes_mm, kDepthPixel_mm);
}

}  // namespace fathom
