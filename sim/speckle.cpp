#include "sim/speckle.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/random.h"

namespace fathom {

namespace {

constexpr double kWidthOfSigma = 2.354820045;  // full width at half height of a Gaussian
constexpr int kLatticeBits = 7;                // 128 points each way
constexpr int kLatticeSize = 1 << kLatticeBits;
constexpr int kLatticeMask = kLatticeSize - 1;
constexpr double kLatticeOfSigma = 0.7;          // of the smallest resolution: finer changes no statistics, only time
constexpr double kElevationReach = 2.5;          // standard deviations of the response across the image
constexpr double kElevationStep = 0.5;           // the same; finer than the texture can change
constexpr double kNearestVariance = 1.0 / 12.0;  // of a lattice cell, in cells: what taking the nearest point blurs by
constexpr double kLinearVariance = 1.0 / 6.0;    // what interpolating between points blurs by

void require(const char* what, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw Error(std::string("speckle: the ") + what + " must be from " + std::to_string(low) + " to " +
              std::to_string(high));
}

cv::Mat gaussian_kernel(double sigma) {
  const int reach = std::max(1, static_cast<int>(std::ceil(3.0 * sigma)));
  cv::Mat kernel(1, 2 * reach + 1, CV_32FC1);
  double squares = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    const double weight = std::exp(-0.5 * i * i / (sigma * sigma));
    kernel.at<float>(0, i + reach) = static_cast<float>(weight);
    squares += weight * weight;
  }
  return kernel / std::sqrt(squares);  // white noise keeps its variance
}

/// Correlation, at an offset of one step, of white noise averaged by a Gaussian of `sigma` steps.
double neighbour_correlation(double sigma) { return std::exp(-0.25 / (sigma * sigma)); }

/// Mean square of linear interpolation between values of mean square 1 that correlate so at one step.
double interpolation_power(double sigma) { return (2.0 + neighbour_correlation(sigma)) / 3.0; }

/// Chance that two places share their nearest lattice point; `offset` in lattice steps.
double same_point(const Eigen::Vector3d& offset) {
  return (Eigen::Vector3d::Ones() - offset.cwiseAbs()).cwiseMax(0.0).prod();
}

float decibels(double db) { return static_cast<float>(std::pow(10.0, db / 20.0)); }

}  // namespace

void SpeckleOptions::check() const {
  require("lateral resolution", lateral_mm, 0.05, 20.0);
  require("axial resolution", axial_mm, 0.05, 20.0);
  require("elevation resolution", elevation_mm, 0.05, 20.0);
  require("dynamic range", dynamic_range_db, 10.0, 200.0);
  require("level of tissue", tissue_db, -200.0, 0.0);
  require("level of the structure", structure_db, -200.0, 100.0);
  require("level of boundaries", boundary_db, -200.0, 100.0);
  require("attenuation", attenuation_db_per_mm, 0.0, 10.0);
}

SpeckleField::SpeckleField(const SpeckleOptions& options) : options_(options) {
  options.check();
  const double smallest = std::min({options.lateral_mm, options.axial_mm, options.elevation_mm});
  lattice_mm_ = kLatticeOfSigma * smallest / kWidthOfSigma;
  cv::Mat lattice(kLatticeSize * kLatticeSize, kLatticeSize, CV_32FC2);
  Random random(options.seed);
  constexpr double kPart = 0.70710678118654752;  // real and imaginary parts share a variance of 1
  for (int row = 0; row < lattice.rows; ++row) {
    auto* values = lattice.ptr<cv::Vec2f>(row);
    for (int i = 0; i < lattice.cols; ++i) {
      values[i][0] = static_cast<float>(kPart * random.normal());
      values[i][1] = static_cast<float>(kPart * random.normal());
    }
  }
  lattice_ = std::make_shared<const cv::Mat>(std::move(lattice));
}

cv::Mat SpeckleField::amplitude(const Eigen::Affine3d& phantom_from_image, cv::Size size) const {
  const Eigen::Vector3d right = phantom_from_image.linear().col(0);
  const Eigen::Vector3d down = phantom_from_image.linear().col(1);
  const Eigen::Vector3d across = right.cross(down).normalized();
  const double step = lattice_mm_;
  const double x_scale = right.norm() / step;  // samples for each pixel
  const double y_scale = down.norm() / step;
  const int columns = static_cast<int>(std::ceil((size.width - 1) * x_scale)) + 2;
  const int rows = static_cast<int>(std::ceil((size.height - 1) * y_scale)) + 2;
  const double sigma_across = options_.elevation_mm / kWidthOfSigma;
  const auto in_plane_sigma = [&](double width_mm) {
    const double sigma = width_mm / kWidthOfSigma / step;
    return std::sqrt(std::max(0.04, sigma * sigma - kNearestVariance - kLinearVariance));
  };
  const double sigma_x = in_plane_sigma(options_.lateral_mm);
  const double sigma_y = in_plane_sigma(options_.axial_mm);

  // The noise of the resolution cell's planes, taken together.
  const double plane_step = std::max(kElevationStep * sigma_across, step);
  const int planes = static_cast<int>(std::floor(kElevationReach * sigma_across / plane_step));
  cv::Mat noise(rows, columns, CV_32FC2, cv::Scalar(0, 0));
  std::vector<double> weights;
  // Fixed point, so that a step is an addition; exact at every thread count.
  constexpr int kFraction = 16;
  const auto fixed = [&](double mm) { return static_cast<std::int32_t>(std::llround(mm / step * (1 << kFraction))); };
  const Eigen::Vector3d right_unit = right.normalized() * step;
  const Eigen::Vector3d down_unit = down.normalized() * step;
  const std::int32_t dx = fixed(right_unit.x());
  const std::int32_t dy = fixed(right_unit.y());
  const std::int32_t dz = fixed(right_unit.z());
  const double period_mm = step * kLatticeSize;
  const cv::Vec2f* lattice = lattice_->ptr<cv::Vec2f>(0);
  for (int plane = -planes; plane <= planes; ++plane) {
    const double off = plane * plane_step;
    const auto weight = static_cast<float>(std::exp(-0.5 * off * off / (sigma_across * sigma_across)));
    weights.push_back(static_cast<double>(weight));
    for (int row = 0; row < rows; ++row) {
      Eigen::Vector3d start = phantom_from_image.translation() + off * across + row * down_unit;
      for (int axis = 0; axis < 3; ++axis) start[axis] -= period_mm * std::floor(start[axis] / period_mm);
      auto x = static_cast<std::uint32_t>(fixed(start.x() + step / 2.0));
      auto y = static_cast<std::uint32_t>(fixed(start.y() + step / 2.0));
      auto z = static_cast<std::uint32_t>(fixed(start.z() + step / 2.0));
      auto* to = noise.ptr<cv::Vec2f>(row);
      for (int column = 0; column < columns; ++column) {
        const std::uint32_t i = (x >> kFraction) & kLatticeMask;
        const std::uint32_t j = (y >> kFraction) & kLatticeMask;
        const std::uint32_t k = (z >> kFraction) & kLatticeMask;
        const cv::Vec2f& value = lattice[(((k << kLatticeBits) | j) << kLatticeBits) | i];
        to[column][0] += weight * value[0];
        to[column][1] += weight * value[1];
        x += static_cast<std::uint32_t>(dx);
        y += static_cast<std::uint32_t>(dy);
        z += static_cast<std::uint32_t>(dz);
      }
    }
  }
  cv::sepFilter2D(noise, noise, CV_32F, gaussian_kernel(sigma_x), gaussian_kernel(sigma_y), cv::Point(-1, -1), 0.0,
                  cv::BORDER_REFLECT);
  // Samples are a lattice step apart but turned against the lattice, so that neighbours may share a point.
  double power = 0.0;
  for (int k = -1; k <= 1; ++k) {
    double in_depth = 0.0;
    for (int i = -planes; i <= planes; ++i) {
      if (std::abs(i + k) > planes) continue;
      in_depth += weights[static_cast<std::size_t>(i + planes)] * weights[static_cast<std::size_t>(i + k + planes)];
    }
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const Eigen::Vector3d offset = (i * right_unit + j * down_unit + k * plane_step * across) / step;
        power += in_depth * std::pow(neighbour_correlation(sigma_x), i * i) *
                 std::pow(neighbour_correlation(sigma_y), j * j) * same_point(offset);
      }
    }
  }
  power *= interpolation_power(sigma_x) * interpolation_power(sigma_y);
  const auto gain = static_cast<float>(1.0 / std::sqrt(power));

  cv::Mat result(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y) {
    const double at_y = y * y_scale;
    const int upper = static_cast<int>(at_y);
    const auto below = static_cast<float>(at_y - upper);
    const auto* first = noise.ptr<cv::Vec2f>(upper);
    const auto* second = noise.ptr<cv::Vec2f>(upper + 1);
    auto* to = result.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) {
      const double at_x = x * x_scale;
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

cv::Mat log_compressed(const cv::Mat& amplitude, double dynamic_range_db) {
  cv::Mat logarithm;
  cv::max(amplitude, 1e-12, logarithm);
  cv::log(logarithm, logarithm);
  const double db_of_log = 20.0 / std::log(10.0);
  cv::Mat grey;
  logarithm.convertTo(grey, CV_8U, 255.0 * db_of_log / dynamic_range_db, 255.0);
  return grey;
}

cv::Mat speckled_image(const SpeckleField& field, const SpeckleOptions& options, const cv::Mat& inside,
                       const Eigen::Affine3d& phantom_from_image) {
  cv::Mat amplitude = field.amplitude(phantom_from_image, inside.size());
  const double x_mm = phantom_from_image.linear().col(0).norm();
  const double y_mm = phantom_from_image.linear().col(1).norm();

  // The change of echo along the beam, blurred by the resolution: bright where a boundary lies across the beam.
  cv::Mat share;
  inside.convertTo(share, CV_32F);
  cv::min(share, 1.0, share);
  const double sigma_x = options.lateral_mm / kWidthOfSigma / x_mm;
  const double sigma_y = options.axial_mm / kWidthOfSigma / y_mm;
  cv::Mat blurred;
  cv::GaussianBlur(share, blurred, cv::Size(0, 0), sigma_x, sigma_y, cv::BORDER_REPLICATE);
  cv::Mat along;
  cv::Sobel(blurred, along, CV_32F, 0, 1, 1, 0.5);
  cv::Mat sideways;
  cv::Sobel(blurred, sideways, CV_32F, 1, 0, 1, 0.5);

  const float inner = decibels(options.structure_db);
  const float edge = decibels(options.boundary_db);
  // A step seen through a Gaussian rises by 1 / (sigma sqrt(2 pi)) at most.
  const auto steepest = static_cast<float>(1.0 / (sigma_y * 2.5066282746));
  const auto aspect = static_cast<float>(y_mm / x_mm);
  for (int y = 0; y < amplitude.rows; ++y) {
    const float gain = decibels(options.tissue_db - options.attenuation_db_per_mm * y_mm * y);
    float* to = amplitude.ptr<float>(y);
    const float* part = blurred.ptr<float>(y);
    const float* down = along.ptr<float>(y);
    const float* right = sideways.ptr<float>(y);
    for (int x = 0; x < amplitude.cols; ++x) {
      float level = to[x] * (1.0F + (inner - 1.0F) * part[x]);
      const float slope = down[x] * down[x] + aspect * aspect * right[x] * right[x];
      if (slope > 1e-8F) {
        const float cosine_squared = down[x] * down[x] / slope;
        level += edge * cosine_squared * cosine_squared * std::abs(down[x]) / steepest;
      }
      to[x] = gain * level;
    }
  }
  return log_compressed(amplitude, options.dynamic_range_db);
}

void blacken_outside_fan(cv::Mat& image, double apex_px, double face_px, double half_angle_rad) {
  const double middle = (image.cols - 1) / 2.0;
  const double slope = std::tan(half_angle_rad);
  const auto pixel_bytes = image.elemSize();
  for (int y = 0; y < image.rows; ++y) {
    const double depth = y + apex_px;
    for (int x = 0; x < image.cols; ++x) {
      const double aside = x - middle;
      if (depth > 0.0 && std::abs(aside) <= slope * depth && std::hypot(aside, depth) >= face_px) continue;
      std::fill_n(image.ptr(y) + pixel_bytes * static_cast<std::size_t>(x), pixel_bytes, std::uint8_t{0});
    }
  }
}

}  // namespace fathom
