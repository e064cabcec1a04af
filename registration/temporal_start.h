#pragma once

#include <string>

#include "registration/temporal_calibration.h"
#include "registration/temporal_signals.h"

namespace fathom {

/// Of the search for a latency, s: the correlation of a hand's motion is round over ten times that.
inline constexpr double kLatencyStep_s = 0.005;

/// The middle of five values each: a floor mistaken in single frames does not disturb the search.
Signal without_spikes(const Signal& signal);

/// The latency within the range at which the signals resemble each other most, to a step. `both` names them in
/// messages. Throws Error when they share too little time, do not resemble each other, or do so at several latencies.
double latency_start(const Signal& image, const SmoothSignal& tracker, const TemporalOptions& options,
                     const std::string& both);

}  // namespace fathom
