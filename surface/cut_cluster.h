#pragma once

#include <cstdint>

#include "surface/cut_layer.h"
#include "surface/star.h"
#include "surface/wall.h"

namespace fathom {

/// Whether the cut of the edge between samples with these values lies nearer to the first; a tie goes to the one that
/// comes first in the order of the lattice.
inline bool nearer_to_first(float first, float second, bool first_comes_first) {
  const float a = first < 0.0F ? -first : first;
  const float b = second < 0.0F ? -second : second;
  return a < b || (a == b && first_comes_first);
}

/// The near cuts that are connected with the first one; `near` is not empty.
EdgeMask first_cluster(EdgeMask near, Link link);

/// The vertex, among those of its layer, of the cut of `edge` that is near to the sample.
std::int32_t vertex_of(const CutSample& sample, int edge);

/// Whether the near cuts `cluster` around a sample may become one vertex without a change of topology.
///
/// On the surface of marching tetrahedra a cluster stands for the patch of cells around its cuts. One vertex can take
/// its place when (a) the patch is a disc, and around it, on the ring of cuts that are its neighbours, (b) no cut is
/// met twice and (c) no other cluster is met twice, and at least three are. Because (b) holds for neighbours that stay
/// single cuts and (c) for those that become vertices, it does not matter which of them do: the test depends on the
/// sample's star only, and a mesh of which every cluster passes is a manifold like that of marching tetrahedra.
/// It covers cases (a) to (c) of Treece 2000, figure 3.25, and what these leave open in noisy fields.
bool collapsible(EdgeMask cluster, EdgeMask cut, const Star& star, Link link);

/// Whether the vertex of a cluster, held on a wall, would make a triangle with two others that are held there although
/// it lies on the inner side of the wall: it could have no area.
bool has_chord(EdgeMask cluster, EdgeMask cut, const Star& star, Link link, const Wall& wall);

}  // namespace fathom
