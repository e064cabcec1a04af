#include "measurement/gap_bulges.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

// Where a point lies among the nodes, and the node at or before it.
struct Cell {
  Eigen::Vector2d at;
  int i;
  int j;
  bool on_grid;
};

Cell cell_of(const GapBulges& bulges, const Eigen::Vector2d& ab_mm) {
  Cell cell;
  cell.at = ab_mm / bulges.pitch_mm - Eigen::Vector2d(bulges.first_column, bulges.first_row);
  const double i = std::floor(cell.at.x());
  const double j = std::floor(cell.at.y());
  cell.on_grid = i >= 0.0 && j >= 0.0 && i <= bulges.columns - 2 && j <= bulges.rows - 2;
  cell.i = cell.on_grid ? static_cast<int>(i) : 0;
  cell.j = cell.on_grid ? static_cast<int>(j) : 0;
  return cell;
}

}  // namespace

float GapBulges::at_mm(const Eigen::Vector2d& ab_mm) const {
  const Cell cell = cell_of(*this, ab_mm);
  if (!cell.on_grid) return 0.0F;
  const auto x = static_cast<float>(cell.at.x() - cell.i);
  const auto y = static_cast<float>(cell.at.y() - cell.j);
  const float* low = &values_mm[index(cell.i, cell.j)];
  const float* high = low + columns;
  const float from = low[0] + x * (low[1] - low[0]);
  const float to = high[0] + x * (high[1] - high[0]);
  return from + y * (to - from);
}

float GapBulges::most_near_mm(const Eigen::Vector2d& ab_mm) const {
  const Cell cell = cell_of(*this, ab_mm);
  return cell.on_grid ? most_mm[index(cell.i, cell.j)] : 0.0F;
}

void GapBulges::find_most() {
  constexpr int kReach = 2;  // a point of the cell reaches as far as the node after the next one
  const auto spread = [&](const std::vector<float>& from, int along_i, int along_j) {
    std::vector<float> most(from.size());
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        float largest = 0.0F;
        for (int k = -kReach; k <= kReach; ++k) {
          const int ni = i + k * along_i;
          const int nj = j + k * along_j;
          if (ni < 0 || nj < 0 || ni >= columns || nj >= rows) continue;
          largest = std::max(largest, std::abs(from[index(ni, nj)]));
        }
        most[index(i, j)] = largest;
      }
    }
    return most;
  };
  most_mm = spread(spread(values_mm, 1, 0), 0, 1);
  largest_mm = *std::max_element(most_mm.begin(), most_mm.end());
}

}  // namespace fathom
