#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>

namespace fathom {

// How a row of pixels crosses the cells of a grid. The places where the row passes from one cell to the next are known
// in advance: along each axis they lie 1 / step apart. They are kept as integers, so that a row that is entered in its
// middle meets exactly the cells that it meets when it is walked from its start.

/// Places along a row, in 2^-32 pixels.
using RowPlace = std::int64_t;
constexpr int kPlaceBits = 32;
constexpr RowPlace kOnePixel = RowPlace{1} << kPlaceBits;
constexpr RowPlace kNever = RowPlace{1} << 61;  // two of them can be added

/// The first pixel at or after a place.
inline std::int64_t pixel_from(RowPlace place) { return (place + (kOnePixel - 1)) >> kPlaceBits; }

/// One axis of a row: the cell of its pixel 0, and where it changes cells.
struct RowAxis {
  std::int64_t cell = 0;       ///< of pixel 0
  std::int64_t direction = 1;  ///< of the change of cells
  RowPlace first = kNever;     ///< of the first change
  RowPlace step = kNever;      ///< from one change to the next

  /// The first pixel for which `count` changes are behind, or `end` if that comes first.
  std::int64_t pixel_after(std::int64_t count, std::int64_t end) const {
    if (count <= 0) return 0;
    const double place = static_cast<double>(first) + static_cast<double>(count - 1) * static_cast<double>(step);
    if (place >= static_cast<double>(end) * static_cast<double>(kOnePixel)) return end;
    return std::min(end, pixel_from(first + (count - 1) * step));
  }
  /// How many changes are behind at a pixel.
  std::int64_t changes_at(std::int64_t pixel) const {
    const RowPlace place = pixel << kPlaceBits;
    return place < first ? 0 : (place - first) / step + 1;
  }
};

/// What the rows of a frame have in common. Coordinates are counted in cells.
struct RowSteps {
  Eigen::Vector3d step = Eigen::Vector3d::Zero();  ///< from a pixel to the next
  std::array<double, 3> pixels_per_cell = {};      ///< infinite where the axis does not change
  std::array<RowPlace, 3> place_step = {};

  explicit RowSteps(const Eigen::Vector3d& cells_per_pixel) : step(cells_per_pixel) {
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      pixels_per_cell[i] = 1.0 / std::abs(step[k]);
      place_step[i] = place(pixels_per_cell[i]);
    }
  }
  /// Whether no pixel is farther from the last than a cell along any axis.
  bool finer_than_cells() const { return step.cwiseAbs().maxCoeff() <= 1.0; }

  RowAxis axis(int k, double start) const {
    const auto i = static_cast<std::size_t>(k);
    const double cell = std::floor(start);
    RowAxis axis;
    axis.cell = static_cast<std::int64_t>(cell);
    axis.step = place_step[i];
    if (step[k] > 0.0) {
      axis.first = place((cell + 1.0 - start) * pixels_per_cell[i]);
    } else {
      axis.direction = -1;
      // What lies on the border between two cells belongs to the upper one: it is left just after.
      axis.first = step[k] < 0.0 ? place((start - cell) * pixels_per_cell[i]) + 1 : kNever;
    }
    return axis;
  }

 private:
  static RowPlace place(double pixels) {
    constexpr double kFar = 1 << 29;  // longer than any row
    return pixels < kFar ? std::max<RowPlace>(1, static_cast<RowPlace>(pixels * static_cast<double>(kOnePixel)))
                         : kNever;
  }
};

/// Cells low[k] <= cell < high[k].
struct CellBox {
  std::array<std::int64_t, 3> low = {};
  std::array<std::int64_t, 3> high = {};
};

/// A walk along pixels `begin` to `end` - 1 of a row, all of them in a box.
class RowWalk {
 public:
  /// Takes the part of `begin` to `end` that lies in the box.
  RowWalk(const RowSteps& steps, const Eigen::Vector3d& start, const CellBox& box, std::int64_t begin, std::int64_t end)
      : start_(start) {
    for (int k = 2; k >= 0; --k) {  // the axis that slabs divide first
      const auto i = static_cast<std::size_t>(k);
      axes_[i] = steps.axis(k, start[k]);
      const RowAxis& axis = axes_[i];
      const bool up = axis.direction > 0;
      begin = std::max(begin, axis.pixel_after(up ? box.low[i] - axis.cell : axis.cell - (box.high[i] - 1), end));
      end = std::min(end, axis.pixel_after(up ? box.high[i] - axis.cell : axis.cell - (box.low[i] - 1), end));
      if (begin >= end) break;
    }
    begin_ = begin;
    end_ = end;
  }

  bool empty() const { return begin_ >= end_; }
  /// Where a pixel lies in its cell, along an axis that does not change cells: 0 to 1.
  double fraction(std::size_t axis, std::int64_t pixel, const RowSteps& steps) const {
    const auto k = static_cast<Eigen::Index>(axis);
    return start_[k] - std::floor(start_[k]) + steps.step[k] * static_cast<double>(pixel);
  }
  std::int64_t begin() const { return begin_; }
  std::int64_t end() const { return end_; }

  /// Calls visit(first, end, index, next) for every run of pixels in one cell: their range, the cell's index in an
  /// array of the given strides, and the places where the row changes cells next. `kFine`: steps.finer_than_cells().
  template <bool kFine, typename Visit>
  void each_run(const std::array<std::int64_t, 3>& strides, const Visit& visit) const {
    std::array<RowPlace, 3> next;
    std::array<RowPlace, 3> step;
    std::array<std::int64_t, 3> stride;
    std::int64_t index = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const RowAxis& axis = axes_[k];
      const std::int64_t changes = axis.changes_at(begin_);
      next[k] = axis.first + changes * axis.step;
      step[k] = axis.step;
      stride[k] = axis.direction * strides[k];
      index += (axis.cell + axis.direction * changes) * strides[k];
    }
    std::int64_t pixel = begin_;
    while (true) {
      if constexpr (kFine) {
        const std::int64_t x = pixel_from(next[0]);
        const std::int64_t y = pixel_from(next[1]);
        const std::int64_t z = pixel_from(next[2]);
        const std::int64_t change = std::min(std::min(x, y), z);
        if (change >= end_) break;
        visit(pixel, change, index, next);
        // Without branches, as which axis changes next cannot be foreseen.
        const std::int64_t at_x = -static_cast<std::int64_t>(x == change);
        const std::int64_t at_y = -static_cast<std::int64_t>(y == change);
        const std::int64_t at_z = -static_cast<std::int64_t>(z == change);
        next[0] += step[0] & at_x;
        next[1] += step[1] & at_y;
        next[2] += step[2] & at_z;
        index += (stride[0] & at_x) + (stride[1] & at_y) + (stride[2] & at_z);
        pixel = change;
      } else {
        if (pixel + 1 >= end_) break;
        visit(pixel, pixel + 1, index, next);
        ++pixel;
        for (std::size_t k = 0; k < 3; ++k) {
          while (next[k] <= (pixel << kPlaceBits)) {
            next[k] += step[k];
            index += stride[k];
          }
        }
      }
    }
    visit(pixel, end_, index, next);
  }

 private:
  Eigen::Vector3d start_;
  std::array<RowAxis, 3> axes_;
  std::int64_t begin_ = 0;
  std::int64_t end_ = 0;
};

}  // namespace fathom
