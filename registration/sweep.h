#pragma once

#include <cstddef>

namespace fathom {

/// One motion of the probe: a run of consecutive frames of a recording.
struct Sweep {
  std::size_t recording = 0;  ///< index in the exam; 0 where there is one recording
  int first = 0;              ///< frame, as stored
  int last = 0;               ///< frame, inclusive; never before `first`

  bool operator==(const Sweep&) const = default;
};

inline int frame_count(const Sweep& sweep) { return sweep.last - sweep.first + 1; }

inline bool contains(const Sweep& sweep, int frame) { return frame >= sweep.first && frame <= sweep.last; }

}  // namespace fathom
