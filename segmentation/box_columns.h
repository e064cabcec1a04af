#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace fathom {

/// An upright rectangle, borders included.
struct Box {
  double left = 0.0;
  double right = 0.0;
  double top = 0.0;
  double bottom = 0.0;
};

inline bool overlap(const Box& a, const Box& b) {
  // One branch for all four, since which of them fails is a toss-up.
  return (a.left <= b.right) & (b.left <= a.right) & (a.top <= b.bottom) & (b.top <= a.bottom);
}

/// Boxes sorted into columns of the plane, so that those beside each other are found fast.
class BoxColumns {
 public:
  explicit BoxColumns(std::span<const Box> boxes);

  std::size_t size() const { return begin_.size() - 1; }
  /// The column that holds a coordinate; those beside all boxes count to the outermost.
  std::size_t column_of(double x) const;
  /// Numbers of the boxes that reach into a column.
  std::span<const std::size_t> operator[](std::size_t column) const;

 private:
  double left_ = 0.0;
  double width_ = 1.0;
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> boxes_;
};

}  // namespace fathom
