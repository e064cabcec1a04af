#pragma once

#include <memory>
#include <string>

#include "acquisition/live/source_registry.h"
#include "sim/simulate.h"

namespace fathom {

/// A simulated scanner and tracker, live.
struct LiveSimulationOptions {
  SimulateOptions scan;   ///< object, pattern, frames of one way, jitter, tracker noise, latency, speckle, seed
  double rate_hz = 25.0;  ///< of images
  double tracker_rate_hz = 100.0;
  bool loop = true;  ///< the probe goes to and fro until stopped; else one way

  static constexpr int kMostFrames = 2000;  ///< all images are held in memory
  static constexpr double kHighestRate_hz = 1000.0;

  /// Throws Error when a value is out of range.
  void check() const;
};

/// Images at their rate, and samples of "ProbeToTracker" and "ReferenceToTracker" at theirs, all on time and without
/// loss, so that what a recording lacks was lost elsewhere. A sample stamped t is the pose at t - latency_s, between
/// frames by interpolation, with noise of its own. Between the sweeps of a pattern images are black and the probe is
/// OUT_OF_VIEW. The calibration is that of `fathom simulate` for the same object and pattern.
std::unique_ptr<LiveSource> make_live_simulation(std::string name, const LiveSimulationOptions& options);

/// Adds "sim:OBJECT/PATTERN" with the options frames, rate, tracker_rate, latency_s, noise_mm, noise_deg, jitter_mm,
/// jitter_deg, seed, speckle=1 and loop=0.
void add_simulated_sources(SourceRegistry& registry);

/// Every kind of source that there is: default_sources() and these.
SourceRegistry all_sources();

}  // namespace fathom
