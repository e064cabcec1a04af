#include "sim/target_echo.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fathom {

namespace {

constexpr double kWidthOfSigma = 2.354820045;  // full width at half height of a Gaussian
constexpr double kReach = 4.0;                 // standard deviations, where an echo is 70 dB down
constexpr double kWireLobe_rad = 0.5;          // a wire turned so far along the beam returns 1/e
constexpr double kFloorLobe_rad = 0.7;         // the same for a floor, which is rougher
constexpr double kTail_db = -20.0;             // of the floor's ringing below its line
constexpr double kTail_mm = 1.5;               // over which it falls to 1/e
constexpr double kPlate_mm = 4.0;              // the floor's plate: one reverberation each
constexpr std::array kReverberation_db = {-14.0, -26.0};
constexpr double kRoughness = 0.25;  // share of the floor's echo that is speckle

double level(double db) { return std::pow(10.0, db / 20.0); }

/// Variances of the response to a point where the beam runs along `beam`, in image axes.
Eigen::Matrix3d response(const SpeckleOptions& options, const Eigen::Vector2d& beam) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  axes.col(0).head<2>() = Eigen::Vector2d(beam.y(), -beam.x());
  axes.col(1).head<2>() = beam;
  const Eigen::Vector3d sigma =
      Eigen::Vector3d(options.lateral_mm, options.axial_mm, options.elevation_mm) / kWidthOfSigma;
  return axes * sigma.cwiseAbs2().asDiagonal() * axes.transpose();
}

/// Adds peak * exp(-q^T form q / 2) about `middle_mm`, q in the image.
void add_blob(cv::Mat& amplitude, const TargetView& view, const Eigen::Vector2d& middle_mm, const Eigen::Matrix2d& form,
              double peak) {
  const Eigen::Matrix2d spread = form.inverse();
  const Eigen::Vector2d reach = kReach * spread.diagonal().cwiseSqrt();
  const Eigen::Vector2d low = (middle_mm - reach).cwiseQuotient(view.pixel_mm);
  const Eigen::Vector2d high = (middle_mm + reach).cwiseQuotient(view.pixel_mm);
  const auto bounded = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  const int end_x = bounded(std::floor(high.x()) + 1.0, amplitude.cols);
  const int end_y = bounded(std::floor(high.y()) + 1.0, amplitude.rows);
  for (int y = bounded(std::ceil(low.y()), amplitude.rows); y < end_y; ++y) {
    auto* row = amplitude.ptr<float>(y);
    for (int x = bounded(std::ceil(low.x()), amplitude.cols); x < end_x; ++x) {
      const Eigen::Vector2d q = Eigen::Vector2d(x, y).cwiseProduct(view.pixel_mm) - middle_mm;
      row[x] += static_cast<float>(peak * std::exp(-0.5 * q.dot(form * q)));
    }
  }
}

}  // namespace

Eigen::Vector2d beam_at(const TargetView& view, const Eigen::Vector2d& x_mm) {
  if (!view.fan) return Eigen::Vector2d::UnitY();
  const Eigen::Vector2d apex_mm =
      Eigen::Vector2d((view.size.width - 1) / 2.0, -view.fan->apex_px).cwiseProduct(view.pixel_mm);
  return (x_mm - apex_mm).normalized();
}

bool shows(const TargetView& view, const Eigen::Vector2d& x_px, double margin_px) {
  const Eigen::Vector2d last(view.size.width - 1, view.size.height - 1);
  if ((x_px.array() < margin_px).any() || ((last - x_px).array() < margin_px).any()) return false;
  if (!view.fan) return true;
  const Eigen::Vector2d from_apex = x_px - Eigen::Vector2d(last.x() / 2.0, -view.fan->apex_px);
  const double inside = std::tan(view.fan->half_angle_rad) * from_apex.y() - std::abs(from_apex.x());
  return inside * std::cos(view.fan->half_angle_rad) >= margin_px && from_apex.norm() >= view.fan->face_px + margin_px;
}

void add_wire_echo(cv::Mat& amplitude, const TargetView& view, const Eigen::Vector2d& cut_mm,
                   const Eigen::Vector3d& along) {
  const Eigen::Vector2d beam = beam_at(view, cut_mm);
  const Eigen::Matrix3d form = response(view.beam, beam).inverse();
  // The integral of exp(-(q + s along)^T form (q + s along) / 2) over s is Gaussian in q.
  const Eigen::Vector3d pull = form * along;
  const Eigen::Matrix3d left = form - pull * pull.transpose() / along.dot(pull);
  const double turned = std::asin(std::clamp(along.head<2>().dot(beam), -1.0, 1.0)) / kWireLobe_rad;
  add_blob(amplitude, view, cut_mm, left.topLeftCorner<2, 2>(), level(kWire_db) * std::exp(-turned * turned));
}

void add_point_echo(cv::Mat& amplitude, const TargetView& view, const Eigen::Vector3d& place_mm) {
  const Eigen::Vector2d middle = place_mm.head<2>();
  const Eigen::Matrix3d form = response(view.beam, beam_at(view, middle)).inverse();
  const double peak = level(kPoint_db) * std::exp(-0.5 * form(2, 2) * place_mm.z() * place_mm.z());
  add_blob(amplitude, view, middle, form.topLeftCorner<2, 2>(), peak);
}

void add_floor_echo(cv::Mat& amplitude, const TargetView& view, const Eigen::Vector3d& up, double offset_mm,
                    const cv::Mat& texture) {
  const Eigen::Matrix3d straight = response(view.beam, Eigen::Vector2d::UnitY());
  for (int y = 0; y < amplitude.rows; ++y) {
    auto* row = amplitude.ptr<float>(y);
    const auto* rough = texture.ptr<float>(y);
    for (int x = 0; x < amplitude.cols; ++x) {
      const Eigen::Vector2d place = Eigen::Vector2d(x, y).cwiseProduct(view.pixel_mm);
      const double height = up.head<2>().dot(place) - offset_mm;
      // No tail is heard from so far below, and no line so far above.
      if (height > kReach * view.beam.elevation_mm || height < -6.0 * kPlate_mm) continue;
      const Eigen::Vector2d beam = beam_at(view, place);
      const double variance = up.dot((view.fan ? response(view.beam, beam) : straight) * up);
      const double turned = std::acos(std::clamp(-up.head<2>().dot(beam), -1.0, 1.0)) / kFloorLobe_rad;
      const auto ridge = [&](double at_mm) { return std::exp(-0.5 * (height - at_mm) * (height - at_mm) / variance); };
      double echo = ridge(0.0);
      for (std::size_t i = 0; i < kReverberation_db.size(); ++i) {
        echo += level(kReverberation_db[i]) * ridge(-kPlate_mm * static_cast<double>(i + 1));
      }
      const double begun = 0.5 * std::erfc(height / std::sqrt(2.0 * variance));
      echo += level(kTail_db) * begun * std::exp(std::min(height, 0.0) / kTail_mm);
      echo *= level(kFloor_db) * std::exp(-turned * turned);
      row[x] += static_cast<float>(echo * (1.0 - kRoughness + kRoughness * static_cast<double>(rough[x])));
    }
  }
}

}  // namespace fathom
