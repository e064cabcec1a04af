#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "surface/body_centred.h"

namespace fathom {

/// Where a sample lies in a lattice with flat sides (SampledLayer::flat_sides), and so how its neighbours are joined.
///
/// In such a lattice the first and the last sample of every row lie on the same two faces: of every other row because
/// that is where the lattice has them, of the rows between because they were drawn in from half a column beyond. Among
/// four such samples, two of each kind, there was a tetrahedron; it has become flat and is left out, and with it the
/// edge between the two that were drawn in. In the faces the diagonals between the others remain. What is beyond a
/// face, whether nothing or a cap, is one more end for all samples on it: the one of the long edge across the face.
enum class Link : std::uint8_t { kInner, kLowOn, kLowBetween, kHighOn, kHighBetween };
inline constexpr int kLinks = 5;

/// The neighbours of a sample: a triangulated sphere whose vertices are named by the edges that lead to them.
struct LinkTable {
  std::array<EdgeMask, kLatticeEdges> next{};                                ///< as kNextEdges
  std::array<std::array<std::int8_t, kLatticeEdges>, kLatticeEdges> left{};  ///< as kLeftOf
  EdgeMask edges = kAllEdges;                                                ///< those that the sample has
  EdgeMask in_face = 0;                                                      ///< edges within the face
  int beyond = -1;  ///< the edge across the face, if it is on one
};

extern const std::array<LinkTable, kLinks> kLinkTables;
inline const LinkTable& link_table(Link link) { return kLinkTables[static_cast<std::size_t>(link)]; }

/// That of a sample on a face: on which, and whether the lattice has it there.
constexpr Link face_link(bool high, bool on) {
  if (high) return on ? Link::kHighOn : Link::kHighBetween;
  return on ? Link::kLowOn : Link::kLowBetween;
}

}  // namespace fathom
