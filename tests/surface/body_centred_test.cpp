#include "surface/body_centred.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace fathom {
namespace {

// Treece 2000, table C.1: the edges next to each edge.
constexpr std::array<EdgeMask, kLatticeEdges> kPublishedNext = {0x321A, 0x2015, 0x24B2, 0x0251, 0x006F, 0x00D4, 0x03B8,
                                                                0x0D64, 0x0AC0, 0x1949, 0x2884, 0x3780, 0x2A01, 0x1C07};

// Table C.2: two edges next to each other, and the two that are next to both.
struct PublishedPair {
  EdgeMask adjacent;
  EdgeMask opposite;
};
constexpr std::array<PublishedPair, 36> kPublishedPairs = {
    {{0x0003, 0x2010}, {0x0009, 0x0210}, {0x0011, 0x000A}, {0x0201, 0x1008}, {0x1001, 0x2200}, {0x2001, 0x1002},
     {0x0006, 0x2010}, {0x0012, 0x0005}, {0x2002, 0x0005}, {0x0014, 0x0022}, {0x0024, 0x0090}, {0x0084, 0x0420},
     {0x0404, 0x2080}, {0x2004, 0x0402}, {0x0018, 0x0041}, {0x0048, 0x0210}, {0x0208, 0x0041}, {0x0030, 0x0044},
     {0x0050, 0x0028}, {0x0060, 0x0090}, {0x00A0, 0x0044}, {0x00C0, 0x0120}, {0x0140, 0x0280}, {0x0240, 0x0108},
     {0x0180, 0x0840}, {0x0480, 0x0804}, {0x0880, 0x0500}, {0x0300, 0x0840}, {0x0900, 0x0280}, {0x0A00, 0x1100},
     {0x1200, 0x0801}, {0x0C00, 0x2080}, {0x2400, 0x0804}, {0x1800, 0x2200}, {0x2800, 0x1400}, {0x3000, 0x0801}}};

EdgeMask renamed(EdgeMask mask, const std::array<int, kLatticeEdges>& names) {
  EdgeMask result = 0;
  for (int e = 0; e < kLatticeEdges; ++e) {
    if (has_edge(mask, e)) result |= edge_bit(names[static_cast<std::size_t>(e)]);
  }
  return result;
}

// Extends `names`, from published numbers to ours, edge by edge so that what is next to each other stays so.
bool find_names(int edge, unsigned used, std::array<int, kLatticeEdges>& names) {
  if (edge == kLatticeEdges) return true;
  for (int name = 0; name < kLatticeEdges; ++name) {
    if ((used >> name & 1U) != 0) continue;
    bool fits = true;
    for (int other = 0; other < edge && fits; ++other) {
      fits = has_edge(kPublishedNext[static_cast<std::size_t>(edge)], other) ==
             has_edge(kNextEdges[static_cast<std::size_t>(name)], names[static_cast<std::size_t>(other)]);
    }
    if (!fits) continue;
    names[static_cast<std::size_t>(edge)] = name;
    if (find_names(edge + 1, used | 1U << name, names)) return true;
  }
  return false;
}

TEST(BodyCentred, NextEdgesAreThoseOfTableC1UpToTheirNumbers) {
  std::array<int, kLatticeEdges> names{};
  ASSERT_TRUE(find_names(0, 0, names));
  for (std::size_t e = 0; e < kLatticeEdges; ++e) {
    EXPECT_EQ(renamed(kPublishedNext[e], names), kNextEdges[static_cast<std::size_t>(names[e])]);
    // There, too, opposite edges are 7 apart.
    EXPECT_EQ(names[(e + 7) % kLatticeEdges], opposite_edge(names[e]));
  }
}

TEST(BodyCentred, TrianglesOfTheLinkAreThoseOfTableC2) {
  std::array<int, kLatticeEdges> names{};
  ASSERT_TRUE(find_names(0, 0, names));
  std::set<EdgeMask> pairs;
  for (const PublishedPair& pair : kPublishedPairs) {
    const EdgeMask adjacent = renamed(pair.adjacent, names);
    const int a = std::countr_zero(adjacent);
    const int b = std::countr_zero(static_cast<EdgeMask>(adjacent & (adjacent - 1)));
    const auto left = kLeftOf[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
    const auto right = kLeftOf[static_cast<std::size_t>(b)][static_cast<std::size_t>(a)];
    ASSERT_GE(left, 0);
    ASSERT_GE(right, 0);
    EXPECT_EQ(edge_bit(left) | edge_bit(right), renamed(pair.opposite, names));
    pairs.insert(adjacent);
  }
  EXPECT_EQ(pairs.size(), 36U);
}

TEST(BodyCentred, LinkIsASphere) {
  int ends = 0;
  int triangles = 0;
  for (std::size_t a = 0; a < kLatticeEdges; ++a) {
    const int around = std::popcount(kNextEdges[a]);
    EXPECT_EQ(around, kLatticeSteps[a].m == 2 || kLatticeSteps[a].m == -2 || kLatticeSteps[a].m == 0 ? 4 : 6);
    ends += around;
    for (std::size_t b = 0; b < kLatticeEdges; ++b) triangles += kLeftOf[a][b] >= 0 ? 1 : 0;
  }
  EXPECT_EQ(ends, 2 * 36);
  EXPECT_EQ(triangles, 3 * 24);
}

TEST(BodyCentred, SixTetrahedraFillTheCellOfASample) {
  int volume = 0;
  for (const auto& own : kOwnTetrahedra) {
    EXPECT_EQ(orientation(own[0], own[1], own[2]), 2);  // six times the volume, positive
    volume += orientation(own[0], own[1], own[2]);
  }
  // A sample has a box of 2 by 1 by 1 steps to itself.
  EXPECT_EQ(volume, 6 * 2);
}

}  // namespace
}  // namespace fathom
