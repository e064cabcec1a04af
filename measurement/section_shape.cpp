#include "measurement/section_shape.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "measurement/chamfer.h"
#include "measurement/outline_distance.h"

namespace fathom {

namespace {

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

bool is_on(const SectionRaster& raster, const Eigen::Vector2f& at) {
  return at.x() >= 0.0F && at.y() >= 0.0F && at.x() <= static_cast<float>(raster.columns - 1) &&
         at.y() <= static_cast<float>(raster.rows - 1);
}

Eigen::Vector2f clamped(const SectionRaster& raster, const Eigen::Vector2f& at) {
  return {std::clamp(at.x(), 0.0F, static_cast<float>(raster.columns - 1)),
          std::clamp(at.y(), 0.0F, static_cast<float>(raster.rows - 1))};
}

// How far a point is outside of a rectangle along each axis.
Eigen::Vector2f outside_by(const Eigen::Vector2f& at, const Eigen::Vector2f& low, const Eigen::Vector2f& high) {
  return {std::max({low.x() - at.x(), at.x() - high.x(), 0.0F}), std::max({low.y() - at.y(), at.y() - high.y(), 0.0F})};
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

SectionShape::SectionShape(const Eigen::Vector2d& point_mm, double cell_mm) : kind_(SectionKind::kPoint) {
  if (!point_mm.allFinite() || !std::isfinite(cell_mm) || cell_mm <= 0.0) {
    throw Error(
        "the point that marks an end of a structure is not finite; "
        "check the calibration");
  }
  raster_.origin_mm = point_mm;
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
    // Too small for the raster: it still leads to its partners on neighbouring planes, like a point.
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
  rim_least_ = std::numeric_limits<float>::max();
  const auto add = [&](int i, int j) {
    const std::size_t at = raster_.index(i, j);
    rim_.x.push_back(static_cast<float>(i));
    rim_.y.push_back(static_cast<float>(j));
    rim_.nearest_x.push_back(nearest.x[at]);
    rim_.nearest_y.push_back(nearest.y[at]);
    rim_.code.push_back(static_cast<float>(codes_[at]));
    rim_least_ = std::min(rim_least_, nearest.distance[at]);
  };
  for (int i = 0; i < last_i; ++i) add(i, 0);
  for (int j = 0; j < last_j; ++j) add(last_i, j);
  for (int i = last_i; i > 0; --i) add(i, last_j);
  for (int j = last_j; j > 0; --j) add(0, j);
  add_rim_blocks();

  const auto cell_mm = static_cast<float>(raster_.cell_mm);
  distances_mm_ = std::move(nearest.distance);
  for (std::size_t at = 0; at < distances_mm_.size(); ++at) {
    distances_mm_[at] *= inside[at] != 0 ? cell_mm : -cell_mm;
    largest_inside_mm_ = std::max(largest_inside_mm_, distances_mm_[at]);
  }
}

float SectionShape::distance_at_mm(const Eigen::Vector2f& at) const {
  assert(kind_ != SectionKind::kAbsent);
  const auto cell_mm = static_cast<float>(raster_.cell_mm);
  if (kind_ == SectionKind::kPoint) return -cell_mm * at.norm();
  return is_on(raster_, at) ? bilinear(distances_mm_, raster_, at) : -cell_mm * far_distance(at);
}

float SectionShape::code(const Eigen::Vector2d& ab_mm) const {
  assert(kind_ != SectionKind::kAbsent);
  if (kind_ == SectionKind::kPoint) {
    const Eigen::Vector2f to = in_cells(ab_mm);
    return static_cast<float>(kChamferBorder) - chamfer_length(to.x(), to.y());
  }
  const Eigen::Vector2f at = in_cells(ab_mm);
  return is_on(raster_, at) ? bilinear(codes_, raster_, at) : -far_code(at);
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
  const Eigen::Vector2f at = in_cells(ab_mm);
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
  return (2 * (last_i + last_j) - j) % (2 * (last_i + last_j));
}

void SectionShape::add_rim_blocks() {
  for (std::vector<float>* values : {&rim_.x, &rim_.y, &rim_.nearest_x, &rim_.nearest_y, &rim_.code}) {
    const float last = values->back();
    while (values->size() % kRimBlock != 0) values->push_back(last);
  }
  for (std::size_t from = 0; from < rim_.x.size(); from += kRimBlock) {
    const auto range = [from](const std::vector<float>& values) {
      const auto first = values.begin() + static_cast<std::ptrdiff_t>(from);
      return std::minmax_element(first, first + static_cast<std::ptrdiff_t>(kRimBlock));
    };
    const auto x = range(rim_.x);
    const auto y = range(rim_.y);
    const auto nearest_x = range(rim_.nearest_x);
    const auto nearest_y = range(rim_.nearest_y);
    rim_blocks_.push_back({{*x.first, *y.first},
                           {*x.second, *y.second},
                           {*nearest_x.first, *nearest_y.first},
                           {*nearest_x.second, *nearest_y.second},
                           *range(rim_.code).first});
  }
}

// The straight way to the nearest outline point passes the rim, and its rim point has the same nearest point.
float SectionShape::far_distance(const Eigen::Vector2f& at) const {
  const std::size_t start = rim_index(at) / kRimBlock;
  float best = std::numeric_limits<float>::max();
  const auto look = [&](std::size_t block) {
    const float* x = &rim_.nearest_x[block * kRimBlock];
    const float* y = &rim_.nearest_y[block * kRimBlock];
    std::array<float, kRimBlock> squares;
    for (std::size_t k = 0; k < kRimBlock; ++k) {
      squares[k] = (x[k] - at.x()) * (x[k] - at.x()) + (y[k] - at.y()) * (y[k] - at.y());
    }
    best = std::min(best, *std::min_element(squares.begin(), squares.end()));
  };
  look(start);
  for (std::size_t block = 0; block < rim_blocks_.size(); ++block) {
    const RimBlock& box = rim_blocks_[block];
    if (block != start && outside_by(at, box.nearest_low, box.nearest_high).squaredNorm() < best) look(block);
  }
  return std::sqrt(best);
}

// In chamfer units, without sign. Treece 2000, equation (3.2), figure 3.8. Between points of the raster the rim's codes
// are linear along it, as on the raster: the way by the foot of the point on the rim makes the code continuous there.
float SectionShape::far_code(const Eigen::Vector2f& at) const {
  const Eigen::Vector2f foot = clamped(raster_, at);
  float best = std::abs(bilinear(codes_, raster_, foot)) + chamfer_length(at.x() - foot.x(), at.y() - foot.y());
  for (std::size_t block = 0; block < rim_blocks_.size(); ++block) {
    const RimBlock& box = rim_blocks_[block];
    const Eigen::Vector2f off = outside_by(at, box.low, box.high);
    if (chamfer_length(off.x(), off.y()) + box.least_code >= best) continue;
    std::array<float, kRimBlock> ways;
    for (std::size_t k = 0; k < kRimBlock; ++k) {
      const std::size_t i = block * kRimBlock + k;
      ways[k] = chamfer_length(at.x() - rim_.x[i], at.y() - rim_.y[i]) + rim_.code[i];
    }
    best = std::min(best, *std::min_element(ways.begin(), ways.end()));
  }
  return best;
}

}  // namespace fathom
