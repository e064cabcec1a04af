#include "surface/lattice_link.h"

#include <cassert>
#include <cstddef>
#include <utility>

namespace fathom {

namespace {

// The four short edges to one side of a sample along its row, in a circle.
constexpr std::array<int, 4> circle(int m) {
  return {edge_along({m, -1, 0}), edge_along({m, 0, -1}), edge_along({m, 1, 0}), edge_along({m, 0, 1})};
}

constexpr void remove_triangle(LinkTable& table, int a, int b, int c) {
  for (const auto& [x, y] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    table.left[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)] = -1;
  }
}

constexpr void add_triangle(LinkTable& table, int a, int b, int c) {
  const std::array<int, 3> corners = {a, b, c};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto x = static_cast<std::size_t>(corners[i]);
    const auto y = static_cast<std::size_t>(corners[(i + 1) % 3]);
    table.left[x][y] = static_cast<std::int8_t>(corners[(i + 2) % 3]);
    table.next[x] |= edge_bit(corners[(i + 1) % 3]);
    table.next[y] |= edge_bit(corners[i]);
  }
}

constexpr LinkTable inner() {
  LinkTable table;
  table.next = kNextEdges;
  table.left = kLeftOf;
  return table;
}

// The edges to two neighbours that were drawn in are no longer next to each other: what is beyond the face is between.
constexpr LinkTable on_face(int outward) {
  LinkTable table = inner();
  table.beyond = edge_along({2 * outward, 0, 0});
  const std::array<int, 4> drawn_in = circle(outward);
  for (std::size_t i = 0; i < 4; ++i) {
    int a = drawn_in[i];
    int b = drawn_in[(i + 1) % 4];
    // So turned that the face's own sample is on the left.
    if (kLeftOf[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] == table.beyond) std::swap(a, b);
    const int own = kLeftOf[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
    assert(kLeftOf[static_cast<std::size_t>(b)][static_cast<std::size_t>(a)] == table.beyond);
    remove_triangle(table, a, b, own);
    remove_triangle(table, b, a, table.beyond);
    table.next[static_cast<std::size_t>(a)] &= static_cast<EdgeMask>(~edge_bit(b));
    table.next[static_cast<std::size_t>(b)] &= static_cast<EdgeMask>(~edge_bit(a));
    table.in_face |= static_cast<EdgeMask>(edge_bit(a) | edge_bit(own));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    int a = drawn_in[i];
    int b = drawn_in[(i + 1) % 4];
    if (kLeftOf[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] == table.beyond) std::swap(a, b);
    const int own = kLeftOf[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
    add_triangle(table, a, table.beyond, own);
    add_triangle(table, table.beyond, b, own);
  }
  return table;
}

// A sample that was drawn in: an octahedron of the next one of its row, the four beside it on the face, and what is
// beyond.
constexpr LinkTable between(int outward) {
  LinkTable table;
  for (auto& row : table.left) row.fill(-1);
  table.beyond = edge_along({2 * outward, 0, 0});
  const int next = edge_along({-2 * outward, 0, 0});
  const std::array<int, 4> around = circle(-outward);
  for (std::size_t i = 0; i < 4; ++i) {
    int a = around[i];
    int b = around[(i + 1) % 4];
    if (kLeftOf[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] != next) std::swap(a, b);
    add_triangle(table, a, b, next);
    add_triangle(table, b, a, table.beyond);
    table.in_face |= edge_bit(a);
  }
  table.edges = static_cast<EdgeMask>(table.in_face | edge_bit(next) | edge_bit(table.beyond));
  return table;
}

}  // namespace

constinit const std::array<LinkTable, kLinks> kLinkTables = {inner(), on_face(-1), between(-1), on_face(1), between(1)};

}  // namespace fathom
