#include "registration/calibration_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include <Eigen/Cholesky>

#include "core/random.h"
#include "registration/spatial_calibration_model.h"

namespace fathom {

namespace {

// Unknown in the linear problem: x axis, y axis and origin of the image in the probe, and a shift in the phantom.
constexpr int kMap = 9;
constexpr int kMapAndShift = 12;
using Row = Eigen::Matrix<double, 1, kMapAndShift>;
using Normal = Eigen::Matrix<double, kMapAndShift, kMapAndShift>;
using Unknown = Eigen::Matrix<double, kMapAndShift, 1>;

constexpr double kPixelScale = 300.0;  // pixels: makes all columns of millimetre size

struct Seen {
  std::vector<const SpatialObservation*> observations;
  Eigen::Isometry3d reference_from_probe = Eigen::Isometry3d::Identity();
};

std::vector<Seen> seen_at(const ProbePoses& poses, const std::vector<SpatialObservation>& observations,
                          double latency_s) {
  std::map<int, Seen> frames;
  for (const SpatialObservation& observation : observations) {
    const auto at = poses.at(observation.frame, latency_s);
    if (!at || !at->inside) continue;
    Seen& seen = frames[observation.frame];
    seen.observations.push_back(&observation);
    seen.reference_from_probe = at->reference_from_probe;
  }
  std::vector<Seen> list;
  for (auto& [number, seen] : frames) list.push_back(std::move(seen));
  return list;
}

struct LinearProblem {
  Normal normal = Normal::Zero();
  Unknown right = Unknown::Zero();

  void add(const Seen& seen, const Eigen::Matrix3d& phantom_turn, const Eigen::Vector3d& phantom_shift) {
    const Eigen::Matrix3d turn = phantom_turn * seen.reference_from_probe.linear();
    const Eigen::Vector3d place = phantom_turn * seen.reference_from_probe.translation() + phantom_shift;
    for (const SpatialObservation* observation : seen.observations) {
      const Eigen::Matrix3d through = observation->rows * turn;
      const Eigen::Vector3d target = observation->rows * (observation->origin_mm - place);
      for (int i = 0; i < observation->row_count; ++i) {
        Row row;
        row << through.row(i) * observation->position_px.x() / kPixelScale,
            through.row(i) * observation->position_px.y() / kPixelScale, through.row(i), observation->rows.row(i);
        normal += row.transpose() * row;
        right += row.transpose() * target[i];
      }
    }
  }

  // Of the first `size` unknowns; what nothing is known of stays small.
  Unknown solved(int size) const {
    constexpr double kRidge = 1e-9;
    Eigen::MatrixXd system = normal.topLeftCorner(size, size);
    system.diagonal().array() += kRidge * system.diagonal().maxCoeff();
    Unknown solution = Unknown::Zero();
    solution.head(size) = system.ldlt().solve(right.head(size));
    return solution;
  }
};

std::optional<SpatialState> state_from(const Unknown& solution) {
  Eigen::Matrix<double, 3, 2> axes;
  axes << solution.segment<3>(0) / kPixelScale, solution.segment<3>(3) / kPixelScale;
  if (!solution.allFinite() || axes.col(0).norm() < 1e-4 || axes.col(1).norm() < 1e-4) return std::nullopt;
  if (axes.col(0).normalized().cross(axes.col(1).normalized()).norm() < 0.1) return std::nullopt;
  return state_of(axes, solution.segment<3>(6), false);
}

// The median distance in pixels: in millimetres, an image shrunk to a point would be good.
double disagreement(const std::vector<Seen>& frames, const SpatialState& state) {
  std::vector<double> distances;
  for (const Seen& seen : frames) {
    ProbePoses::At at;
    at.reference_from_probe = seen.reference_from_probe;
    double sum = 0.0;
    for (const auto* observation : seen.observations) sum += spatial_error(*observation, at, state, nullptr).norm();
    distances.push_back(sum / static_cast<double>(seen.observations.size()));
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle / std::exp(0.5 * (state.log_sx + state.log_sy));
}

}  // namespace

std::vector<SpatialState> starts_with_known_phantom(const ProbePoses& poses,
                                                    const std::vector<SpatialObservation>& observations,
                                                    const Eigen::Isometry3d& reference_from_phantom,
                                                    const std::vector<double>& latencies_s, std::uint64_t seed) {
  constexpr int kTrials = 40;  // with a fifth of the frames wrong, one in four picks of six has none
  constexpr std::size_t kFramesATrial = 6;
  const Eigen::Isometry3d inverse = reference_from_phantom.inverse();
  Random random(seed);
  std::vector<std::pair<double, SpatialState>> found;
  for (const double latency_s : latencies_s) {
    const std::vector<Seen> frames = seen_at(poses, observations, latency_s);
    if (frames.size() < kFramesATrial) continue;
    std::optional<std::pair<double, SpatialState>> best;
    for (int trial = 0; trial <= kTrials; ++trial) {
      LinearProblem problem;
      const std::size_t picks = trial == 0 ? frames.size() : kFramesATrial;  // first all together
      for (std::size_t i = 0; i < picks; ++i) {
        const auto pick = static_cast<std::size_t>(random.uniform() * static_cast<double>(frames.size()));
        problem.add(frames[trial == 0 ? i : pick], inverse.linear(), inverse.translation());
      }
      auto state = state_from(problem.solved(kMap));
      if (!state) continue;
      state->latency_s = latency_s;
      state->reference_from_phantom = reference_from_phantom;
      const double measure = disagreement(frames, *state);
      if (!best || measure < best->first) best = {measure, *state};
    }
    if (best) found.push_back(*best);
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<SpatialState> states;
  for (const auto& [measure, state] : found) states.push_back(state);
  return states;
}

std::vector<Eigen::Matrix3d> all_turns() {
  constexpr int kRotations = 600;
  Random random(1);
  std::vector<Eigen::Matrix3d> turns;
  for (int i = 0; i < kRotations; ++i) {
    // Uniform over rotations (Shoemake).
    const double u = random.uniform();
    const double a = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double b = random.uniform(0.0, 2.0 * std::numbers::pi);
    turns.push_back(Eigen::Quaterniond(std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a),
                                       std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b))
                        .toRotationMatrix());
  }
  return turns;
}

std::vector<Eigen::Matrix3d> plane_turns() {
  constexpr int kDirections = 300;
  std::vector<Eigen::Matrix3d> turns;
  for (int i = 0; i < kDirections; ++i) {
    // A spiral with equal areas between its turns (Fibonacci's).
    const double z = (i + 0.5) / kDirections;
    const double around = 2.0 * std::numbers::pi * i / std::numbers::phi;
    const double aside = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d direction(aside * std::cos(around), aside * std::sin(around), z);
    turns.push_back(Eigen::Quaterniond::FromTwoVectors(direction, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  }
  return turns;
}

std::vector<double> latencies_to_try(const ProbePoses& poses, const SpatialOptions& options) {
  constexpr double kStep_s = 0.05;
  std::vector<double> latencies = {0.0};
  if (!options.try_latency || !poses.has_times()) return latencies;
  for (int i = 1; i * kStep_s <= options.max_latency_s; ++i) {
    latencies.push_back(i * kStep_s);
    latencies.push_back(-i * kStep_s);
  }
  return latencies;
}

namespace {

// Frames spread over the sweep are enough for a start, and there are many rotations.
std::vector<Seen> thinned(std::vector<Seen> frames) {
  constexpr std::size_t kMostFrames = 24;
  if (frames.size() <= kMostFrames) return frames;
  std::vector<Seen> some;
  for (std::size_t i = 0; i < kMostFrames; ++i) some.push_back(std::move(frames[i * frames.size() / kMostFrames]));
  return some;
}

std::optional<SpatialState> solved_start(const std::vector<const Seen*>& frames, const Eigen::Matrix3d& turn,
                                         const Eigen::Vector3d& centre) {
  LinearProblem problem;
  for (const Seen* seen : frames) problem.add(*seen, turn, -(turn * centre));
  const Unknown solution = problem.solved(kMapAndShift);
  auto state = state_from(solution);
  if (!state) return std::nullopt;
  state->reference_from_phantom.linear() = turn.transpose();
  state->reference_from_phantom.translation() = centre - turn.transpose() * solution.tail<3>();
  return state;
}

}  // namespace

std::vector<SpatialState> starts_with_unknown_phantom(const ProbePoses& poses,
                                                      const std::vector<SpatialObservation>& observations,
                                                      const StartSearch& search) {
  Random random(search.seed);
  std::vector<std::pair<double, SpatialState>> found;
  for (const double latency_s : search.latencies_s) {
    const std::vector<Seen> frames = thinned(seen_at(poses, observations, latency_s));
    if (frames.empty()) continue;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Seen& seen : frames) {
      centre += seen.reference_from_probe.translation() / static_cast<double>(frames.size());
    }
    for (const Eigen::Matrix3d& turn : search.phantom_from_reference) {
      std::optional<std::pair<double, SpatialState>> best;
      for (int trial = 0; trial <= search.trials; ++trial) {
        std::vector<const Seen*> picks;
        const std::size_t count = trial == 0 ? frames.size() : static_cast<std::size_t>(search.frames_a_trial);
        for (std::size_t i = 0; i < count; ++i) {
          picks.push_back(
              &frames[trial == 0 ? i
                                 : static_cast<std::size_t>(random.uniform() * static_cast<double>(frames.size()))]);
        }
        auto state = solved_start(picks, turn, centre);
        if (!state) continue;
        state->latency_s = latency_s;
        const double measure = disagreement(frames, *state);
        if (!best || measure < best->first) best = {measure, *state};
      }
      if (best) found.push_back(std::move(*best));
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (found.size() > search.count) found.erase(found.begin() + static_cast<std::ptrdiff_t>(search.count), found.end());
  std::vector<SpatialState> states;
  for (const auto& [measure, state] : found) states.push_back(state);
  return states;
}

}  // namespace fathom
