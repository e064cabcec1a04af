#include "sim/speckle.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/error.h"

namespace fathom {

namespace {

constexpr double kWidthOfSigma = 2.354820045;  // full width at half height of a Gaussian

void require(const char* what, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw Error(std::string("speckle: the ") + what + " must be from " + std::to_string(low) + " to " +
              std::to_string(high));
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
