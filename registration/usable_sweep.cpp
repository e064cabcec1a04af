#include "registration/usable_sweep.h"

#include <array>
#include <cmath>

#include "core/error.h"
#include "core/numbers.h"
#include "registration/spatial_calibration_errors.h"
#include "registration/spatial_calibration_motion.h"

namespace fathom {

namespace {

constexpr double kLeastTracked = 0.6;  // of the frames that show the target: through larger gaps a sweep is no motion
constexpr double kStillMm = 1.0;       // standard deviations, as a tracker's noise of a probe on the table
constexpr double kStillDeg = 1.0;
constexpr double kTurningMm = 0.5;  // a sensor that turns moves more than this, unless millimetres are metres
constexpr double kTurningDeg = 3.0;

}  // namespace

void require_usable_sweep(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                          const SpatialOptions& options) {
  const std::vector<int> seen = frames_of(observations, std::vector<bool>(observations.size(), true));
  std::vector<int> tracked;
  for (const int frame : seen) {
    if (poses.poses()[static_cast<std::size_t>(frame)]) tracked.push_back(frame);
  }
  const std::string target = name_of(options.target);
  if (static_cast<int>(tracked.size()) < options.min_frames) {
    throw Error(poses.recording() + ": " + target + (options.target == CalibrationTarget::kWires ? " were" : " was") +
                " found and the probe tracked in " + std::to_string(tracked.size()) + " frames only, " +
                std::to_string(options.min_frames) + " are needed; record a longer sweep with " + target +
                " and the tracker in view");
  }
  if (static_cast<double>(tracked.size()) < kLeastTracked * static_cast<double>(seen.size())) {
    throw Error(poses.recording() + ": the tracker saw the probe in only " + std::to_string(tracked.size()) +
                " of the " + std::to_string(seen.size()) + " frames that show " + target +
                "; record again with the probe's sensor in the tracker's view");
  }
  const ProbeMotion motion = probe_motion(poses, tracked, SpatialState{});
  const double turned_deg = motion.turned_deg.norm();
  if (motion.moved_mm < kTurningMm && turned_deg > kTurningDeg) {
    throw Error(poses.recording() + ": the probe turned by " + format_rounded(turned_deg, 0) +
                " degrees but moved by only " + format_rounded(motion.moved_mm, 3) +
                " mm, so its poses seem to be in metres; they must be in millimetres");
  }
  if (motion.moved_mm < kStillMm && turned_deg < kStillDeg) {
    throw Error(poses.recording() + ": the probe did not move (or its poses are not in millimetres); record again: " +
                movement_from_rest(options.target));
  }
}

void require_agreement(const ProbePoses& poses, const SpatialFit& fit, const SpatialOptions& options) {
  struct Expected {
    double most_rms_mm;  // beyond, what was seen is something else
    const char* advice;
  };
  // Good sweeps over wires have 0.5 mm. A point is seen anywhere within the beam's thickness, some millimetres.
  constexpr std::array<Expected, 3> kExpected = {
      Expected{1.0, "check that the phantom's file is that of the phantom scanned, in millimetres"},
      {1.5, "check that the floor is flat and lay still, and that its echo is the brightest line in the images"},
      {2.0, "check that the point lay still and is the brightest spot in the images"}};
  const Expected& expected = kExpected[static_cast<std::size_t>(options.target)];
  if (fit.rms_mm <= expected.most_rms_mm && 2 * fit.frames_used >= fit.frames_seen) return;
  const bool wires = options.target == CalibrationTarget::kWires;
  throw Error(
      poses.recording() + ": " +
      (wires ? "the wires seen do not fit the phantom (" : name_of(options.target) + " is not one and the same (") +
      std::to_string(fit.frames_used) + " of " + std::to_string(fit.frames_seen) + " frames agree, to " +
      format_rounded(fit.rms_mm, 2) + " mm); " + expected.advice);
}

}  // namespace fathom
