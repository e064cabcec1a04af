#include "measurement/calibration_spread.h"

#include <algorithm>
#include <cmath>

#include "measurement/cross_section.h"
#include "measurement/planimetry.h"
#include "registration/spatial_calibration_model.h"

namespace fathom {

namespace {

// Of a standard deviation: far enough from rounding, near enough for a straight line.
constexpr double kStep = 0.5;

Calibration moved(const Calibration& calibration, int parameter, double change) {
  SpatialVector changes = SpatialVector::Zero();
  changes[parameter] = change;
  const Eigen::Affine3d& map = calibration.probe_from_image;
  const SpatialState state = state_of(map.linear().leftCols<2>(), map.translation(), true).moved(changes);
  Calibration result = calibration;
  result.probe_from_image = state.probe_from_image();
  result.latency_s += state.latency_s;
  return result;
}

}  // namespace

std::optional<double> calibration_spread_ml(const Structure& structure, const Recording& recording,
                                            const Calibration& calibration, const FrameNames& names,
                                            const Progress& progress) {
  const auto volume_ml = [&](const Calibration& with) {
    return measure_planimetry(cross_sections(structure, FrameLocator(recording, with, names), nullptr))
        .volumes.quadric_ml;
  };
  return calibration_spread_ml(calibration, volume_ml, progress);
}

std::optional<double> calibration_spread_ml(const Calibration& calibration,
                                            const std::function<std::optional<double>(const Calibration&)>& volume_ml,
                                            const Progress& progress) {
  const Eigen::Index size = calibration.covariance.rows();
  if (size == 0 || !volume_ml(calibration)) return std::nullopt;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    report(progress, static_cast<double>(i) / static_cast<double>(size));
    const auto name = std::find(kSpatialParameterNames.begin(), kSpatialParameterNames.begin() + kLatency + 1,
                                calibration.parameters[static_cast<std::size_t>(i)]);
    const double step = kStep * std::sqrt(std::max(0.0, calibration.covariance(i, i)));
    if (name == kSpatialParameterNames.begin() + kLatency + 1 || !(step > 0.0)) continue;
    const int parameter = static_cast<int>(name - kSpatialParameterNames.begin());
    const auto above = volume_ml(moved(calibration, parameter, step));
    const auto below = volume_ml(moved(calibration, parameter, -step));
    if (above && below) gradient[i] = (*above - *below) / (2.0 * step);
  }
  return std::sqrt(std::max(0.0, gradient.dot(calibration.covariance * gradient)));
}

}  // namespace fathom
