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

// Whether the disc at p is not inside that of a neighbour. Neighbours across the outline, whose codes are as small as
// those beside it, never stand in the way.
bool is_maximal(const std::int16_t* p, int columns) {
  const int straight = std::max({p[-1], p[1], p[-columns], p[columns]});
  const int diagonal = std::max({p[-columns - 1], p[-columns + 1], p[columns - 1], p[columns + 1]});
  return *p > straight - kChamferStep && *p > diagonal - kChamferDiagonal;
}

// Cells. Along a straight outline the nearest points of two points two cells apart are as far apart.
constexpr float kSmoothOutline = 2.5F;

// Of the angle between the ways to both places. Where an outline is bent the nearest points of points inside are
// farther apart than along a straight one, so that their distance alone takes a bend for two places.
constexpr float kMostCosine = 0.7F;

struct Way {
  float x, y;
};

// Whether the outline's points nearest to two neighbours of a raster's point are as far apart as those of a disc that
// touches it at two places, `least` cells, and lie in different directions.
bool are_two_places(const NearestPoints& nearest, std::size_t a, Way to_a, std::size_t b, Way to_b, float least) {
  const float x = nearest.x[a] - nearest.x[b];
  const float y = nearest.y[a] - nearest.y[b];
  if (x * x + y * y <= least * least) return false;
  const float dot = to_a.x * to_b.x + to_a.y * to_b.y;
  return dot <= 0.0F || dot <= kMostCosine * nearest.distance[a] * nearest.distance[b];
}

bool touches_twice(const NearestPoints& nearest, const SectionRaster& raster, int i, int j) {
  const auto way_from = [&](int column, int row) {
    const std::size_t at = raster.index(column, row);
    return Way{nearest.x[at] - static_cast<float>(column), nearest.y[at] - static_cast<float>(row)};
  };
  const float least = std::max(kSmoothOutline, nearest.distance[raster.index(i, j)]);
  return are_two_places(nearest, raster.index(i - 1, j), way_from(i - 1, j), raster.index(i + 1, j), way_from(i + 1, j),
                        least) ||
         are_two_places(nearest, raster.index(i, j - 1), way_from(i, j - 1), raster.index(i, j + 1), way_from(i, j + 1),
                        least);
}

std::vector<Candidate> candidates(const std::vector<std::int16_t>& codes, const std::vector<std::uint8_t>& inside,
                                  std::uint8_t side, const SectionRaster& raster, const NearestPoints& nearest) {
  std::vector<Candidate> found;
  for (int j = 1; j + 1 < raster.rows; ++j) {
    for (int i = 1; i + 1 < raster.columns; ++i) {
      const std::size_t at = raster.index(i, j);
      if (inside[at] != side || !is_maximal(&codes[at], raster.columns)) continue;
      if (!touches_twice(nearest, raster, i, j)) continue;
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
