#include "measurement/section_raster.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Geometry>

#include "core/error.h"

namespace fathom {

namespace {

constexpr double kFarthestMm = 1e4;  // no scan is 10 m wide; keeps cell numbers
                                     // far from the limits of an int

std::string in_mm(double value_mm) {
  std::string text = std::to_string(value_mm);
  return text.substr(0, text.find('.') + 4) + " mm";
}

Eigen::AlignedBox2d bounds(std::span<const Polygon> outlines) {
  if (outlines.empty())
    throw Error(
        "a cross-section has no outline; draw one, or mark the frame "
        "as absent");
  Eigen::AlignedBox2d box;
  for (const Polygon& outline : outlines) {
    if (outline.size() < 3) throw Error("an outline has fewer than three points; draw it again");
    for (const Eigen::Vector2d& point : outline) {
      if (!point.allFinite() || point.cwiseAbs().maxCoeff() > kFarthestMm) {
        throw Error(
            "an outline has a point that is not finite or farther than "
            "10 m away; check the calibration");
      }
      box.extend(point);
    }
  }
  return box;
}

}  // namespace

SectionRaster section_raster(std::span<const Polygon> outlines_mm, double cell_mm, int margin) {
  if (!std::isfinite(cell_mm) || cell_mm <= 0.0) throw Error("the cells of a cross-section must be larger than 0 mm");
  margin = std::max(margin, 2);  // the rim must be outside, and bilinear
                                 // interpolation needs one point more
  const Eigen::AlignedBox2d box = bounds(outlines_mm);
  const int room = kMostRasterPoints - 2 * margin - 2;
  const double longest = box.sizes().maxCoeff();
  if (room < 1 || longest / cell_mm > room) {
    throw Error("a cross-section of " + in_mm(longest) + " is too large for cells of " + in_mm(cell_mm) + "; use " +
                in_mm(longest / std::max(room, 1) + 1e-3) + " or more");
  }
  SectionRaster raster;
  raster.cell_mm = cell_mm;
  const Eigen::Array2d first = (box.min() / cell_mm).array().floor() - margin;
  const Eigen::Array2d last = (box.max() / cell_mm).array().ceil() + margin;
  raster.origin_mm = first.matrix() * cell_mm;
  raster.columns = static_cast<int>(last.x() - first.x()) + 1;
  raster.rows = static_cast<int>(last.y() - first.y()) + 1;
  return raster;
}

std::vector<std::uint8_t> inside_outlines(std::span<const Polygon> outlines, const SectionRaster& raster) {
  // Every crossing of an outline with a row flips all that lies to the right of it.
  std::vector<std::uint8_t> inside(raster.size(), 0);
  for (const Polygon& outline : outlines) {
    Eigen::Vector2d from = outline.back();
    for (const Eigen::Vector2d& to : outline) {
      const Eigen::Vector2d& low = from.y() < to.y() ? from : to;
      const Eigen::Vector2d& high = from.y() < to.y() ? to : from;
      // A point at a row belongs to what lies above it, so that corners are counted once.
      const int first = std::max(0, static_cast<int>(std::ceil(low.y())));
      const int end = std::min(raster.rows, static_cast<int>(std::ceil(high.y())));
      const double slope = first < end ? (high.x() - low.x()) / (high.y() - low.y()) : 0.0;
      for (int j = first; j < end; ++j) {
        const double x = low.x() + slope * (j - low.y());
        const int i = std::max(0, static_cast<int>(std::ceil(x)));
        if (i < raster.columns) inside[raster.index(i, j)] ^= 1U;
      }
      from = to;
    }
  }
  for (int j = 0; j < raster.rows; ++j) {
    std::uint8_t flips = 0;
    std::uint8_t* row = &inside[raster.index(0, j)];
    for (int i = 0; i < raster.columns; ++i) row[i] = flips ^= row[i];
  }
  return inside;
}

}  // namespace fathom
