#include "measurement/maximal_discs.h"

#include <algorithm>

#include "measurement/chamfer.h"

namespace fathom {

namespace {

struct Candidate {
  float distance;  // cells; among equal codes the middle of a plateau comes first
  std::int16_t code;
  std::int16_t i;
  std::int16_t j;
};

// Whether the disc at p is not inside that of a neighbour. Neighbours across
// the outline, whose codes are as small as those beside it, never stand in the
// way.
bool is_maximal(const std::int16_t* p, int columns) {
  const int straight = std::max({p[-1], p[1], p[-columns], p[columns]});
  const int diagonal = std::max({p[-columns - 1], p[-columns + 1], p[columns - 1], p[columns + 1]});
  return *p > straight - kChamferStep && *p > diagonal - kChamferDiagonal;
}

// Cells. Along a straight outline the nearest points of two points two cells apart are as far apart.
constexpr float kSmoothOutline = 2.5F;

// Whether the outline's points nearest to either side of the raster's point are as far apart as those of a disc that
// touches it at two places.
bool touches_twice(const NearestPoints& nearest, std::size_t at, std::size_t columns) {
  const auto apart_squared = [&nearest](std::size_t a, std::size_t b) {
    const float x = nearest.x[a] - nearest.x[b];
    const float y = nearest.y[a] - nearest.y[b];
    return x * x + y * y;
  };
  const float least = std::max(kSmoothOutline, nearest.distance[at]);
  return std::max(apart_squared(at - 1, at + 1), apart_squared(at - columns, at + columns)) > least * least;
}

std::vector<Candidate> candidates(const std::vector<std::int16_t>& codes, const std::vector<std::uint8_t>& inside,
                                  std::uint8_t side, const SectionRaster& raster, const NearestPoints& nearest) {
  std::vector<Candidate> found;
  for (int j = 1; j + 1 < raster.rows; ++j) {
    for (int i = 1; i + 1 < raster.columns; ++i) {
      const std::size_t at = raster.index(i, j);
      if (inside[at] != side || !is_maximal(&codes[at], raster.columns)) continue;
      if (!touches_twice(nearest, at, static_cast<std::size_t>(raster.columns))) continue;
      found.push_back({nearest.distance[at], codes[at], static_cast<std::int16_t>(i), static_cast<std::int16_t>(j)});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance > b.distance; });
  return found;
}

// Half a disc's radius is what a disc must protrude from a larger one. Discs are round here, not the octagons of the
// chamfer code, and the raster's steps, a cell high, do not count: both would give any smooth outline a fringe of tiny
// discs that say nothing of its shape.
bool is_covered(const Candidate& disc, const std::vector<Candidate>& kept) {
  return std::any_of(kept.begin(), kept.end(), [&](const Candidate& other) {
    const float reach = static_cast<float>(other.code + kChamferStep) - 0.5F * disc.code;
    const float i = static_cast<float>(kChamferStep * (disc.i - other.i));
    const float j = static_cast<float>(kChamferStep * (disc.j - other.j));
    return reach > 0.0F && i * i + j * j < reach * reach;
  });
}

}  // namespace

std::vector<Disc> maximal_discs(const std::vector<std::int16_t>& codes, const std::vector<std::uint8_t>& inside,
                                std::uint8_t side, const SectionRaster& raster, const NearestPoints& nearest) {
  std::vector<Candidate> kept;
  for (const Candidate& disc : candidates(codes, inside, side, raster, nearest)) {
    if (!is_covered(disc, kept)) kept.push_back(disc);
  }
  std::vector<Disc> discs;
  discs.reserve(kept.size());
  for (const Candidate& disc : kept) {
    discs.push_back({raster.origin_mm + raster.cell_mm * Eigen::Vector2d(disc.i, disc.j),
                     side == 1 ? static_cast<double>(disc.code) : -static_cast<double>(disc.code)});
  }
  return discs;
}

}  // namespace fathom
