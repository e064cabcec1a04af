#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "registration/convex_parts.h"
#include "surface/mesh_clip.h"

namespace fathom {

/// What of a structure lies in a part of space: closed by caps, whose `plane_of` are planes of the partition.
struct FilledPart {
  ConvexPart space;
  ClippedMesh closed;  ///< empty where there is nothing
};

/// How well the parts on both sides of a dividing plane meet.
struct PlaneMatch {
  std::size_t plane = 0;
  double above_mm2 = 0.0;     ///< of the caps of the parts to which the plane's normal points
  double below_mm2 = 0.0;     ///< of those on the other side; the same where both sweeps saw the same
  double mismatch_mm2 = 0.0;  ///< inside on one side only

  /// Of the larger side.
  double mismatch_share() const;
};

/// For the planes that cut the structure, ascending. Where sweeps pass backward, areas count negative.
std::vector<PlaneMatch> match_planes(std::span<const FilledPart> parts, const SpacePartition& partition);

/// Whether a part lies on the side of one of its planes to which the plane's normal points.
bool is_above(const ConvexPart& part, std::size_t plane, const SpacePartition& partition);

}  // namespace fathom
