#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "measurement/outline_distance.h"
#include "measurement/section_raster.h"

namespace fathom {

/// A maximal disc of a section: it touches the outline at two or more points. Treece 2000, section 3.2.3.
struct Disc {
  Eigen::Vector2d centre_mm = Eigen::Vector2d::Zero();
  double radius = 0.0;  ///< in chamfer units, 10 a cell: the code at the centre, negative for a disc outside
};

/// The maximal discs of one side of an outline, from the largest down, without those that protrude from a larger one by
/// less than half their radius: the ones inside when `side` is 1, outside when it is 0. `codes` are without sign,
/// `nearest` are the outline's points nearest to those of the raster. Those outside are looked for on the raster only.
/// Treece 2000, equation (3.3); besides, a disc must touch the outline at places that are at least its radius apart and
/// in different directions, for the steps of a raster make codes like those of discs all along a smooth outline.
std::vector<Disc> maximal_discs(const std::vector<std::int16_t>& codes, const std::vector<std::uint8_t>& inside,
                                std::uint8_t side, const SectionRaster& raster, const NearestPoints& nearest);

}  // namespace fathom
