#include "surface/lattice_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

namespace {

constexpr double kMostSamples = 4e9;  // some minutes, of a function that is quick
constexpr double kBytesPerGigabyte = 1024.0 * 1024.0 * 1024.0;
constexpr double kMostBytes = 4.0 * kBytesPerGigabyte;
// A window of layers, of floats, and what the meshers note about them.
constexpr double kBytesPerLayerSample = 100.0;
// One vertex with its normal and two triangles, once in layers and once joined.
constexpr double kBytesPerSurfaceSample = 2.0 * (48.0 + 24.0);
// A box that is so nearly a whole number of steps long has that number.
constexpr double kAlmostWhole = 1e-6;

double steps_along(double length_mm, double step_mm) {
  return std::max(1.0, std::ceil(length_mm / step_mm - kAlmostWhole));
}

// Numbers of samples, which may be more than an int holds.
struct Counts {
  double columns;
  double rows;
  double layers;

  double samples() const { return columns * rows * layers; }
  // The surface is taken to be as large as that of the box.
  double bytes() const {
    return columns * rows * kBytesPerLayerSample +
           2.0 * (columns * rows + rows * layers + columns * layers) * kBytesPerSurfaceSample;
  }
  bool fit() const { return samples() <= kMostSamples && bytes() <= kMostBytes; }
};

Counts counts_for(const Eigen::Vector3d& extent_mm, double spacing_mm, Lattice lattice) {
  Counts counts{};
  counts.rows = steps_along(extent_mm.y(), spacing_mm) + 1.0;
  counts.layers = steps_along(extent_mm.z(), spacing_mm) + 1.0;
  if (lattice == Lattice::kCubic) {
    counts.columns = steps_along(extent_mm.x(), spacing_mm) + 1.0;
  } else {
    const double half_steps = steps_along(extent_mm.x(), spacing_mm / std::numbers::sqrt2);
    counts.columns = std::max(3.0, std::ceil((half_steps + 3.0) / 2.0));
  }
  return counts;
}

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

// Rounded up to two digits.
double rounded_up(double value) {
  const double digit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / digit) * digit;
}

}  // namespace

LatticeLayout lattice_layout(const Eigen::Vector3d& extent_mm, double spacing_mm, Lattice lattice) {
  if (spacing_mm > extent_mm.minCoeff() * (1.0 + kAlmostWhole)) {
    throw Error("a spacing of " + format_real(spacing_mm) + " mm is wider than the box, which is " +
                short_number(extent_mm.minCoeff()) + " mm at its narrowest; use a smaller spacing");
  }
  const Counts counts = counts_for(extent_mm, spacing_mm, lattice);
  if (!counts.fit()) {
    double fitting_mm = spacing_mm;
    while (!counts_for(extent_mm, fitting_mm, lattice).fit()) fitting_mm *= 1.05;
    fitting_mm = rounded_up(fitting_mm);
    if (fitting_mm > extent_mm.minCoeff()) {
      throw Error("a spacing of " + format_real(spacing_mm) + " mm takes " + short_number(counts.samples()) +
                  " samples and " + short_number(counts.bytes() / kBytesPerGigabyte) +
                  " GB, and the box is too narrow for a wider one; use a box of more even sides");
    }
    throw Error("a spacing of " + format_real(spacing_mm) + " mm takes " + short_number(counts.samples()) +
                " samples and " + short_number(counts.bytes() / kBytesPerGigabyte) + " GB; use " +
                short_number(fitting_mm) + " mm or more");
  }
  LatticeLayout layout;
  layout.columns = static_cast<int>(counts.columns);
  layout.rows = static_cast<int>(counts.rows);
  layout.layers = static_cast<int>(counts.layers);
  const double column_steps = lattice == Lattice::kCubic ? counts.columns - 1.0 : counts.columns - 1.5;
  layout.step_mm = extent_mm.cwiseQuotient(Eigen::Vector3d(column_steps, counts.rows - 1.0, counts.layers - 1.0));
  return layout;
}

}  // namespace fathom
