#include "measurement/maximal_discs.h"

#include <algorithm>

#include "measurement/chamfer.h"

namespace fathom {

namespace {

struct Candidate {
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

std::vector<Candidate> candidates(const std::vector<std::int16_t>& codes, const std::vector<std::uint8_t>& inside,
                                  std::uint8_t side, const SectionRaster& raster) {
  std::vector<Candidate> found;
  for (int j = 1; j + 1 < raster.rows; ++j) {
    for (int i = 1; i + 1 < raster.columns; ++i) {
      const std::size_t at = raster.index(i, j);
      if (inside[at] != side || !is_maximal(&codes[at], raster.columns)) continue;
      found.push_back({codes[at], static_cast<std::int16_t>(i), static_cast<std::int16_t>(j)});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) { return a.code > b.code; });
  return found;
}

bool is_covered(const Candidate& disc, const std::vector<Candidate>& kept) {
  return std::any_of(kept.begin(), kept.end(), [&](const Candidate& other) {
    const float apart = chamfer_length(static_cast<float>(disc.i - other.i), static_cast<float>(disc.j - other.j));
    return apart + 0.5F * disc.code < other.code;
  });
}

}  // namespace

std::vector<Disc> maximal_discs(const std::vector<std::int16_t>& codes, const std::vector<std::uint8_t>& inside,
                                std::uint8_t side, const SectionRaster& raster) {
  std::vector<Candidate> kept;
  for (const Candidate& disc : candidates(codes, inside, side, raster)) {
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
