#pragma once

#include <memory>
#include <span>
#include <string>

#include <Eigen/Core>

namespace fathom {

/// A function of space, written by a user as an expression of `x`, `y` and `z`, such as "x^2 + y^2 + z^2 - 1".
///
/// Numbers, `pi` and `e`; `+ - * / ^`, where ^ binds more tightly than a sign and to the right; `< <= > >= == !=`,
/// `&& ||`, which give 1 or 0; `a ? b : c`; round brackets; and the functions of equation_functions(). Nothing else: no
/// assignment, no text, no second expression behind a comma. It does not depend on the user's locale.
class Equation {
 public:
  static constexpr std::size_t kLongest = 10000;  ///< characters
  static constexpr int kDeepest = 200;            ///< brackets within brackets

  /// Throws Error saying what is wrong, and at which character (from 1), when the expression is empty, longer or nested
  /// deeper than the limits, or anything but the above.
  explicit Equation(const std::string& expression);
  ~Equation();
  Equation(Equation&&) noexcept;
  Equation& operator=(Equation&&) noexcept;

  /// Values at `start + i * step`, one for each element of `out`; NaN or infinite where the expression is. Several
  /// threads may ask at once.
  void values(const Eigen::Vector3d& start, const Eigen::Vector3d& step, std::span<double> out) const;

  /// The value at one place. Slower than a row of them.
  double value(const Eigen::Vector3d& place) const;

 private:
  class Parsers;
  std::unique_ptr<Parsers> parsers_;
};

/// What may be called in an equation, for help texts: "abs acos ... min(a, b, ...)". Angles are radians; log is the
/// natural logarithm, as is ln.
const std::string& equation_functions();

}  // namespace fathom
