#include "surface/exact_orientation.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace fathom {

namespace {

// Rounding of a determinant relative to the sum of its terms' magnitudes, somewhat above the bounds (3 + 16 e) e and
// (7 + 56 e) e, e = 2^-53, of Shewchuk 1997, "Adaptive precision floating-point arithmetic".
constexpr double kDoubt2d = 4e-16;
constexpr double kDoubt3d = 8e-16;

int sign(double value) { return (value > 0.0) - (value < 0.0); }

/// A sum of doubles without rounding, kept as parts that do not overlap, from small to large.
class ExactSum {
 public:
  void add(double value) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double sum = value + parts_[i];
      const double from_part = sum - value;
      const double rest = (value - (sum - from_part)) + (parts_[i] - from_part);
      if (rest != 0.0) parts_[kept++] = rest;
      value = sum;
    }
    assert(kept < parts_.size());
    if (value != 0.0) parts_[kept++] = value;
    count_ = kept;
  }

  void add_product(double x, double y) {
    const double product = x * y;
    add(std::fma(x, y, -product));
    add(product);
  }

  void add_product(double x, double y, double z) {
    const double product = x * y;
    add_product(std::fma(x, y, -product), z);
    add_product(product, z);
  }

  int sign_of_sum() const { return count_ == 0 ? 0 : sign(parts_[count_ - 1]); }

 private:
  std::array<double, 97> parts_;  // 24 products of three, of four parts each, are the most that is added here
  std::size_t count_ = 0;
};

template <int kDimension>
bool is_exact(const Eigen::Vector<double, kDimension>& difference, const Eigen::Vector<double, kDimension>& from,
              const Eigen::Vector<double, kDimension>& to) {
  // Both ways back being exact is more than needed, and simple.
  return from + difference == to && to - difference == from;
}

void add_determinant(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, double factor,
                     ExactSum& sum) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    sum.add_product(factor * a[i], b[j], c[k]);
    sum.add_product(-factor * a[i], b[k], c[j]);
  }
}

}  // namespace

int certain_orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double left = (b.x() - a.x()) * (c.y() - a.y());
  const double right = (b.y() - a.y()) * (c.x() - a.x());
  const double determinant = left - right;
  return std::abs(determinant) > kDoubt2d * (std::abs(left) + std::abs(right)) ? sign(determinant) : 0;
}

int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  if (const int certain = certain_orientation(a, b, c); certain != 0) return certain;
  ExactSum sum;
  sum.add_product(a.x(), b.y());
  sum.add_product(-a.y(), b.x());
  sum.add_product(b.x(), c.y());
  sum.add_product(-b.y(), c.x());
  sum.add_product(c.x(), a.y());
  sum.add_product(-c.y(), a.x());
  return sum.sign_of_sum();
}

int orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                const Eigen::Vector3d& d) {
  const Eigen::Vector3d u = b - a;
  const Eigen::Vector3d v = c - a;
  const Eigen::Vector3d w = d - a;
  double determinant = 0.0;
  double magnitude = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const double plus = u[j] * v[k];
    const double minus = u[k] * v[j];
    determinant += w[i] * (plus - minus);
    magnitude += std::abs(w[i]) * (std::abs(plus) + std::abs(minus));
  }
  if (std::abs(determinant) > kDoubt3d * magnitude) return sign(determinant);
  ExactSum sum;
  if (is_exact<3>(u, a, b) && is_exact<3>(v, a, c) && is_exact<3>(w, a, d)) {
    if (magnitude == 0.0) return 0;
    add_determinant(u, v, w, 1.0, sum);
  } else {
    // The same determinant of the points themselves, by the row of ones that it has in four dimensions.
    add_determinant(b, c, d, 1.0, sum);
    add_determinant(a, c, d, -1.0, sum);
    add_determinant(a, b, d, 1.0, sum);
    add_determinant(a, b, c, -1.0, sum);
  }
  return sum.sign_of_sum();
}

}  // namespace fathom
