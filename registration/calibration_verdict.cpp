#include "registration/calibration_verdict.h"

#include <algorithm>
#include <array>

#include "core/numbers.h"
#include "registration/spatial_calibration_motion.h"

namespace fathom {

namespace {

struct Criterion {
  double value;
  double good;  // up to this
  double usable;
  std::string what;
  std::string advice;
};

double turned_in(const CalibrationScan& scan, const SpatialState& state) {
  std::vector<int> frames;
  for (const WirePoint& point : scan.wires) {
    if (frames.empty() || frames.back() != point.frame) frames.push_back(point.frame);
  }
  return probe_motion(scan.poses, frames, state).turned_deg.norm();
}

}  // namespace

CalibrationVerdict verdict_on(const SpatialFit& fit, const CalibrationScan& scan, CalibrationTarget target,
                              const std::optional<ScanErrors>& validation) {
  // A point's place is known to a few tenths of a millimetre by the best trackers: a calibration should not be worse.
  // A point target is seen anywhere within the beam's thickness, so that more disagreement is usual.
  const bool point = target == CalibrationTarget::kPoint;
  const double left_out = 1.0 - static_cast<double>(fit.frames_used) / std::max(1, fit.frames_seen);
  std::vector<Criterion> criteria = {
      {fit.worst_point_sd_mm, 0.3, 1.0,
       "a pixel's place is known to " + format_rounded(fit.worst_point_sd_mm, 2) + " mm",
       "record longer, and turn the probe farther about all axes"},
      {fit.rms_mm, point ? 1.0 : 0.7, point ? 1.5 : 1.0,
       "what was seen agrees to " + format_rounded(fit.rms_mm, 2) + " mm only",
       "move more slowly and keep metal away from the tracker"},
      {left_out, 0.1, 0.3, format_rounded(100.0 * left_out, 0) + " % of the frames were left out",
       "check gain and focus, and keep the sensor in the tracker's view"}};
  if (validation) {
    criteria.push_back({validation->mean_mm, point ? 1.2 : 0.8, point ? 2.0 : 1.5,
                        "the second sweep is off by " + format_rounded(validation->mean_mm, 2) + " mm",
                        "check that neither the sensor on the probe nor the phantom has moved"});
  }
  if (target == CalibrationTarget::kWires && !fit.fitted[kPhantomTx]) {
    // Of a probe that only slides, a phantom farther away looks like an image farther away.
    constexpr double kTurnedDeg = 6.0;
    const double turned_deg = turned_in(scan, fit.state);
    criteria.push_back({kTurnedDeg - turned_deg, 0.0, kTurnedDeg,
                        "the probe turned by +-" + format_rounded(turned_deg, 0) +
                            " degrees only, so that a mistake in the phantom's registration would not show",
                        "twist, tilt and rock it"});
  }
  CalibrationVerdict verdict;
  std::string reasons;
  for (const Criterion& criterion : criteria) {
    if (criterion.value <= criterion.good) continue;
    const auto grade = criterion.value <= criterion.usable ? CalibrationGrade::kUsable : CalibrationGrade::kDoAgain;
    verdict.grade = std::max(verdict.grade, grade);
    reasons += (reasons.empty() ? "" : "; ") + criterion.what + " (" + criterion.advice + ")";
  }
  constexpr std::array<const char*, 3> kWords = {"good", "usable", "do again"};
  verdict.text = kWords[static_cast<std::size_t>(verdict.grade)];
  if (!reasons.empty()) verdict.text += ": " + reasons;
  return verdict;
}

}  // namespace fathom
