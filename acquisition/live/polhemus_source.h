#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/live/polhemus_line.h"
#include "acquisition/live/source_registry.h"

namespace fathom {

struct PolhemusOptions {
  /// Names of the stations' transforms, from station 1 on; a station beyond is "Station5ToTracker".
  std::vector<std::string> transforms = {"ProbeToTracker", "ReferenceToTracker", "StylusToTracker"};
  /// PATRIOT and LIBERTY state how much metal bends the field, from 0 to 255; a pose with more than this is invalid.
  int most_distortion = 10;
  bool text = false;  ///< records as text, for adapters that pass no binary; else binary
};

/// A Polhemus tracker behind any line. start() opens the line with `open`, sets the instrument up and throws Error
/// when that fails; afterwards a line that is lost, or silent for a second, is opened and set up again until it is
/// back: an instrument that was switched off and on measures in inches. Reports what was lost on the line.
std::unique_ptr<LiveSource> make_polhemus(std::string name, std::function<std::unique_ptr<PolhemusLine>()> open,
                                          const PolhemusOptions& options = {});

/// "polhemus:usb" and "polhemus:/dev/ttyUSB0".
void add_polhemus_sources(SourceRegistry& registry);

}  // namespace fathom
