#include "registration/wire_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/error.h"
#include "core/numbers.h"
#include "registration/calibration_start.h"
#include "registration/usable_sweep.h"

namespace fathom {

namespace {

// Points of one pattern in one frame, by wire.
using Triple = std::array<const WirePoint*, 3>;

std::map<std::pair<int, std::size_t>, Triple> triples_of(const std::vector<WirePoint>& points) {
  std::map<std::pair<int, std::size_t>, Triple> triples;
  for (const WirePoint& point : points) triples[{point.frame, point.pattern}].at(point.wire) = &point;
  return triples;
}

// Where the image cuts the middle wire. The lines cut by an image plane from the outer wires and the middle one have
// the same ratio across the pattern, in the image and in space.
std::optional<Eigen::Vector3d> middle_point(const NPattern& pattern, const Triple& triple) {
  if (!triple[0] || !triple[1] || !triple[2]) return std::nullopt;
  const double width = (triple[2]->position_px - triple[0]->position_px).norm();
  if (width <= 0.0) return std::nullopt;
  const double ratio = (triple[1]->position_px - triple[0]->position_px).norm() / width;
  const Eigen::Vector3d along = (pattern[0].back - pattern[0].front).normalized();
  const Eigen::Vector3d apart = pattern[2].front - pattern[0].front;
  const Eigen::Vector3d sideways = apart - along * along.dot(apart);
  const auto share = [&](const Eigen::Vector3d& p) {
    return sideways.dot(p - pattern[0].front) / sideways.squaredNorm();
  };
  const double front = share(pattern[1].front);
  const double back = share(pattern[1].back);
  return pattern[1].front + (ratio - front) / (back - front) * (pattern[1].back - pattern[1].front);
}

Eigen::Vector3d direction_of(const Wire& wire) { return (wire.back - wire.front).normalized(); }

// The phantom as a mirror shows it: no rotation makes one of the other.
WirePhantom mirrored(WirePhantom phantom) {
  for (NPattern& pattern : phantom.patterns) {
    for (Wire& wire : pattern) {
      wire.front.y() = -wire.front.y();
      wire.back.y() = -wire.back.y();
    }
  }
  return phantom;
}

// A wrong phantom may differ in one wire of each N only, whose points would be left out as outliers.
void require_every_wire(const ProbePoses& poses, const std::vector<WirePoint>& points, const SpatialFit& fit) {
  struct Share {
    int used = 0;
    int all = 0;
  };
  std::map<std::pair<std::size_t, std::size_t>, Share> wires;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto at = poses.at(points[i].frame, fit.state.latency_s);
    if (!at || !at->inside) continue;
    Share& share = wires[{points[i].pattern, points[i].wire}];
    ++share.all;
    share.used += fit.used[i] ? 1 : 0;
  }
  for (const auto& [wire, share] : wires) {
    if (2 * share.used >= share.all) continue;
    throw Error(poses.recording() + ": the wires seen do not fit the phantom (most points of wire " +
                std::to_string(wire.second + 1) + " of N number " + std::to_string(wire.first + 1) +
                " are not where they belong); check that the phantom's file is that of the phantom scanned");
  }
}

// `start_count`: of starts to fit from where the phantom's place is not known.
SpatialFit fit_wires(const ProbePoses& poses, const std::vector<WirePoint>& points, const WirePhantom& phantom,
                     const WireCalibrationOptions& options, std::size_t start_count = 8) {
  SpatialOptions spatial = options.spatial;
  const auto observations = wire_observations(points, phantom, options);
  std::vector<SpatialState> starts;
  if (phantom.reference_from_phantom) {
    const auto all = starts_with_known_phantom(poses, observations, *phantom.reference_from_phantom,
                                               latencies_to_try(poses, spatial), spatial.seed);
    constexpr std::size_t kBest = 2;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i < kBest || all[i].latency_s == 0.0) starts.push_back(all[i]);
    }
  } else {
    for (int i = kPhantomTx; i <= kPhantomRz; ++i) spatial.phantom[static_cast<std::size_t>(i)] = true;
    StartSearch search;
    search.phantom_from_reference = all_turns();
    search.count = start_count;
    starts = starts_with_unknown_phantom(poses, observations, search);
  }
  SpatialFit fit = calibrate_spatial(poses, observations, starts, spatial);
  require_agreement(poses, fit, spatial);
  require_every_wire(poses, points, fit);
  return fit;
}

bool fits(const ProbePoses& poses, const std::vector<WirePoint>& points, const WirePhantom& phantom,
          WireCalibrationOptions options) {
  options.spatial.try_latency = options.spatial.try_skew = false;
  options.spatial.max_point_sd_mm = std::numeric_limits<double>::infinity();  // where it fits is not asked
  try {
    constexpr std::size_t kStarts = 3;  // the answer only words a message
    fit_wires(poses, points, phantom, options, kStarts);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

void WireCalibrationOptions::check() const {
  spatial.check();
  if (!(along_weight >= 0.0 && along_weight <= 10.0)) throw Error("the weight along the middle wire must be 0 to 10");
}

std::vector<SpatialObservation> wire_observations(const std::vector<WirePoint>& points, const WirePhantom& phantom,
                                                  const WireCalibrationOptions& options) {
  const auto triples = triples_of(points);
  std::vector<SpatialObservation> observations;
  for (const WirePoint& point : points) {
    const NPattern& pattern = phantom.patterns.at(point.pattern);
    const Wire& wire = pattern.at(point.wire);
    const Eigen::Vector3d along = direction_of(wire);
    const Eigen::Vector3d across = along.unitOrthogonal();
    SpatialObservation observation;
    observation.frame = point.frame;
    observation.position_px = point.position_px;
    observation.rows.row(0) = across;
    observation.rows.row(1) = along.cross(across);
    observation.row_count = 2;
    observation.origin_mm = wire.front;
    if (point.wire == 1 && options.along_weight > 0.0) {
      if (const auto middle = middle_point(pattern, triples.at({point.frame, point.pattern}))) {
        observation.origin_mm = *middle;
        observation.rows.row(2) = options.along_weight * along;
        observation.row_count = 3;
      }
    }
    observations.push_back(observation);
  }
  return observations;
}

SpatialFit calibrate_with_wires(const ProbePoses& poses, const std::vector<WirePoint>& points,
                                const WirePhantom& phantom, const WireCalibrationOptions& options) {
  options.check();
  require_usable_sweep(poses, wire_observations(points, phantom, options), options.spatial);
  try {
    return fit_wires(poses, points, phantom, options);
  } catch (const Error&) {
    if (fits(poses, points, phantom, options)) throw;  // it is the motion that is poor
    WirePhantom anywhere = phantom;
    anywhere.reference_from_phantom.reset();
    // A probe that hardly turns may see either.
    const bool elsewhere = phantom.reference_from_phantom && fits(poses, points, anywhere, options);
    const bool mirror = fits(poses, points, mirrored(anywhere), options);
    if (!elsewhere && !mirror) throw;
    const std::string fitting =
        poses.recording() + ": the wires seen fit " +
        (elsewhere ? "the phantom, but not in the place that its file states" : "the mirror image of the phantom");
    throw Error(
        fitting + (elsewhere && mirror ? ", or its mirror image" : "") + "; " +
        (elsewhere ? "register it again, or have its place estimated" : "") + (elsewhere && mirror ? ", and " : "") +
        (mirror ? "check which ends of its middle wires are in front, and that its axes are right-handed" : ""));
  }
}

WireErrors wire_errors(const ProbePoses& poses, const std::vector<WirePoint>& points, const WirePhantom& phantom,
                       const SpatialState& state) {
  const auto triples = triples_of(points);
  const Eigen::Affine3d probe_from_image = state.probe_from_image();
  const Eigen::Isometry3d phantom_from_reference = state.reference_from_phantom.inverse();
  std::vector<double> middles;
  std::vector<double> lines;
  std::map<int, int> frames;
  for (const WirePoint& point : points) {
    const auto at = poses.at(point.frame, state.latency_s);
    if (!at || !at->inside) continue;
    ++frames[point.frame];
    const NPattern& pattern = phantom.patterns.at(point.pattern);
    const Eigen::Vector3d place =
        phantom_from_reference *
        (at->reference_from_probe *
         (probe_from_image * Eigen::Vector3d(point.position_px.x(), point.position_px.y(), 0.0)));
    const Wire& wire = pattern.at(point.wire);
    lines.push_back((place - wire.front).cross(direction_of(wire)).norm());
    if (point.wire != 1) continue;
    if (const auto middle = middle_point(pattern, triples.at({point.frame, point.pattern}))) {
      middles.push_back((place - *middle).norm());
    }
  }
  if (middles.empty()) {
    throw Error(poses.recording() + ": no frame has both a pose and all three wires of a pattern; record again");
  }
  WireErrors errors;
  static_cast<TargetErrors&>(errors) = target_errors(std::move(middles), static_cast<int>(frames.size()));
  errors.wire_mean_mm = mean_of(lines);
  errors.wire_rms_mm = rms_of(lines);
  return errors;
}

}  // namespace fathom
