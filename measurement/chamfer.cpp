#include "measurement/chamfer.h"

namespace fathom {

namespace {

constexpr std::int16_t kUnknown = 32767 - kChamferDiagonal;  // one more step must not overflow

std::int16_t plus(std::int16_t code, int step) { return static_cast<std::int16_t>(code + step); }

// Paths that come from the row `from`. The ends of the row have no diagonal neighbour on one side.
void spread_from_row(const std::int16_t* __restrict from, std::int16_t* __restrict to, int columns) {
  for (int i = 1; i + 1 < columns; ++i) {
    const std::int16_t diagonal = plus(std::min(from[i - 1], from[i + 1]), kChamferDiagonal);
    to[i] = std::min(to[i], std::min(plus(from[i], kChamferStep), diagonal));
  }
  const int last = columns - 1;
  for (const int i : {0, last}) {
    to[i] = std::min(to[i], plus(from[i], kChamferStep));
    if (i > 0) to[i] = std::min(to[i], plus(from[i - 1], kChamferDiagonal));
    if (i < last) to[i] = std::min(to[i], plus(from[i + 1], kChamferDiagonal));
  }
}

}  // namespace

std::vector<std::int16_t> chamfer_codes(const std::vector<std::uint8_t>& inside, const SectionRaster& raster) {
  std::vector<std::int16_t> codes(raster.size(), kUnknown);
  const int columns = raster.columns;
  for (int j = 0; j < raster.rows; ++j) {
    const std::uint8_t* here = &inside[raster.index(0, j)];
    std::int16_t* row = &codes[raster.index(0, j)];
    for (int i = 1; i < columns; ++i) {
      if (here[i] != here[i - 1]) row[i] = row[i - 1] = kChamferBorder;
    }
    if (j == 0) continue;
    const std::uint8_t* above = here - columns;
    std::int16_t* row_above = row - columns;
    for (int i = 0; i < columns; ++i) {
      if (here[i] != above[i]) row[i] = row_above[i] = kChamferBorder;
    }
  }
  // Points beside each other on both sides of the outline both hold the least code there is, so that no path gains by
  // crossing it and the signs can be left out.
  for (int j = 0; j < raster.rows; ++j) {
    std::int16_t* row = &codes[raster.index(0, j)];
    if (j > 0) spread_from_row(row - columns, row, columns);
    for (int i = 1; i < columns; ++i) row[i] = std::min(row[i], plus(row[i - 1], kChamferStep));
  }
  for (int j = raster.rows - 1; j >= 0; --j) {
    std::int16_t* row = &codes[raster.index(0, j)];
    if (j + 1 < raster.rows) spread_from_row(row + columns, row, columns);
    for (int i = columns - 2; i >= 0; --i) row[i] = std::min(row[i], plus(row[i + 1], kChamferStep));
  }
  return codes;
}

}  // namespace fathom
