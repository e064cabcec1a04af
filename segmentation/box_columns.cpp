#include "segmentation/box_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom {

namespace {

// A column holds about this many boxes where they are small.
constexpr double kBoxesPerColumn = 4.0;

// Wide boxes lie in many columns; there are only so many columns that a box lies in this many on average.
constexpr double kColumnsPerBox = 4.0;

constexpr double kMostColumns = 1 << 16;

}  // namespace

BoxColumns::BoxColumns(std::span<const Box> boxes) {
  left_ = std::numeric_limits<double>::infinity();
  double right = -std::numeric_limits<double>::infinity();
  double reach = 0.0;
  for (const Box& box : boxes) {
    left_ = std::min(left_, box.left);
    right = std::max(right, box.right);
    reach += box.right - box.left;
  }
  const double all = right - left_;
  double columns = 1.0;
  if (all > 0.0) {
    const double count = static_cast<double>(boxes.size());
    columns = std::min({count / kBoxesPerColumn, kColumnsPerBox * count * all / reach, kMostColumns});
    columns = std::max(1.0, std::floor(columns));
    width_ = all / columns;
  }

  begin_.assign(static_cast<std::size_t>(columns) + 1, 0);
  for (const Box& box : boxes) {
    const std::size_t last = column_of(box.right);
    for (std::size_t column = column_of(box.left); column <= last; ++column) ++begin_[column + 1];
  }
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  boxes_.resize(begin_.back());
  std::vector<std::size_t> place(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const std::size_t last = column_of(boxes[i].right);
    for (std::size_t column = column_of(boxes[i].left); column <= last; ++column) boxes_[place[column]++] = i;
  }
}

std::size_t BoxColumns::column_of(double x) const {
  const double last = static_cast<double>(size() - 1);
  return static_cast<std::size_t>(std::clamp((x - left_) / width_, 0.0, last));
}

std::span<const std::size_t> BoxColumns::operator[](std::size_t column) const {
  return std::span(boxes_).subspan(begin_[column], begin_[column + 1] - begin_[column]);
}

}  // namespace fathom
