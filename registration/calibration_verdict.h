#pragma once

#include <optional>
#include <string>

#include "registration/calibration_scan.h"

namespace fathom {

/// How good a calibration is.
enum class CalibrationGrade { kGood, kUsable, kDoAgain };

struct CalibrationVerdict {
  CalibrationGrade grade = CalibrationGrade::kGood;
  std::string text;  ///< "good", or "usable: ..." and "do again: ..." with what is not as it should be, and what to do
};

/// Judges a calibration by how well the sweep determines it, how well its frames agree and how many had to be left
/// out, by a second sweep where there is one, and, where a registered phantom was used, by whether the probe turned so
/// far that a wrong registration would show. Each is good, usable or bad by the table in the source, which the user's
/// guide repeats; the worst counts.
CalibrationVerdict verdict_on(const SpatialFit& fit, const CalibrationScan& scan, CalibrationTarget target,
                              const std::optional<ScanErrors>& validation);

}  // namespace fathom
