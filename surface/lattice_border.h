#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "surface/sampled_layer.h"

namespace fathom {

/// What closes a surface at the sides of a box: a layer with one more sample, outside, on either end of its rows, and
/// one more row of such samples on either side.
///
/// That far outside, the surface is cut off at the last samples within the box, and so flat, wherever these lie on a
/// face. The columns of a body-centred lattice do not: on the face from which every other row begins half a column
/// further, the cap would be a zigzag. Where all samples around one on such a face are inside, the surface may as well
/// be cut off half-way between the last samples and the added ones, which is on the face.
struct BorderedLayer {
  SampledLayer samples;
  int parity = 0;  ///< of the layer's number
  /// For each row, at its beginning (0) and end (1): the sample on the face may be moved next to the surface.
  std::vector<std::array<std::uint8_t, 2>> flat;
};

/// Marks the added samples as outside.
void add_border(BorderedLayer& layer);

/// Fills in `flat`. `below` and `above` are null at the ends of the stack.
void find_flat_sides(BorderedLayer& layer, const BorderedLayer* below, const BorderedLayer* above);

/// Flattens the sides of a layer of the body-centred lattice. `flat` of all three is filled in.
void flatten_sides(BorderedLayer& layer, const BorderedLayer* below, const BorderedLayer* above);

}  // namespace fathom
