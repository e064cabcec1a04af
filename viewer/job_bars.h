#pragma once

#include <array>
#include <string>

#include "viewer/session.h"

namespace fathom {

/// The bars of work under way with their Cancel buttons, side by side in the status line. A bar keeps its place until
/// its work ends, and no other takes that place while the pointer is on the line: what is about to be pressed never
/// turns into another button.
class JobBars {
 public:
  /// From the cursor to the right; leaves the cursor behind the bars, on the same line.
  void draw(Session& session);

 private:
  static constexpr std::size_t kBars = 3;
  std::array<std::string, kBars> places_;  // keys of jobs; empty: free
};

}  // namespace fathom
