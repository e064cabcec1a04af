#include <chrono>

#include "acquisition/live/live_source.h"

namespace fathom {

double live_clock_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace fathom
