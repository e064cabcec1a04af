#include "registration/landmark_registration.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <string>

#include <Eigen/SVD>

#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

namespace {

using Points = std::vector<Eigen::Vector3d>;
using Pairs = std::vector<LandmarkRegistration::Pair>;

constexpr int kMostSteps = 500'000;       // of the search: some tenths of a second
constexpr double kClearlyWorse = 3.0;     // rms of another assignment over that of the best
constexpr double kClearlyWorseMm = 1.0;   // and at least so much
constexpr double kMirroredBetter = 0.33;  // rms of the mirrored fit over that of the rigid one

Eigen::Matrix3Xd columns(std::span<const Eigen::Vector3d> points, const Pairs& pairs,
                         std::size_t LandmarkRegistration::Pair::*index) {
  Eigen::Matrix3Xd matrix(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) matrix.col(static_cast<Eigen::Index>(i)) = points[pairs[i].*index];
  return matrix;
}

/// rms distance of points from the line that fits them best.
double off_line_mm(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Vector3d sizes = Eigen::JacobiSVD<Eigen::Matrix3Xd>(centred).singularValues();
  return std::sqrt((sizes[1] * sizes[1] + sizes[2] * sizes[2]) / static_cast<double>(points.cols()));
}

void require_off_line(std::span<const Eigen::Vector3d> points, const char* which, const LandmarkOptions& options) {
  if (points.size() < 3) {
    throw Error(std::string("landmarks: there are ") + std::to_string(points.size()) + " " + which +
                ", but a registration needs three; add landmarks");
  }
  Eigen::Matrix3Xd matrix(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) matrix.col(static_cast<Eigen::Index>(i)) = points[i];
  if (!matrix.allFinite()) throw Error("landmarks: a coordinate is not finite; mend the file");
  const double off = off_line_mm(matrix);
  if (off < options.min_off_line_mm) {
    throw Error("landmarks: those " + std::string(which) + " lie on a line (to " + format_rounded(off, 2) +
                " mm), so the turn about it is unknown; add one beside it");
  }
}

LandmarkRegistration fitted(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to, Pairs pairs) {
  LandmarkRegistration result;
  result.to_from_from.matrix() = Eigen::umeyama(columns(from, pairs, &LandmarkRegistration::Pair::from),
                                                columns(to, pairs, &LandmarkRegistration::Pair::to), false);
  double squares = 0.0;
  for (LandmarkRegistration::Pair& pair : pairs) {
    pair.distance_mm = (result.to_from_from * from[pair.from] - to[pair.to]).norm();
    squares += pair.distance_mm * pair.distance_mm;
  }
  const auto n = static_cast<double>(pairs.size());
  result.rms_mm = std::sqrt(squares / n);
  result.error_mm = result.rms_mm / std::sqrt(3.0 - 6.0 / n);
  result.pairs = std::move(pairs);
  return result;
}

Points mirrored(std::span<const Eigen::Vector3d> points) {
  Points result(points.begin(), points.end());
  for (Eigen::Vector3d& point : result) point.x() = -point.x();
  return result;
}

bool fits_mirrored(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to, double rms_mm) {
  Pairs pairs;
  for (std::size_t i = 0; i < from.size(); ++i) pairs.push_back({i, i, 0.0});
  return fitted(mirrored(from), to, pairs).rms_mm < kMirroredBetter * rms_mm;
}

/// Depth first: the landmarks of `from` one after the other get a landmark of `to` whose distances to those assigned
/// agree, or none.
class Search {
 public:
  Search(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to, const LandmarkOptions& options)
      : from_(from), to_(to), options_(options), taken_(to.size(), false) {
    const double share = options.min_share * static_cast<double>(std::min(from.size(), to.size()));
    least_ = std::max<std::size_t>(3, static_cast<std::size_t>(std::ceil(share - 1e-9)));
  }

  void run() { next(0); }

  /// All assignments of the largest number of landmarks.
  const std::vector<LandmarkRegistration>& found() const { return found_; }

 private:
  bool agrees(std::size_t from, std::size_t to) const {
    return std::all_of(pairs_.begin(), pairs_.end(), [&](const auto& pair) {
      const double distance = (from_[from] - from_[pair.from]).norm();
      return std::abs(distance - (to_[to] - to_[pair.to]).norm()) <= options_.tolerance_mm;
    });
  }

  void next(std::size_t from) {
    if (++steps_ > kMostSteps) {
      throw Error(
          "landmarks: too many orders are possible, as distances between landmarks are alike; list them in the "
          "same order and use --in-order");
    }
    if (pairs_.size() + from_.size() - from < std::max(least_, most_)) return;
    if (from == from_.size()) {
      keep();
      return;
    }
    for (std::size_t to = 0; to < to_.size(); ++to) {
      if (taken_[to] || !agrees(from, to)) continue;
      taken_[to] = true;
      pairs_.push_back({from, to, 0.0});
      next(from + 1);
      pairs_.pop_back();
      taken_[to] = false;
    }
    next(from + 1);
  }

  void keep() {
    if (off_line_mm(columns(from_, pairs_, &LandmarkRegistration::Pair::from)) < options_.min_off_line_mm) return;
    LandmarkRegistration fit = fitted(from_, to_, pairs_);
    if (fit.rms_mm > options_.max_rms_mm) return;  // mirror images agree in distances, too
    if (pairs_.size() > most_) found_.clear();
    most_ = pairs_.size();
    found_.push_back(std::move(fit));
  }

  std::span<const Eigen::Vector3d> from_;
  std::span<const Eigen::Vector3d> to_;
  const LandmarkOptions& options_;
  std::vector<bool> taken_;
  std::size_t least_ = 3;
  std::size_t most_ = 0;
  int steps_ = 0;
  Pairs pairs_;
  std::vector<LandmarkRegistration> found_;
};

/// The assignments of the largest number of landmarks, best first.
std::vector<LandmarkRegistration> found_orders(std::span<const Eigen::Vector3d> from,
                                               std::span<const Eigen::Vector3d> to, const LandmarkOptions& options) {
  Search search(from, to, options);
  search.run();
  std::vector<LandmarkRegistration> sorted = search.found();
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.rms_mm < b.rms_mm; });
  return sorted;
}

bool better_beyond_doubt(const LandmarkRegistration& a, const LandmarkRegistration& b) {
  if (a.pairs.size() != b.pairs.size()) return a.pairs.size() > b.pairs.size();
  return b.rms_mm > 0.5 * kClearlyWorseMm && a.rms_mm < kMirroredBetter * b.rms_mm;
}

/// How far two registrations take a landmark apart, at most.
double farthest_apart_mm(const LandmarkRegistration& a, const LandmarkRegistration& b,
                         std::span<const Eigen::Vector3d> from) {
  double farthest = 0.0;
  for (const Eigen::Vector3d& point : from) {
    farthest = std::max(farthest, (a.to_from_from * point - b.to_from_from * point).norm());
  }
  return farthest;
}

}  // namespace

void LandmarkOptions::check() const {
  if (!(max_rms_mm > 0.0)) throw Error("landmarks: the largest rms must be above 0 mm");
  if (!(tolerance_mm > 0.0)) throw Error("landmarks: the tolerance of distances must be above 0 mm");
  if (!(min_off_line_mm > 0.0)) throw Error("landmarks: the distance from a line must be above 0 mm");
  if (!(min_share > 0.0 && min_share <= 1.0)) throw Error("landmarks: the share matched must be above 0, up to 1");
}

LandmarkRegistration register_landmarks(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to,
                                        const LandmarkOptions& options) {
  options.check();
  assert(from.size() == to.size());
  require_off_line(from, "to register from", options);
  require_off_line(to, "to register to", options);
  Pairs pairs;
  for (std::size_t i = 0; i < from.size(); ++i) pairs.push_back({i, i, 0.0});
  LandmarkRegistration result = fitted(from, to, std::move(pairs));
  if (result.rms_mm > options.max_rms_mm) {
    throw Error("landmarks: they do not fit (rms " + format_rounded(result.rms_mm, 1) + " mm); " +
                (fits_mirrored(from, to, result.rms_mm)
                     ? "they would as mirror images: use right-handed coordinates in both lists"
                     : "check that both lists have the same landmarks in the same order"));
  }
  return result;
}

LandmarkRegistration match_landmarks(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to,
                                     const LandmarkOptions& options) {
  options.check();
  require_off_line(from, "to register from", options);
  require_off_line(to, "to register to", options);
  if (std::max(from.size(), to.size()) > kMaxUnorderedLandmarks) {
    throw Error("landmarks: there are more than " + std::to_string(kMaxUnorderedLandmarks) +
                ", too many to find their order; list them in the same order and use --in-order");
  }
  const std::vector<LandmarkRegistration> found = found_orders(from, to, options);
  // Few or flat landmarks also fit their mirror images somehow, with the wrong order.
  const std::vector<LandmarkRegistration> found_mirrored = found_orders(mirrored(from), to, options);
  if (!found_mirrored.empty() && (found.empty() || better_beyond_doubt(found_mirrored.front(), found.front()))) {
    throw Error("landmarks: they fit only as mirror images; use right-handed coordinates in both lists");
  }
  if (found.empty()) {
    throw Error("landmarks: no order makes them fit to " + format_rounded(options.max_rms_mm, 1) +
                " mm; check that both lists have the same landmarks");
  }
  const LandmarkRegistration& best = found.front();
  const double clearly_worse = std::max(kClearlyWorse * best.rms_mm, kClearlyWorseMm);
  for (std::size_t i = 1; i < found.size() && found[i].rms_mm < clearly_worse; ++i) {
    const double apart = farthest_apart_mm(best, found[i], from);
    if (apart <= options.tolerance_mm) continue;
    throw Error(
        "landmarks: their layout is symmetric, so that two orders fit (rms " + format_rounded(best.rms_mm, 2) +
        " and " + format_rounded(found[i].rms_mm, 2) + " mm) but lead to places " + format_rounded(apart, 0) +
        " mm apart; list them in the same order and use --in-order, or add a landmark that breaks the symmetry");
  }
  return best;
}

}  // namespace fathom
