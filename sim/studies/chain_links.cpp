#include "sim/studies/chain_links.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "core/random.h"
#include "measurement/calibration_spread.h"
#include "measurement/cross_section.h"
#include "measurement/planimetry.h"
#include "measurement/volume_interval.h"
#include "registration/spatial_calibration.h"
#include "segmentation/outline_loops.h"
#include "segmentation/outline_topology.h"
#include "sim/simulate.h"

namespace fathom {

namespace {

constexpr int kPhantomFrames = 250;  // ten seconds
constexpr int kPhantomStep = 4;
constexpr int kOrganFrames = 150;  // six seconds

SimulateOptions scan_options(const ChainScan& scan, double latency_s, double noise_mm, std::uint64_t seed) {
  SimulateOptions options;
  options.object = scan.object;
  options.pattern = scan.pattern;
  options.frames = kOrganFrames;
  options.latency_s = latency_s;
  options.noise_mm = noise_mm;
  options.noise_deg = kTurnOfNoise_deg_per_mm * noise_mm;
  options.seed = seed;
  return options;
}

/// The outlines of `count` frames, evenly from the first to the last that has any and whose pose is known: of the last
/// frames the tracker's late poses are not in the recording any more. Nor may they be beside the last that is known,
/// where a latency that is a little off would lose them.
Structure some_of(const Structure& all, const FrameLocator& locator, int count) {
  std::set<int> frames;
  for (const Contour& contour : all.contours) {
    const bool known = contour.frame > 0 && contour.frame + 1 < locator.frame_count() &&
                       locator.reference_from_image(contour.frame - 1) &&
                       locator.reference_from_image(contour.frame + 1);
    if (known) frames.insert(contour.frame);
  }
  const std::vector<int> shown(frames.begin(), frames.end());
  std::set<int> chosen;
  for (int i = 0; i < count; ++i) {
    const double at = static_cast<double>(i) / (count - 1) * static_cast<double>(shown.size() - 1);
    chosen.insert(shown[static_cast<std::size_t>(std::lround(at))]);
  }
  Structure some = all;
  std::erase_if(some.contours, [&](const Contour& contour) { return !chosen.contains(contour.frame); });
  some.extremities.clear();
  some.absent.clear();
  return some;
}

/// The outline made larger as if moved outwards by `out_px` everywhere: to the area that a moved one has, in its own
/// shape, so that it does not cross itself.
Polygon grown(const Polygon& outline, double out_px) {
  constexpr double kLeastShare = 0.1;  // of the area: nobody outlines nothing
  const double area = std::abs(signed_area(outline));
  double perimeter = 0.0;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    perimeter += (outline[(i + 1) % outline.size()] - outline[i]).norm();
    middle += outline[i] / static_cast<double>(outline.size());
  }
  const double moved = area + out_px * perimeter + std::numbers::pi * out_px * out_px;
  const double scale = std::sqrt(std::max(kLeastShare, moved / area));
  Polygon larger;
  for (const Eigen::Vector2d& point : outline) larger.push_back(middle + scale * (point - middle));
  return larger;
}

/// As a person draws who is off by a little on every section, the same all around it.
Structure drawn(const Structure& truth, double scatter_px, std::uint64_t seed) {
  Random random(seed);
  std::map<int, double> off_px;
  Structure result = truth;
  for (Contour& contour : result.contours) {
    const auto [entry, first] = off_px.try_emplace(contour.frame, 0.0);
    if (first) entry->second = scatter_px * random.normal();
    contour.points_px = grown(contour.points_px, entry->second);
  }
  return result;
}

/// Points set on whole pixels, but for outlines that are so small that they would cross themselves.
Structure on_pixels(const Structure& structure) {
  Structure result = structure;
  for (Contour& contour : result.contours) {
    Polygon rounded = contour.points_px;
    for (Eigen::Vector2d& point : rounded) point = point.array().round().matrix();
    rounded = without_repeats(rounded);
    if (rounded.size() >= 3 && !outline_fault(std::span(&std::as_const(rounded), 1)))
      contour.points_px = std::move(rounded);
  }
  return result;
}

double quadric_ml(const Structure& outlines, const Recording& recording, const Calibration& calibration) {
  const FrameLocator locator(recording, calibration);
  const auto volumes = measure_planimetry(cross_sections(outlines, locator, nullptr)).volumes;
  return volumes.quadric_ml.value_or(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

MeasuringSystem::MeasuringSystem(const ChainErrors& errors, std::uint64_t seed) : errors_(errors) {
  TargetScanOptions scan = target_scan_of("wires", kPhantomFrames, seed);
  scan.latency_s = errors.latency_s;
  const SeenTarget seen = errors.drawn_px ? SeenTarget::drawn(scan, *errors.drawn_px, seed + 2)
                                          : SeenTarget::found_in_images(scan, kPhantomStep);
  ScanFitOptions fitting;
  fitting.try_skew = false;
  truth_ = seen.truth();
  found_ = calibration_of(seen.fitted(errors.tracker_mm, seed + 1, fitting));
  point_mm_ = point_error_mm(truth_, found_.probe_from_image);
  latency_error_s_ = found_.latency_s - truth_.latency_s;
}

Calibration MeasuringSystem::carried_to(const Calibration& truth) const {
  Calibration carried = truth;
  const Eigen::Affine3d error = found_.probe_from_image * truth_.probe_from_image.inverse();
  carried.probe_from_image = error * truth.probe_from_image;
  carried.latency_s = found_.latency_s;
  carried.parameters = found_.parameters;
  // Translations are those of the image's first pixel, and this image's lies elsewhere in the other one: there a turn
  // and a stretch move it too. The axes of both images are parallel.
  const Eigen::Affine3d other_from_this = truth_.probe_from_image.inverse() * truth.probe_from_image;
  const Eigen::Matrix3d linear = truth_.probe_from_image.linear();
  const Eigen::Vector3d scale = linear.colwise().norm().transpose();
  const Eigen::Vector3d lever_mm = scale.cwiseProduct(other_from_this.translation());  // in the image's axes
  const Eigen::Matrix3d axes = linear * scale.cwiseInverse().asDiagonal();
  const auto place = [&](const char* name) {
    const auto at = std::find(found_.parameters.begin(), found_.parameters.end(), name);
    return static_cast<Eigen::Index>(at - found_.parameters.begin());
  };
  const Eigen::Index size = found_.covariance.rows();
  Eigen::MatrixXd map = Eigen::MatrixXd::Identity(size, size);
  const Eigen::Index t = place("tx_mm");
  const Eigen::Index r = place("rx_rad");
  for (Eigen::Index i = 0; i < 3; ++i) {
    map.block<3, 1>(t, r + i) = axes * Eigen::Vector3d::Unit(i).cross(lever_mm);
  }
  map.block<3, 1>(t, place("log_sx")) = axes.col(0) * lever_mm.x();
  map.block<3, 1>(t, place("log_sy")) = axes.col(1) * lever_mm.y();
  carried.covariance = map * found_.covariance * map.transpose();
  return carried;
}

ChainVolumes MeasuringSystem::measure(const ChainScan& of, int sections, std::uint64_t seed) const {
  const SimulatedScan exact = simulate(scan_options(of, errors_.latency_s, 0.0, seed));
  const SimulatedScan noisy = simulate(scan_options(of, errors_.latency_s, errors_.tracker_mm, seed));
  const Structure truth = some_of(exact.outlines.front(), FrameLocator(*exact.recording, exact.calibration), sections);
  const double pixel_mm = exact.calibration.probe_from_image.linear().col(0).norm();
  const Structure outlined = drawn(truth, errors_.outline_mm / pixel_mm, seed + 1);
  const Calibration found = carried_to(exact.calibration);
  Calibration only_turned = found;
  only_turned.latency_s = exact.calibration.latency_s;
  Calibration only_late = exact.calibration;
  only_late.latency_s = found.latency_s;

  ChainVolumes volumes;
  volumes.true_ml = exact.truth.structures.front().volume_ml;
  const auto set = [&](ChainLink link, const Structure& outlines, const SimulatedScan& scan, const Calibration& by) {
    volumes.link_ml[static_cast<std::size_t>(link)] = quadric_ml(outlines, *scan.recording, by);
  };
  set(ChainLink::kSections, truth, exact, exact.calibration);
  set(ChainLink::kTracker, truth, noisy, exact.calibration);
  set(ChainLink::kCalibration, truth, exact, only_turned);
  set(ChainLink::kLatency, truth, exact, only_late);
  set(ChainLink::kOutlining, outlined, exact, exact.calibration);
  set(ChainLink::kPixels, on_pixels(truth), exact, exact.calibration);

  volumes.all_but_outlining_ml = quadric_ml(on_pixels(truth), *noisy.recording, found);

  const Structure all = on_pixels(outlined);
  const FrameLocator locator(*noisy.recording, found);
  const std::vector<CrossSection> cut = cross_sections(all, locator, nullptr);
  const auto measured = measure_planimetry(cut).volumes;
  const double none = std::numeric_limits<double>::quiet_NaN();
  volumes.all_ml = measured.quadric_ml.value_or(none);
  volumes.all_cubic_ml = measured.cubic_ml.value_or(none);
  const MeasurementErrors known{errors_.outline_mm, errors_.tracker_mm, kTurnOfNoise_deg_per_mm * errors_.tracker_mm};
  const auto spread_ml = calibration_spread_ml(all, *noisy.recording, found, {});
  const auto interval = volume_interval(cut, section_places(all, cut, locator, found), known, spread_ml.value_or(0.0));
  volumes.low_ml = interval ? interval->low_ml : none;
  volumes.high_ml = interval ? interval->high_ml : none;
  return volumes;
}

}  // namespace fathom
