#include "measurement/contour_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"

namespace fathom {

namespace {

// Rows and columns are rounded up to multiples of this.
constexpr int kGrain = 8;
// Far more than memory could hold; what is larger would overflow the indices.
constexpr double kMaxSteps = 1e6;
// Where the structure is absent, millimetres; any negative number does, as no cut depends on it.
constexpr float kOutside = -1.0F;

int grain_below(double steps) { return static_cast<int>(std::floor(steps / kGrain)) * kGrain; }
int grain_above(double steps) { return static_cast<int>(std::ceil(steps / kGrain)) * kGrain; }

ColumnGrid grid_of(const ContourLattice& lattice, int parity) {
  ColumnGrid grid;
  grid.start_mm = lattice.at_mm(0, 0);
  grid.column_step_mm = {lattice.column_step_mm(), 0.0};
  grid.row_step_mm = {0.0, lattice.row_step_mm()};
  grid.columns = lattice.columns;
  grid.rows = lattice.rows;
  grid.lattice = lattice.lattice;
  grid.parity = lattice.lattice == Lattice::kCubic ? 0 : parity;
  return grid;
}

// The layer at the fraction `u` of the way from plane to plane.
SampledLayer empty_layer(const ContourLattice& lattice, const SectionPlane& first, const SectionPlane& second,
                         double u) {
  const Eigen::Vector2d origin_mm = lattice.at_mm(0, 0);
  SampledLayer layer;
  layer.columns = lattice.columns;
  layer.rows = lattice.rows;
  layer.values.resize(static_cast<std::size_t>(lattice.samples_per_layer()));
  layer.origin = (1.0 - u) * first.at(origin_mm) + u * second.at(origin_mm);
  layer.column_step = lattice.column_step_mm() * ((1.0 - u) * first.a_axis + u * second.a_axis);
  layer.row_step = lattice.row_step_mm() * ((1.0 - u) * first.b_axis + u * second.b_axis);
  return layer;
}

}  // namespace

double ContourLattice::column_step_mm() const {
  return lattice == Lattice::kCubic ? spacing_mm : std::numbers::sqrt2 * spacing_mm;
}

Eigen::Vector2d ContourLattice::at_mm(int i, int j) const {
  return {(first_column + i) * column_step_mm(), (first_row + j) * row_step_mm()};
}

ContourLattice contour_lattice(Lattice lattice, double spacing_mm, const Eigen::Vector2d& low_mm,
                               const Eigen::Vector2d& high_mm, double margin) {
  ContourLattice result;
  result.lattice = lattice;
  result.spacing_mm = spacing_mm;
  const double column_step = result.column_step_mm();
  const double row_step = result.row_step_mm();
  const double margin_mm = margin * spacing_mm;
  const double left = (low_mm.x() - margin_mm) / column_step;
  const double right = (high_mm.x() + margin_mm) / column_step;
  const double top = (low_mm.y() - margin_mm) / row_step;
  const double bottom = (high_mm.y() + margin_mm) / row_step;
  if (std::max({std::abs(left), std::abs(right), std::abs(top), std::abs(bottom)}) > kMaxSteps) {
    throw Error("a surface spacing of " + std::to_string(spacing_mm) +
                " mm is too fine for contours of this size; choose a larger one");
  }
  result.first_column = grain_below(left);
  result.first_row = grain_below(top);
  result.columns = grain_above(right) - result.first_column + 1;
  result.rows = grain_above(bottom) - result.first_row + 1;
  return result;
}

SampledLayer section_layer(const ContourLattice& lattice, const PlacedSection& section) {
  SampledLayer layer = empty_layer(lattice, section.plane, section.plane, 0.0);
  if (section.shape->kind() == SectionKind::kAbsent) {
    std::fill(layer.values.begin(), layer.values.end(), kOutside);
  } else {
    section.shape->sample(grid_of(lattice, 0), layer.values);
  }
  return layer;
}

int layers_between(double distance_mm, double spacing_mm) {
  return 2 * std::max(1, static_cast<int>(std::lround(0.5 * distance_mm / spacing_mm)));
}

std::vector<std::shared_ptr<const SampledLayer>> gap_layers(const ContourLattice& lattice, const SectionGap& gap,
                                                            int count, const CurvedGap* curved) {
  std::optional<GapBulges> bulges;
  if (curved) bulges = curved->bulges(grid_of(lattice, 0));
  // What depends on the column alone serves all layers of a parity.
  std::array<std::optional<GapColumns>, 2> columns;
  std::vector<std::shared_ptr<const SampledLayer>> layers;
  for (int k = 1; k < count; ++k) {
    const ColumnGrid grid = grid_of(lattice, k % 2);
    auto& prepared = columns[static_cast<std::size_t>(grid.parity)];
    if (!prepared) prepared = gap.prepare(grid, 1.0 / count, bulges ? &*bulges : nullptr);
    const double u = static_cast<double>(k) / count;
    auto layer = std::make_shared<SampledLayer>(empty_layer(lattice, gap.first().plane, gap.second().plane, u));
    gap.sample(*prepared, u, layer->values);
    layers.push_back(std::move(layer));
  }
  return layers;
}

bool touches_border(const SampledLayer& layer) {
  const auto columns = static_cast<std::size_t>(layer.columns);
  const auto rows = static_cast<std::size_t>(layer.rows);
  const auto inside = [&layer](std::size_t sample) { return layer.values[sample] >= 0.0F; };
  for (std::size_t i = 0; i < columns; ++i) {
    if (inside(i) || inside((rows - 1) * columns + i)) return true;
  }
  for (std::size_t j = 0; j < rows; ++j) {
    if (inside(j * columns) || inside(j * columns + columns - 1)) return true;
  }
  return false;
}

}  // namespace fathom
