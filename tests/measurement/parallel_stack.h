#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

#include "measurement/section_gap.h"

// Objects cut by parallel planes and put together again from their sections, voxel by voxel.
namespace fathom::stacks {

/// The outlines of an object at height z; none where it is not.
using Outlines = std::function<std::vector<Polygon>(double z)>;

inline Polygon ellipse(double a, double b, double radius_a, double radius_b, int points = 160) {
  Polygon polygon;
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points;
    polygon.emplace_back(a + radius_a * std::cos(angle), b + radius_b * std::sin(angle));
  }
  return polygon;
}

/// Where the line at height b crosses outlines, ascending: inside is between the first and second, third and fourth,
/// ...
inline std::vector<double> crossings(const std::vector<Polygon>& outlines, double b) {
  std::vector<double> found;
  for (const Polygon& outline : outlines) {
    for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
      const Eigen::Vector2d& p = outline[i];
      const Eigen::Vector2d& q = outline[j];
      if ((p.y() > b) != (q.y() > b)) found.push_back((q.x() - p.x()) * (b - p.y()) / (q.y() - p.y()) + p.x());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

struct Stack {
  std::vector<double> places;  ///< ascending heights of the sections
  double cell_mm = 1.0;
  Eigen::Vector2d low = Eigen::Vector2d::Zero();  ///< of the region that is compared
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
  double step_mm = 1.0;  ///< voxels, along all axes
};

inline std::vector<double> every(double first, double last, double step) {
  std::vector<double> places;
  for (double z = first; z <= last + 1e-9; z += step) places.push_back(z);
  return places;
}

/// Radius 12.3 px, its centre moves 3 px per slice.
inline std::vector<Polygon> oblique_tube(double z) { return {ellipse(20.0 + 3.0 * z, 30.0, 12.3, 12.3)}; }
inline Stack tube_stack(double step) { return {every(0.0, 48.0, step), 1.0, {0.0, 10.0}, {190.0, 50.0}, 1.0}; }

/// Semi-axes 40, 30 and 50 mm.
inline std::vector<Polygon> ellipsoid(double z) {
  const double square = 1.0 - z * z / 2500.0;
  if (square <= 0.0) return {};
  return {ellipse(0.0, 0.0, 40.0 * std::sqrt(square), 30.0 * std::sqrt(square))};
}
inline const Stack kEllipsoidStack{every(-40.0, 40.0, 10.0), 0.5, {-42.0, -32.0}, {42.0, 32.0}, 0.5};

/// A trunk of radius 6 mm to z = 40, then two branches of 4.5 mm that reach +-25 mm at z = 90.
inline std::vector<Polygon> y_tube(double z) {
  if (z <= 40.0) return {ellipse(0.0, 0.0, 6.0, 6.0)};
  const double aside = (z - 40.0) / 50.0 * 25.0;
  // Branches that still overlap are one outline: the union of two circles.
  if (aside >= 4.5) return {ellipse(-aside, 0.0, 4.5, 4.5), ellipse(aside, 0.0, 4.5, 4.5)};
  Polygon both;
  const double open = std::acos(aside / 4.5);
  for (const double side : {1.0, -1.0}) {
    for (int i = 0; i <= 100; ++i) {
      const double angle = -(std::numbers::pi - open) + 2.0 * (std::numbers::pi - open) * i / 100;
      both.emplace_back(side * (aside + 4.5 * std::cos(angle)), side * 4.5 * std::sin(angle));
    }
  }
  return {both};
}
inline const Stack kYStack{every(0.0, 90.0, 10.0), 0.25, {-32.0, -8.0}, {32.0, 8.0}, 0.25};

/// A bladder and a prostate beside it, 3 mm apart, that both shift by 17 mm from one plane to the next: on the second
/// plane the prostate lies where the bladder was on the first.
inline std::vector<Polygon> bladder_and_prostate(double z) {
  const double shift = 1.7 * z;
  return {ellipse(-shift, 0.0, 20.0, 15.0), ellipse(35.0 - shift, 0.0, 12.0, 10.0)};
}

/// A duct that goes aside and forks, as in figure 3.2.
inline std::vector<Polygon> ducts(double z) {
  if (z < 20.0) return {ellipse(1.2 * z, 0.4 * z, 5.0, 3.5)};
  const double on = z - 20.0;
  return {ellipse(24.0 + 0.5 + 1.3 * on, 8.0 + 4.5 + 0.2 * on, 3.4, 2.6),
          ellipse(24.0 - 0.5 - 0.2 * on, 8.0 - 4.5 - 1.0 * on, 3.0, 2.4)};
}

struct Likeness {
  double dice = 0.0;
  double volume_error = 0.0;  ///< relative to the true volume between the outer sections, by the same voxels
};

inline std::shared_ptr<const SectionShape> shape_of(const std::vector<Polygon>& outlines, double cell_mm) {
  if (outlines.empty()) return std::make_shared<SectionShape>();
  return std::make_shared<SectionShape>(outlines, section_raster(outlines, cell_mm));
}

inline SectionPlane plane_at(double z) {
  return {Eigen::Vector3d(0.0, 0.0, z), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()};
}

inline Likeness reconstruct(const Outlines& object, const Stack& stack, Guide guide) {
  double both = 0.0, truth = 0.0, found = 0.0;
  for (std::size_t s = 0; s + 1 < stack.places.size(); ++s) {
    const double z0 = stack.places[s];
    const double z1 = stack.places[s + 1];
    const SectionGap gap({plane_at(z0), shape_of(object(z0), stack.cell_mm)},
                         {plane_at(z1), shape_of(object(z1), stack.cell_mm)}, guide);
    ColumnGrid grid;
    grid.start_mm = stack.low;
    grid.column_step_mm = {stack.step_mm, 0.0};
    grid.row_step_mm = {0.0, stack.step_mm};
    grid.columns = static_cast<int>((stack.high.x() - stack.low.x()) / stack.step_mm);
    grid.rows = static_cast<int>((stack.high.y() - stack.low.y()) / stack.step_mm);
    grid.lattice = Lattice::kCubic;
    const GapColumns columns = gap.prepare(grid);
    std::vector<float> made(grid.size());
    const int layers = std::max(1, static_cast<int>(std::lround((z1 - z0) / stack.step_mm)));
    for (int k = 0; k < layers; ++k) {
      const double u = (k + 0.5) / layers;
      const std::vector<Polygon> outlines = object(z0 + u * (z1 - z0));
      gap.sample(columns, u, made);
      const double weight = (z1 - z0) / layers;
      for (int j = 0; j < grid.rows; ++j) {
        const std::vector<double> edges = crossings(outlines, grid.row_start_mm(j).y());
        for (int i = 0; i < grid.columns; ++i) {
          const double at = stack.low.x() + i * stack.step_mm;
          const bool is = (std::lower_bound(edges.begin(), edges.end(), at) - edges.begin()) % 2 != 0;
          const bool in = made[static_cast<std::size_t>(j * grid.columns + i)] >= 0.0F;
          truth += is ? weight : 0.0;
          found += in ? weight : 0.0;
          both += is && in ? weight : 0.0;
        }
      }
    }
  }
  return {2.0 * both / (truth + found), found / truth - 1.0};
}

}  // namespace fathom::stacks
