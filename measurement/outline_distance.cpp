#include "measurement/outline_distance.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

constexpr double kLongestPiece = 2.0;  // cells: pieces of a line whose bounding
                                       // boxes hold few points far from it
constexpr float kNowhere = 1e15F;      // its square is still a float

class Propagation {
 public:
  explicit Propagation(const SectionRaster& raster)
      : raster_(raster),
        square_(raster.size(), kNowhere * kNowhere),
        x_(raster.size(), kNowhere),
        y_(raster.size(), kNowhere) {}

  // Exact nearest points on a line for all raster points within one cell of it.
  void draw(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const int pieces = std::max(1, static_cast<int>(std::ceil((to - from).norm() / kLongestPiece)));
    Eigen::Vector2d end = from;
    for (int k = 1; k <= pieces; ++k) {
      const Eigen::Vector2d start = end;
      end = from + (to - from) * (static_cast<double>(k) / pieces);
      draw_piece(start.cast<float>(), end.cast<float>());
    }
  }

  void spread() {
    for (int j = 0; j < raster_.rows; ++j) {
      if (j > 0) pass_on(j - 1, j);
      sweep_row(j);
    }
    for (int j = raster_.rows - 1; j >= 0; --j) {
      if (j + 1 < raster_.rows) pass_on(j + 1, j);
      sweep_row(j);
    }
  }

  NearestPoints result() && {
    for (float& value : square_) value = std::sqrt(value);
    return {std::move(square_), std::move(x_), std::move(y_)};
  }

 private:
  void draw_piece(const Eigen::Vector2f& from, const Eigen::Vector2f& to) {
    const Eigen::Vector2f along = to - from;
    const float length = along.squaredNorm();
    const float scale = length > 0.0F ? 1.0F / length : 0.0F;
    const auto first = [](float value) { return std::max(0, static_cast<int>(std::ceil(value - 1.0F))); };
    const auto last = [](float value, int count) {
      return std::min(count - 1, static_cast<int>(std::floor(value + 1.0F)));
    };
    const int i0 = first(std::min(from.x(), to.x()));
    const int i1 = last(std::max(from.x(), to.x()), raster_.columns);
    const int j1 = last(std::max(from.y(), to.y()), raster_.rows);
    for (int j = first(std::min(from.y(), to.y())); j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) {
        const auto px = static_cast<float>(i);
        const auto py = static_cast<float>(j);
        const float t = std::clamp(((px - from.x()) * along.x() + (py - from.y()) * along.y()) * scale, 0.0F, 1.0F);
        const float x = from.x() + t * along.x();
        const float y = from.y() + t * along.y();
        const float square = (px - x) * (px - x) + (py - y) * (py - y);
        const std::size_t at = raster_.index(i, j);
        if (square >= square_[at]) continue;
        square_[at] = square;
        x_[at] = x;
        y_[at] = y;
      }
    }
  }

  // Offers the nearest points of three neighbours in row `from` to every point of row `to`.
  void pass_on(int from, int to) {
    const int columns = raster_.columns;
    const float* fx = &x_[raster_.index(0, from)];
    const float* fy = &y_[raster_.index(0, from)];
    float* __restrict square = &square_[raster_.index(0, to)];
    float* __restrict x = &x_[raster_.index(0, to)];
    float* __restrict y = &y_[raster_.index(0, to)];
    const auto row = static_cast<float>(to);
    for (int shift = -1; shift <= 1; ++shift) {
      const int end = std::min(columns, columns - shift);
      for (int i = std::max(0, -shift); i < end; ++i) {
        const float cx = fx[i + shift];
        const float cy = fy[i + shift];
        const float dx = cx - static_cast<float>(i);
        const float dy = cy - row;
        const float candidate = dx * dx + dy * dy;
        const bool nearer = candidate < square[i];
        x[i] = nearer ? cx : x[i];
        y[i] = nearer ? cy : y[i];
        square[i] = nearer ? candidate : square[i];
      }
    }
  }

  void sweep_row(int j) {
    for (int i = 1; i < raster_.columns; ++i) take(raster_.index(i, j), raster_.index(i - 1, j), i, j);
    for (int i = raster_.columns - 2; i >= 0; --i) take(raster_.index(i, j), raster_.index(i + 1, j), i, j);
  }

  void take(std::size_t at, std::size_t from, int i, int j) {
    const float dx = x_[from] - static_cast<float>(i);
    const float dy = y_[from] - static_cast<float>(j);
    const float candidate = dx * dx + dy * dy;
    if (candidate >= square_[at]) return;
    square_[at] = candidate;
    x_[at] = x_[from];
    y_[at] = y_[from];
  }

  const SectionRaster& raster_;
  std::vector<float> square_;
  std::vector<float> x_;
  std::vector<float> y_;
};

}  // namespace

NearestPoints nearest_outline_points(std::span<const Polygon> outlines, const SectionRaster& raster) {
  Propagation propagation(raster);
  for (const Polygon& outline : outlines) {
    const Eigen::Vector2d* from = &outline.back();
    for (const Eigen::Vector2d& to : outline) {
      propagation.draw(*from, to);
      from = &to;
    }
  }
  propagation.spread();
  return std::move(propagation).result();
}

}  // namespace fathom
