#pragma once

#include <array>
#include <cstddef>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "surface/cut_layer.h"

namespace fathom {

/// The values at a sample and at the ends of its edges. The value is that of the centre where the end is missing, and
/// behind the last edge, so that it is not cut.
struct Star {
  alignas(16) std::array<float, 16> value;
  float centre;
  EdgeMask there;  ///< edges whose ends are in the stack
};

/// Values around the samples of a layer. `below` and `above` as before.
class Stars {
 public:
  Stars(const CutLayer& layer, const CutLayer* below, const CutLayer* above);

  Star at(int row, int column) const {
    const bool inner =
        has_both_ && row > 0 && row + 1 < layer_.samples->rows && column > 0 && column + 1 < layer_.samples->columns;
    return inner ? inner_star(row, column) : border_star(row, column);
  }

 private:
  Star inner_star(int row, int column) const;
  Star border_star(int row, int column) const;
  // Leaves out what a sample on a flat side does not have.
  void set_side(Link link, Star& star) const;

  const CutLayer& layer_;
  std::array<const CutLayer*, 3> around_;
  std::array<const float*, 3> values_{};
  bool has_both_;
};

inline Star Stars::inner_star(int row, int column) const {
  // In the order of kLatticeSteps. Shifted rows have the ends with m = -1 in the same column, the others one before.
  const std::ptrdiff_t line = layer_.samples->columns;
  const std::ptrdiff_t place = row * line + column;
  const std::ptrdiff_t left = layer_.shifted(row) ? 0 : -1;
  const float* below = values_[0] + place;
  const float* here = values_[1] + place;
  const float* above = values_[2] + place;
  const float* before = here - line + left;
  const float* after = here + line + left;
  Star star;
  star.centre = *here;
  star.there = kAllEdges;
#if defined(__SSE2__)
  float* value = star.value.data();
  _mm_store_ps(value, _mm_setr_ps(below[-line], below[left], below[left + 1], below[line]));
  _mm_store_ps(value + 4, _mm_setr_ps(before[0], before[1], here[-1], here[1]));
  _mm_store_ps(value + 8, _mm_setr_ps(after[0], after[1], above[-line], above[left]));
  _mm_store_ps(value + 12, _mm_setr_ps(above[left + 1], above[line], *here, *here));
#else
  star.value = {below[-line],    below[left], below[left + 1], below[line], before[0],    before[1],
                here[-1],        here[1],     after[0],        after[1],    above[-line], above[left],
                above[left + 1], above[line], *here,           *here};
#endif
  return star;
}

}  // namespace fathom
