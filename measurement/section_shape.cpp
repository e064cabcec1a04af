#include "measurement/section_shape.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "measurement/chamfer.h"
#include "measurement/outline_distance.h"

namespace fathom {

namespace {

// The raster's points are one cell apart along the rim, so the straight way to
// the nearest outline point may miss the nearest of them by half of that, on
// both of its parts.
constexpr float kRimMiss = 1.0F;

template <typename T>
float bilinear(const std::vector<T>& values, const SectionRaster& raster, const Eigen::Vector2f& at) {
  const int i = std::min(static_cast<int>(at.x()), raster.columns - 2);
  const int j = std::min(static_cast<int>(at.y()), raster.rows - 2);
  const float x = at.x() - static_cast<float>(i);
  const float y = at.y() - static_cast<float>(j);
  const T* corner = &values[raster.index(i, j)];
  const T* above = corner + raster.columns;
  const auto v00 = static_cast<float>(corner[0]);
  const auto v01 = static_cast<float>(above[0]);
  const float low = v00 + x * (static_cast<float>(corner[1]) - v00);
  const float high = v01 + x * (static_cast<float>(above[1]) - v01);
  return low + y * (high - low);
}

Eigen::Vector2f in_cells(const Eigen::Vector2d& ab_mm, const SectionRaster& raster) {
  return ((ab_mm - raster.origin_mm) / raster.cell_mm).cast<float>();
}

bool is_on(const SectionRaster& raster, const Eigen::Vector2f& at) {
  return at.x() >= 0.0F && at.y() >= 0.0F && at.x() <= static_cast<float>(raster.columns - 1) &&
         at.y() <= static_cast<float>(raster.rows - 1);
}

Eigen::Vector2f clamped(const SectionRaster& raster, const Eigen::Vector2f& at) {
  return {std::clamp(at.x(), 0.0F, static_cast<float>(raster.columns - 1)),
          std::clamp(at.y(), 0.0F, static_cast<float>(raster.rows - 1))};
}

std::vector<Polygon> outlines_in_cells(const std::vector<Polygon>& outlines_mm, const SectionRaster& raster) {
  std::vector<Polygon> outlines = outlines_mm;
  if (outlines.empty())
    throw Error(
        "a cross-section has no outline; draw one, or mark the frame "
        "as absent");
  if (!(raster.cell_mm > 0.0) || std::max(raster.columns, raster.rows) > kMostRasterPoints) {
    throw Error(
        "the raster of a cross-section has too many cells, or none; "
        "use larger cells");
  }
  for (Polygon& outline : outlines) {
    if (outline.size() < 3) throw Error("an outline has fewer than three points; draw it again");
    for (Eigen::Vector2d& point : outline) {
      point = (point - raster.origin_mm) / raster.cell_mm;
      // Also false where a coordinate is not a number.
      if (!(point.minCoeff() >= 1.0 && point.x() <= raster.columns - 2 && point.y() <= raster.rows - 2)) {
        throw Error(
            "an outline leaves the raster of its cross-section or is "
            "not finite; check the calibration");
      }
    }
  }
  return outlines;
}

}  // namespace

SectionShape::SectionShape(const Eigen::Vector2d& point_mm, double cell_mm)
    : kind_(SectionKind::kPoint), point_mm_(point_mm) {
  if (!point_mm.allFinite() || !std::isfinite(cell_mm) || cell_mm <= 0.0) {
    throw Error(
        "the point that marks an end of a structure is not finite; "
        "check the calibration");
  }
  raster_.cell_mm = cell_mm;
  inside_discs_.push_back({point_mm, kChamferBorder});
}

SectionShape::SectionShape(std::vector<Polygon> outlines_mm, const SectionRaster& raster)
    : kind_(SectionKind::kOutlined), raster_(raster), outlines_mm_(std::move(outlines_mm)) {
  const std::vector<Polygon> outlines = outlines_in_cells(outlines_mm_, raster_);
  const std::vector<std::uint8_t> inside = inside_outlines(outlines, raster_);
  codes_ = chamfer_codes(inside, raster_);
  NearestPoints nearest = nearest_outline_points(outlines, raster_);
  inside_discs_ = maximal_discs(codes_, inside, 1, raster_, nearest);
  outside_discs_ = maximal_discs(codes_, inside, 0, raster_, nearest);
  if (inside_discs_.empty()) {
    // Too small for the raster: it still leads to its partners on neighbouring
    // planes, like a point.
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& point : outlines_mm_.front()) middle += point;
    middle /= static_cast<double>(outlines_mm_.front().size());
    inside_discs_.push_back({middle, kChamferBorder});
    const auto i = static_cast<int>(std::lround((middle.x() - raster_.origin_mm.x()) / raster_.cell_mm));
    const auto j = static_cast<int>(std::lround((middle.y() - raster_.origin_mm.y()) / raster_.cell_mm));
    std::vector<std::uint8_t> marked = inside;
    marked[raster_.index(i, j)] = 1;
    codes_ = chamfer_codes(marked, raster_);
    outside_discs_ = maximal_discs(codes_, marked, 0, raster_, nearest);
    find_distances(std::move(nearest), inside);
    for (std::size_t at = 0; at < codes_.size(); ++at) {
      if (marked[at] == 0) codes_[at] = static_cast<std::int16_t>(-codes_[at]);
    }
    return;
  }
  find_distances(std::move(nearest), inside);
  for (std::size_t at = 0; at < codes_.size(); ++at) {
    if (inside[at] == 0) codes_[at] = static_cast<std::int16_t>(-codes_[at]);
  }
}

void SectionShape::find_distances(NearestPoints nearest, const std::vector<std::uint8_t>& inside) {
  const int last_i = raster_.columns - 1;
  const int last_j = raster_.rows - 1;
  rim_.reserve(2 * static_cast<std::size_t>(last_i + last_j));
  rim_least_ = std::numeric_limits<float>::max();
  const auto add = [&](int i, int j) {
    const std::size_t at = raster_.index(i, j);
    rim_.push_back({{static_cast<float>(i), static_cast<float>(j)},
                    {nearest.x[at], nearest.y[at]},
                    nearest.distance[at],
                    static_cast<float>(codes_[at])});
    rim_least_ = std::min(rim_least_, nearest.distance[at]);
  };
  for (int i = 0; i < last_i; ++i) add(i, 0);
  for (int j = 0; j < last_j; ++j) add(last_i, j);
  for (int i = last_i; i > 0; --i) add(i, last_j);
  for (int j = last_j; j > 0; --j) add(0, j);

  const auto cell_mm = static_cast<float>(raster_.cell_mm);
  distances_mm_ = std::move(nearest.distance);
  for (std::size_t at = 0; at < distances_mm_.size(); ++at) {
    distances_mm_[at] *= inside[at] != 0 ? cell_mm : -cell_mm;
    largest_inside_mm_ = std::max(largest_inside_mm_, distances_mm_[at]);
  }
}

float SectionShape::distance_mm(const Eigen::Vector2d& ab_mm) const {
  assert(kind_ != SectionKind::kAbsent);
  if (kind_ == SectionKind::kPoint) return -static_cast<float>((ab_mm - point_mm_).norm());
  const Eigen::Vector2f at = in_cells(ab_mm, raster_);
  if (is_on(raster_, at)) return bilinear(distances_mm_, raster_, at);
  return -static_cast<float>(raster_.cell_mm) * far_distance(at);
}

float SectionShape::code(const Eigen::Vector2d& ab_mm) const {
  assert(kind_ != SectionKind::kAbsent);
  if (kind_ == SectionKind::kPoint) {
    const Eigen::Vector2f to = ((ab_mm - point_mm_) / raster_.cell_mm).cast<float>();
    return static_cast<float>(kChamferBorder) - chamfer_length(to.x(), to.y());
  }
  const Eigen::Vector2f at = in_cells(ab_mm, raster_);
  if (is_on(raster_, at)) return bilinear(codes_, raster_, at);
  // Equation (3.2) holds at raster points; between them the code is bilinear,
  // here as on the raster.
  const Eigen::Vector2f corner(std::floor(at.x()), std::floor(at.y()));
  const Eigen::Vector2f part = at - corner;
  const auto value = [&](float i, float j) {
    const Eigen::Vector2f point = corner + Eigen::Vector2f(i, j);
    return is_on(raster_, point) ? bilinear(codes_, raster_, point) : -far_code(point);
  };
  const float low = value(0, 0) + part.x() * (value(1, 0) - value(0, 0));
  const float high = value(0, 1) + part.x() * (value(1, 1) - value(0, 1));
  return low + part.y() * (high - low);
}

void SectionShape::sample(const ColumnGrid& grid, std::span<float> out) const {
  assert(out.size() == grid.size());
  std::size_t at = 0;
  for (int j = 0; j < grid.rows; ++j) {
    const Eigen::Vector2d start = grid.row_start_mm(j);
    for (int i = 0; i < grid.columns; ++i) out[at++] = distance_mm(start + i * grid.column_step_mm);
  }
}

float SectionShape::least_outside_mm(const Eigen::Vector2d& ab_mm) const {
  if (kind_ != SectionKind::kOutlined) return 0.0F;
  const Eigen::Vector2f at = in_cells(ab_mm, raster_);
  const Eigen::Vector2f beyond = at - clamped(raster_, at);
  const float farthest = beyond.cwiseAbs().maxCoeff();
  return farthest > 0.0F ? static_cast<float>(raster_.cell_mm) * (rim_least_ + farthest) : 0.0F;
}

// The rim point nearest to a point off the raster.
std::size_t SectionShape::rim_index(const Eigen::Vector2f& at) const {
  const Eigen::Vector2f near = clamped(raster_, at);
  const auto i = static_cast<std::size_t>(near.x() + 0.5F);
  const auto j = static_cast<std::size_t>(near.y() + 0.5F);
  const auto last_i = static_cast<std::size_t>(raster_.columns - 1);
  const auto last_j = static_cast<std::size_t>(raster_.rows - 1);
  if (at.y() < 0.0F) return i;
  if (at.x() > static_cast<float>(last_i)) return last_i + j;
  if (at.y() > static_cast<float>(last_j)) return 2 * last_i + last_j - i;
  return (2 * (last_i + last_j) - j) % rim_.size();
}

// The straight way to the nearest outline point passes the rim, and its rim
// point has the same nearest point. The way by way of a rim point changes by
// two cells at most from one to the next, so that after a long one many are
// skipped.
float SectionShape::far_distance(const Eigen::Vector2f& at) const {
  const std::size_t start = rim_index(at);
  float best = (at - rim_[start].nearest).norm();
  for (std::size_t walked = 0; walked < rim_.size();) {
    const std::size_t index = start + walked < rim_.size() ? start + walked : start + walked - rim_.size();
    const RimPoint& rim = rim_[index];
    best = std::min(best, (at - rim.nearest).norm());
    const float excess = (at - rim.at).norm() + rim.distance - best - kRimMiss;
    walked += excess > 2.0F ? static_cast<std::size_t>(0.5F * excess) : 1;
  }
  return best;
}

// In chamfer units, without sign. Treece 2000, equation (3.2), figure 3.8.
float SectionShape::far_code(const Eigen::Vector2f& at) const {
  constexpr auto kWorst = static_cast<float>(2 * kChamferStep);  // most that a way changes from rim point to rim point
  const std::size_t start = rim_index(at);
  float best = std::numeric_limits<float>::max();
  for (std::size_t walked = 0; walked < rim_.size();) {
    const std::size_t index = start + walked < rim_.size() ? start + walked : start + walked - rim_.size();
    const RimPoint& rim = rim_[index];
    const float way = chamfer_length(at.x() - rim.at.x(), at.y() - rim.at.y()) + rim.code;
    best = std::min(best, way);
    walked += way - best > kWorst ? static_cast<std::size_t>((way - best) / kWorst) : 1;
  }
  return best;
}

}  // namespace fathom
