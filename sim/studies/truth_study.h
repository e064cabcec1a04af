#pragma once

#include "sim/solid.h"
#include "sim/studies/study.h"

namespace fathom {

/// The volume of a solid by counting: `cells` cells along its longest extent, one point at a random place in each, and
/// the share of points that lie inside. It uses nothing of the solid but on which side of the surface a point lies.
/// Cubic millimetres; its standard deviation is about 0.01 % of a compact solid's volume with 128 cells.
double counted_volume_mm3(const Solid& solid, int cells, std::uint64_t seed);

/// Study "truth": the true volumes of all objects, by their formulas and by counting.
const Study& truth_study();

}  // namespace fathom
