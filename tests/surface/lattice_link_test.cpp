#include "surface/lattice_link.h"

#include <bit>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace fathom {
namespace {

constexpr std::array<Link, kLinks> kAll = {Link::kInner, Link::kLowOn, Link::kLowBetween, Link::kHighOn,
                                           Link::kHighBetween};

int left_of(const LinkTable& table, int a, int b) {
  return table.left[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
}

// Every edge has a triangle on either side, which is the same from all three of its edges, and the vertices around each
// are one circle; with V - E + F = 2 that is a sphere.
TEST(LatticeLink, IsATriangulatedSphereForEverySample) {
  for (const Link link : kAll) {
    const LinkTable& table = link_table(link);
    int edges = 0;
    int triangles = 0;
    for (int a = 0; a < kLatticeEdges; ++a) {
      const EdgeMask next = table.next[static_cast<std::size_t>(a)];
      EXPECT_EQ(next & ~table.edges, 0);
      EXPECT_EQ(has_edge(table.edges, a), next != 0);
      edges += std::popcount(next);
      for (int b = 0; b < kLatticeEdges; ++b) {
        const int c = left_of(table, a, b);
        ASSERT_EQ(c >= 0, has_edge(next, b));
        if (c < 0) continue;
        ++triangles;
        EXPECT_EQ(left_of(table, b, c), a);
        EXPECT_EQ(left_of(table, c, a), b);
      }
      if (next == 0) continue;
      const int first = std::countr_zero(next);
      EdgeMask met = 0;
      for (int b = first; met == 0 || b != first; b = left_of(table, a, b)) {
        ASSERT_FALSE(has_edge(met, b));
        met |= edge_bit(b);
      }
      EXPECT_EQ(met, next);
    }
    EXPECT_EQ(std::popcount(table.edges) - edges / 2 + triangles / 3, 2) << static_cast<int>(link);
  }
}

// All edges of a sample on a face lead into the lattice, along the face, or across it by the one long edge.
TEST(LatticeLink, OnAFaceOneEdgeLeadsBeyondIt) {
  for (const Link link : kAll) {
    if (link == Link::kInner) continue;
    const LinkTable& table = link_table(link);
    const bool high = link == Link::kHighOn || link == Link::kHighBetween;
    EXPECT_EQ(table.beyond, edge_along({high ? 2 : -2, 0, 0}));
    // What lies beyond is next to just what lies in the face.
    EXPECT_EQ(table.next[static_cast<std::size_t>(table.beyond)], table.in_face);
    const bool on = link == Link::kLowOn || link == Link::kHighOn;
    EXPECT_EQ(std::popcount(table.in_face), on ? 8 : 4);
  }
}

}  // namespace
}  // namespace fathom
