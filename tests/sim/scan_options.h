#pragma once

#include <string>

#include "sim/simulate.h"

namespace fathom {

inline SimulateOptions options_of(const std::string& object, const std::string& pattern, int frames) {
  SimulateOptions options;
  options.object = object;
  options.pattern = pattern;
  options.frames = frames;
  return options;
}

}  // namespace fathom
