#pragma once

#include <array>
#include <bit>
#include <cstddef>

namespace fathom {

/// Even permutations of a tetrahedron's corners that bring one corner, or two, to the front.
inline constexpr std::array<std::array<int, 4>, 4> kOneFirst = {
    {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};
constexpr std::array<int, 4> pair_first(unsigned inside) {
  switch (inside) {
    case 0b0011:
      return {0, 1, 2, 3};
    case 0b0101:
      return {0, 2, 3, 1};
    case 0b1001:
      return {0, 3, 1, 2};
    case 0b0110:
      return {1, 2, 0, 3};
    case 0b1010:
      return {1, 3, 2, 0};
    default:
      return {2, 3, 0, 1};
  }
}

/// The triangles between inside and outside in a positive tetrahedron: `add` gets three times two of its corners, of
/// the edges that are cut. `inside` has a bit for each corner.
template <typename Add>
void cut_tetrahedron(unsigned inside, const Add& add) {
  const int count = std::popcount(inside);
  if (count == 0 || count == 4) return;
  const unsigned lone = count == 1 ? inside : ~inside & 0xFU;
  const std::array<int, 4> order =
      count == 2 ? pair_first(inside) : kOneFirst[static_cast<std::size_t>(std::countr_zero(lone)) & 3U];
  const auto edge = [&order](std::size_t i, std::size_t j) {
    return std::array<std::size_t, 2>{static_cast<std::size_t>(order[i]), static_cast<std::size_t>(order[j])};
  };
  if (count == 2) {
    add(edge(0, 2), edge(0, 3), edge(1, 3));
    add(edge(0, 2), edge(1, 3), edge(1, 2));
  } else if (count == 1) {
    add(edge(0, 1), edge(0, 2), edge(0, 3));
  } else {
    add(edge(0, 1), edge(0, 3), edge(0, 2));
  }
}

}  // namespace fathom
