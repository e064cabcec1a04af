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

}  // namespace fathom
