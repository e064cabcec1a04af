#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/random.h"
#include "sim/speckle.h"

namespace fathom {

namespace {

constexpr double kWidthOfSigma = 2.354820045;  // full width at half height of a Gaussian
// Spacing of the noise in space, of the smallest standard deviation of the response: the sum of squared weights then
// ripples by 0.2 % as the probe moves, and finer changes no statistics, only time.
constexpr double kLatticeOfSigma = 1.2;
constexpr double kGridOfSigma = 0.7;           // of the samples in the image that it is collected on
constexpr double kElevationReach = 3.0;        // standard deviations of the response across the image
constexpr double kSplineVariance = 1.0 / 4.0;  // of a quadratic spline, in samples: what collecting blurs by
constexpr double kLinearVariance = 1.0 / 6.0;  // what interpolating between samples blurs by
constexpr int kMargin = 2;                     // samples around the image: a spline reaches one, rounding another
constexpr int kTableBits = 16;

/// Complex Gaussian numbers of mean square 1 to draw from.
std::vector<cv::Vec2f> noise_table(std::uint64_t seed) {
  Random random(seed);
  constexpr double kPart = 0.70710678118654752;  // real and imaginary parts share a variance of 1
  std::vector<cv::Vec2f> table(std::size_t{1} << kTableBits);
  for (cv::Vec2f& value : table) {
    value[0] = static_cast<float>(kPart * random.normal());
    value[1] = static_cast<float>(kPart * random.normal());
  }
  return table;
}

/// A number for each line of the lattice, and from it one for each point on the line: hashes, so that nothing repeats.
std::uint64_t line_hash(std::uint64_t seed, std::int64_t a, std::int64_t b, int axis) {
  std::uint64_t x = seed * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(axis);
  for (const std::int64_t part : {a, b}) {
    x = (x ^ static_cast<std::uint64_t>(part)) * 0xBF58476D1CE4E5B9u;
    x ^= x >> 31;
  }
  return x * 0x94D049BB133111EBu;
}

cv::Mat gaussian_kernel(double sigma) {
  const int reach = std::max(1, static_cast<int>(std::ceil(3.0 * sigma)));
  cv::Mat kernel(1, 2 * reach + 1, CV_32FC1);
  for (int i = -reach; i <= reach; ++i) {
    kernel.at<float>(0, i + reach) = static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)));
  }
  return kernel / cv::sum(kernel)[0];
}

/// Weights of a quadratic spline at the sample nearest to `at`, its neighbours first and last.
struct Spline {
  int nearest;
  std::array<float, 3> weight;
  explicit Spline(float at) : nearest(static_cast<int>(at + 0.5F)) {
    const float off = at - static_cast<float>(nearest);
    weight = {0.5F * (0.5F - off) * (0.5F - off), 0.75F - off * off, 0.5F * (0.5F + off) * (0.5F + off)};
  }
};

/// A range of whole numbers.
struct Range {
  double low = -std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::max();
  /// Keeps those x for which start + x * slope is within [least, most].
  void keep(double start, double slope, double least, double most) {
    if (std::abs(slope) < 1e-12) {
      if (start < least || start > most) high = low - 1.0;
      return;
    }
    const double one = (least - start) / slope;
    const double other = (most - start) / slope;
    low = std::max(low, std::min(one, other));
    high = std::min(high, std::max(one, other));
  }
};

/// The lattice of noise seen from an image: sample coordinates (x, y) and height over the plane in standard deviations
/// are linear in the lattice's whole numbers.
struct LatticeView {
  Eigen::Vector3d start;  // of lattice point (0, 0, 0)
  Eigen::Matrix3d steps;  // columns: of a step along each of the lattice's axes
  cv::Size size;          // of the samples

  /// The box around the lattice points that count, along `axis`.
  Range range(int axis) const {
    const Eigen::Matrix3d back = steps.inverse();
    Range range{std::numeric_limits<double>::max(), -std::numeric_limits<double>::max()};
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d at((corner & 1) != 0 ? size.width - kMargin : kMargin - 1,
                               (corner & 2) != 0 ? size.height - kMargin : kMargin - 1,
                               (corner & 4) != 0 ? kElevationReach : -kElevationReach);
      const double value = (back * (at - start))[axis];
      range.low = std::min(range.low, value);
      range.high = std::max(range.high, value);
    }
    return range;
  }

  /// Keeps what lies on the line from `from` along `axis` within the samples and the response's thickness.
  Range on_line(const Eigen::Vector3d& from, int axis) const {
    Range range;
    range.keep(from.x(), steps(0, axis), kMargin - 1, size.width - kMargin);
    range.keep(from.y(), steps(1, axis), kMargin - 1, size.height - kMargin);
    range.keep(from.z(), steps(2, axis), -kElevationReach, kElevationReach);
    return range;
  }
};

/// Adds the lattice's noise to the samples: each point with the response's height at its distance from the plane.
void collect(const LatticeView& view, std::uint64_t seed, const std::vector<cv::Vec2f>& table, cv::Mat& samples) {
  // Lines run along the axis nearest to the plane's normal: each passes through the slab once.
  Eigen::Index normal = 0;
  view.steps.row(2).cwiseAbs().maxCoeff(&normal);
  const int along = static_cast<int>(normal);
  const int a_axis = (along + 1) % 3;
  const int b_axis = (along + 2) % 3;
  const Range a_range = view.range(a_axis);
  const Range b_range = view.range(b_axis);
  const Eigen::Vector3f step = view.steps.col(along).cast<float>();
  const double rise = view.steps(2, along);
  for (double a = std::ceil(a_range.low); a <= a_range.high; a += 1.0) {
    for (double b = std::ceil(b_range.low); b <= b_range.high; b += 1.0) {
      const Eigen::Vector3d from = view.start + a * view.steps.col(a_axis) + b * view.steps.col(b_axis);
      const Range line = view.on_line(from, along);
      const double first = std::ceil(line.low);
      if (first > line.high) continue;
      const std::uint64_t hash = line_hash(seed, static_cast<std::int64_t>(a), static_cast<std::int64_t>(b), along);
      auto number = hash + static_cast<std::uint64_t>(static_cast<std::int64_t>(first)) * 0x9E3779B97F4A7C15u;
      const Eigen::Vector3d at_first = from + first * view.steps.col(along);
      Eigen::Vector3f at = at_first.cast<float>();
      // exp(-z^2 / 2) in equal steps of z: each factor is the last one times a constant.
      auto weight = static_cast<float>(std::exp(-0.5 * at_first.z() * at_first.z()));
      auto factor = static_cast<float>(std::exp(-at_first.z() * rise - 0.5 * rise * rise));
      const auto bend = static_cast<float>(std::exp(-rise * rise));
      for (auto left = static_cast<int>(std::floor(line.high) - first); left >= 0; --left) {
        std::uint64_t mixed = (number ^ (number >> 32)) * 0xD6E8FEB86659FD93u;
        mixed ^= mixed >> 32;
        const cv::Vec2f value = weight * table[(mixed * 0xD6E8FEB86659FD93u) >> (64 - kTableBits)];
        const Spline x(at.x());
        const Spline y(at.y());
        for (int row = 0; row < 3; ++row) {
          float* to = samples.ptr<float>(y.nearest - 1 + row) + 2 * (x.nearest - 1);
          const float real = y.weight[static_cast<std::size_t>(row)] * value[0];
          const float imaginary = y.weight[static_cast<std::size_t>(row)] * value[1];
          for (std::size_t k = 0; k < 3; ++k) {
            to[2 * k] += x.weight[k] * real;
            to[2 * k + 1] += x.weight[k] * imaginary;
          }
        }
        number += 0x9E3779B97F4A7C15u;
        at += step;
        weight *= factor;
        factor *= bend;
      }
    }
  }
}

/// Lengths of complex samples, interpolated at the image's pixels: `scale` samples for each, the first at kMargin.
cv::Mat lengths_at_pixels(const cv::Mat& samples, cv::Size size, const Eigen::Vector2d& scale, float gain) {
  cv::Mat result(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y) {
    const double at_y = kMargin + y * scale.y();
    const int upper = static_cast<int>(at_y);
    const auto below = static_cast<float>(at_y - upper);
    const auto* first = samples.ptr<cv::Vec2f>(upper);
    const auto* second = samples.ptr<cv::Vec2f>(upper + 1);
    auto* to = result.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) {
      const double at_x = kMargin + x * scale.x();
      const int left = static_cast<int>(at_x);
      const auto beyond = static_cast<float>(at_x - left);
      float parts[2];
      for (int part = 0; part < 2; ++part) {
        const float top = first[left][part] + beyond * (first[left + 1][part] - first[left][part]);
        const float bottom = second[left][part] + beyond * (second[left + 1][part] - second[left][part]);
        parts[part] = top + below * (bottom - top);
      }
      to[x] = gain * std::sqrt(parts[0] * parts[0] + parts[1] * parts[1]);
    }
  }
  return result;
}

}  // namespace

SpeckleField::SpeckleField(const SpeckleOptions& options) : options_(options) {
  options.check();
  noise_ = std::make_shared<const std::vector<cv::Vec2f>>(noise_table(options.seed));
}

cv::Mat SpeckleField::amplitude(const Eigen::Affine3d& phantom_from_image, cv::Size size) const {
  const Eigen::Vector3d sigma_mm =
      Eigen::Vector3d(options_.lateral_mm, options_.axial_mm, options_.elevation_mm) / kWidthOfSigma;
  const double lattice_mm = kLatticeOfSigma * sigma_mm.minCoeff();
  const double sample_mm = kGridOfSigma * sigma_mm.head<2>().minCoeff();
  const Eigen::Vector3d right = phantom_from_image.linear().col(0);
  const Eigen::Vector3d down = phantom_from_image.linear().col(1);
  const Eigen::Vector2d scale = Eigen::Vector2d(right.norm(), down.norm()) / sample_mm;  // samples for each pixel

  // From the phantom's millimetres to samples and standard deviations off the plane.
  Eigen::Matrix3d samples_from_phantom;
  samples_from_phantom.row(0) = right.normalized().transpose() / sample_mm;
  samples_from_phantom.row(1) = down.normalized().transpose() / sample_mm;
  samples_from_phantom.row(2) = right.cross(down).normalized().transpose() / sigma_mm.z();
  LatticeView view;
  view.size = {static_cast<int>(std::ceil((size.width - 1) * scale.x())) + 2 + 2 * kMargin,
               static_cast<int>(std::ceil((size.height - 1) * scale.y())) + 2 + 2 * kMargin};
  view.start = Eigen::Vector3d(kMargin, kMargin, 0.0) - samples_from_phantom * phantom_from_image.translation();
  view.steps = lattice_mm * samples_from_phantom;
  cv::Mat samples(view.size, CV_32FC2, cv::Scalar(0, 0));
  collect(view, options_.seed, *noise_, samples);

  const Eigen::Vector2d sigma = sigma_mm.head<2>() / sample_mm;
  const auto kernel = [](double whole) {
    return gaussian_kernel(std::sqrt(std::max(0.04, whole * whole - kSplineVariance - kLinearVariance)));
  };
  cv::sepFilter2D(samples, samples, CV_32F, kernel(sigma.x()), kernel(sigma.y()), cv::Point(-1, -1), 0.0,
                  cv::BORDER_REFLECT);
  // Noise of mean square 1 and so many points in a mm^3, under a Gaussian of sum 1 in the samples and of height 1
  // across the plane: the integrals of their squares.
  constexpr double kPi = 3.14159265358979323846;
  const double in_plane = 1.0 / (4.0 * kPi * sigma.x() * sigma.y());
  const double density = sample_mm * sample_mm / std::pow(lattice_mm, 3);
  const double power = density * std::sqrt(kPi) * sigma_mm.z() * in_plane;
  return lengths_at_pixels(samples, size, scale, static_cast<float>(1.0 / std::sqrt(power)));
}

}  // namespace fathom
