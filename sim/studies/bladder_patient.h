#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "sim/phantom.h"
#include "sim/simulate.h"

namespace fathom {

/// When the ten scans of Treece 2000, table 2.3 were made, in minutes: pairs, and the bladder was partly emptied in the
/// middle between two pairs.
inline constexpr std::array<double, 10> kBladderScans_min = {
    0.0, 40.0 / 60, 174.0 / 60, 234.0 / 60, 317.0 / 60, 358.0 / 60, 448.0 / 60, 487.0 / 60, 626.0 / 60, 662.0 / 60};
inline constexpr std::size_t kBladderPairs = 5;
inline constexpr std::size_t kBladderVoids = kBladderPairs - 1;

/// A patient whose bladder fills all the time, at a rate that changes slowly, and is emptied in four parts.
///
/// A full bladder holds 250 to 450 ml and has semi-axes about as 36 : 30 : 24. At a share f of that it has f^0.25,
/// f^0.3 and f^0.45 times their lengths: the emptier, the flatter, and its volume is f times the full one, exactly.
class BladderPatient {
 public:
  /// The same seed is the same patient.
  explicit BladderPatient(std::uint64_t seed);

  /// The true volume at a time of the experiment, at which it was not just emptied.
  double volume_ml(double minutes) const;
  /// What filled it between two times.
  double filled_ml(double from_min, double to_min) const;
  /// What left it between pair `i` and the next.
  double voided_ml(std::size_t i) const { return voided_ml_.at(i); }
  /// The same as measured with a syringe, to +-1 ml.
  double measured_void_ml(std::size_t i) const { return measured_void_ml_.at(i); }

  Phantom bladder(double volume_ml) const;

 private:
  Eigen::Vector3d full_mm_ = Eigen::Vector3d::Ones();
  double full_ml_ = 0.0;
  double rate_ml_per_min_ = 0.0;
  double rate_phase_rad_ = 0.0;
  std::array<double, kBladderVoids> voided_ml_{};
  std::array<double, kBladderVoids> measured_void_ml_{};
};

/// Middle of the pause in which the bladder is emptied, after pair `i`; and of pair `i` itself.
double void_time_min(std::size_t i);
double pair_time_min(std::size_t i);

}  // namespace fathom
