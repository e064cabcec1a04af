#pragma once

#include <functional>

#include "core/error.h"

namespace fathom {

/// Called now and then by long work with the fraction done, in [0, 1]. Returns false to ask the work to stop.
using Progress = std::function<bool(double fraction)>;

/// Thrown by long work that was asked to stop. Nothing half-written is left behind.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled; nothing was written") {}
};

/// Reports `fraction` if anybody listens. Throws Cancelled when the listener asks to stop.
inline void report(const Progress& progress, double fraction) {
  if (progress && !progress(fraction)) throw Cancelled();
}

/// What a step of longer work reports to: its own 0 to 1 becomes `from` to `to` of the whole.
inline Progress part_of(const Progress& progress, double from, double to) {
  if (!progress) return {};
  return [progress, from, to](double fraction) { return progress(from + fraction * (to - from)); };
}

}  // namespace fathom
