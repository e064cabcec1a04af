#include "surface/lattice_border.h"

#include <algorithm>
#include <cstddef>

namespace fathom {

namespace {

// Lower than any field.
constexpr float kFarOutside = -1e30F;

// What is left of a sample on a flat side: little enough that all cuts around it lie on the face.
constexpr float kFaceShare = 1e-3F;

// Rows that are not shifted begin on the face, shifted ones end on it.
bool on_face(const BorderedLayer& layer, int row, std::size_t side) {
  const bool shifted = ((row + layer.parity) & 1) != 0;
  return shifted == (side == 1);
}

std::size_t place(const BorderedLayer& layer, int row, int column) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(layer.samples.columns) +
         static_cast<std::size_t>(column);
}

// The column `steps` into the box from the added one.
int column_at(const BorderedLayer& layer, std::size_t side, int steps) {
  return side == 0 ? steps : layer.samples.columns - 1 - steps;
}

bool inside(const BorderedLayer& layer, int row, std::size_t side, int steps) {
  return layer.samples.values[place(layer, row, column_at(layer, side, steps))] >= 0.0F;
}

}  // namespace

void add_border(BorderedLayer& layer) {
  SampledLayer& samples = layer.samples;
  std::fill_n(samples.values.begin(), samples.columns, kFarOutside);
  std::fill_n(samples.values.end() - samples.columns, samples.columns, kFarOutside);
  for (int j = 1; j + 1 < samples.rows; ++j) {
    samples.values[place(layer, j, 0)] = kFarOutside;
    samples.values[place(layer, j, samples.columns - 1)] = kFarOutside;
  }
}

void find_flat_sides(BorderedLayer& layer, const BorderedLayer* below, const BorderedLayer* above) {
  const int rows = layer.samples.rows;
  layer.flat.assign(static_cast<std::size_t>(rows), {0, 0});
  if (layer.samples.columns < 4) return;  // the faces' samples are each other's neighbours
  for (int j = 1; j + 1 < rows; ++j) {
    for (std::size_t side = 0; side < 2; ++side) {
      if (!on_face(layer, j, side) || !inside(layer, j, side, 2)) continue;
      bool all = true;
      for (const BorderedLayer* other : {below, static_cast<const BorderedLayer*>(&layer), above}) {
        if (!other) continue;
        for (int row = std::max(j - 1, 1); row <= std::min(j + 1, rows - 2); ++row) {
          all = all && inside(*other, row, side, 1);
        }
      }
      layer.flat[static_cast<std::size_t>(j)][side] = all ? 1 : 0;
    }
  }
}

void flatten_sides(BorderedLayer& layer, const BorderedLayer* below, const BorderedLayer* above) {
  const int rows = layer.samples.rows;
  const auto allows = [rows](const BorderedLayer* other, int row, std::size_t side) {
    if (!other || row < 1 || row > rows - 2) return true;
    return other->flat[static_cast<std::size_t>(row)][side] != 0 || !inside(*other, row, side, 1);
  };
  for (int j = 1; j + 1 < rows; ++j) {
    for (std::size_t side = 0; side < 2; ++side) {
      float& last = layer.samples.values[place(layer, j, column_at(layer, side, 1))];
      if (on_face(layer, j, side)) {
        if (layer.flat[static_cast<std::size_t>(j)][side] != 0) last *= kFaceShare;
      } else if (last >= 0.0F && allows(&layer, j - 1, side) && allows(&layer, j + 1, side) && allows(below, j, side) &&
                 allows(above, j, side)) {
        // A sample at the value itself still needs one outside next to it.
        layer.samples.values[place(layer, j, column_at(layer, side, 0))] = -std::max(last, 1e-30F);
      }
    }
  }
}

}  // namespace fathom
