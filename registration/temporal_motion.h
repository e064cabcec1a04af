#pragma once

#include "registration/temporal_calibration.h"

namespace fathom {

/// The same as find_latency for a probe that also tilts: where the tracker says that the floor lies under it. A sensor
/// is a hand's breadth from the image, so that a tilt of one degree moves the floor by millimetres, which the sensor's
/// place alone does not tell. The first latency is that of the sensor's place along its line; then the floor's depth is
/// taken to be a linear function of all six coordinates of the probe (small turns), and the latency is found again with
/// that function of the tracker's poses. Throws Error as find_latency and motion_signal.
TemporalCalibration find_latency(const Signal& image, const ProbePoses& tracker, const TemporalOptions& options = {});

}  // namespace fathom
