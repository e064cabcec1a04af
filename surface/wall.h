#pragma once

#include <array>
#include <cstddef>

#include "surface/cut_layer.h"
#include "surface/star.h"

namespace fathom {

/// A face that ends or closes the lattice, as a sample on it sees it.
struct Wall {
  LatticeStep outward;   ///< across columns, rows or layers: -1 or 1 in one of these
  EdgeMask within = 0;   ///< edges to other samples on the wall
  EdgeMask through = 0;  ///< edges across it, to nothing or to samples that are made up
};

/// The walls that a sample lies on: at most one across columns, rows and layers each.
class Walls {
 public:
  /// None.
  Walls() = default;
  /// `below` and `above` are the layers around; null, or `beyond`, where the stack ends.
  Walls(const CutLayer& layer, const CutLayer* below, const CutLayer* above, const CutSample& sample, const Star& star);

  const Wall* begin() const { return walls_.data(); }
  const Wall* end() const { return walls_.data() + count_; }
  bool any() const { return count_ > 0; }

  /// Of the cuts that become one vertex, those that say where: on a wall only those within it, so that the rim stays
  /// there, or else those through it.
  EdgeMask bound(EdgeMask cuts) const;

 private:
  std::array<Wall, 3> walls_;
  std::size_t count_ = 0;
};

}  // namespace fathom
