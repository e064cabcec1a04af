#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace fathom {

/// The body-centred cubic lattice of Treece 2000, figure 3.21 (c), by whole numbers: samples lie at (m, j, k) with an
/// even sum, m along a row, j from row to row, k from layer to layer. Everything that is the same around every sample
/// is made here from that geometry.

/// From a sample to another one, in (m, j, k).
struct LatticeStep {
  int m = 0;
  int j = 0;
  int k = 0;

  constexpr bool operator==(const LatticeStep&) const = default;
  constexpr LatticeStep operator-(const LatticeStep& other) const { return {m - other.m, j - other.j, k - other.k}; }
};

/// Edges from a sample. They are numbered in the order of (k, j, m), so that the opposite of edge e is
/// kLatticeEdges - 1 - e and those of the second half lead to samples that come later in that order.
inline constexpr int kLatticeEdges = 14;
inline constexpr int kFirstForwardEdge = kLatticeEdges / 2;

/// A set of edges around a sample, bit e for edge e.
using EdgeMask = std::uint16_t;
inline constexpr EdgeMask kAllEdges = (1 << kLatticeEdges) - 1;

constexpr int opposite_edge(int edge) { return kLatticeEdges - 1 - edge; }
constexpr EdgeMask edge_bit(int edge) { return static_cast<EdgeMask>(1 << edge); }
constexpr bool has_edge(EdgeMask mask, int edge) { return (mask >> edge & 1) != 0; }

inline constexpr std::array<LatticeStep, kLatticeEdges> kLatticeSteps = {{{0, -1, -1},
                                                                          {-1, 0, -1},
                                                                          {1, 0, -1},
                                                                          {0, 1, -1},
                                                                          {-1, -1, 0},
                                                                          {1, -1, 0},
                                                                          {-2, 0, 0},
                                                                          {2, 0, 0},
                                                                          {-1, 1, 0},
                                                                          {1, 1, 0},
                                                                          {0, -1, 1},
                                                                          {-1, 0, 1},
                                                                          {1, 0, 1},
                                                                          {0, 1, 1}}};

/// The edge along a step, or -1 where the lattice has none.
constexpr int edge_along(const LatticeStep& step) {
  for (int e = 0; e < kLatticeEdges; ++e) {
    if (kLatticeSteps[static_cast<std::size_t>(e)] == step) return e;
  }
  return -1;
}

/// The edges whose ends are joined by an edge to the end of edge e: table C.1. Four around a long edge, six around a
/// short one. Together they make the link of a sample, a sphere of 14 vertices, 36 edges and 24 triangles.
inline constexpr std::array<EdgeMask, kLatticeEdges> kNextEdges = [] {
  std::array<EdgeMask, kLatticeEdges> next{};
  for (int a = 0; a < kLatticeEdges; ++a) {
    for (int b = 0; b < kLatticeEdges; ++b) {
      const LatticeStep between =
          kLatticeSteps[static_cast<std::size_t>(b)] - kLatticeSteps[static_cast<std::size_t>(a)];
      if (edge_along(between) >= 0) next[static_cast<std::size_t>(a)] |= edge_bit(b);
    }
  }
  return next;
}();

/// Six times the signed volume, in steps, of the tetrahedron from a sample along three edges; 0 where these are none.
constexpr int orientation(int a, int b, int c) {
  if (!has_edge(kNextEdges[static_cast<std::size_t>(a)], b) || !has_edge(kNextEdges[static_cast<std::size_t>(b)], c) ||
      !has_edge(kNextEdges[static_cast<std::size_t>(c)], a)) {
    return 0;
  }
  const LatticeStep p = kLatticeSteps[static_cast<std::size_t>(a)];
  const LatticeStep q = kLatticeSteps[static_cast<std::size_t>(b)];
  const LatticeStep r = kLatticeSteps[static_cast<std::size_t>(c)];
  return p.m * (q.j * r.k - q.k * r.j) - p.j * (q.m * r.k - q.k * r.m) + p.k * (q.m * r.j - q.j * r.m);
}

/// kLeftOf[a][b] is the edge c such that a, b, c is a triangle of the link, counter-clockwise seen from outside; -1
/// where a and b are not next to each other.
inline constexpr std::array<std::array<std::int8_t, kLatticeEdges>, kLatticeEdges> kLeftOf = [] {
  std::array<std::array<std::int8_t, kLatticeEdges>, kLatticeEdges> left{};
  for (int a = 0; a < kLatticeEdges; ++a) {
    for (int b = 0; b < kLatticeEdges; ++b) {
      left[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] = -1;
      for (int c = 0; c < kLatticeEdges; ++c) {
        if (orientation(a, b, c) > 0)
          left[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] = static_cast<std::int8_t>(c);
      }
    }
  }
  return left;
}();

/// The six tetrahedra that a sample owns, those whose other corners all come later: three forward edges each, so
/// ordered that the tetrahedron is positive.
inline constexpr std::array<std::array<std::int8_t, 3>, 6> kOwnTetrahedra = [] {
  std::array<std::array<std::int8_t, 3>, 6> own{};
  std::size_t count = 0;
  for (int a = kFirstForwardEdge; a < kLatticeEdges; ++a) {
    for (int b = a + 1; b < kLatticeEdges; ++b) {
      for (int c = a + 1; c < kLatticeEdges; ++c) {
        // Each triple is met in both orders of b and c, once positive.
        if (orientation(a, b, c) > 0) {
          own[count++] = {static_cast<std::int8_t>(a), static_cast<std::int8_t>(b), static_cast<std::int8_t>(c)};
        }
      }
    }
  }
  return own;
}();

}  // namespace fathom
