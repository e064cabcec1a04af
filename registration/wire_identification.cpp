#include "registration/wire_identification.h"

#include <algorithm>
#include <cmath>

#include "registration/wire_readings.h"

namespace fathom {

namespace {

constexpr std::size_t kFitted = 40;  // most promising readings that are fitted in space

class Identifier {
 public:
  Identifier(std::span<const BrightSpot> spots, const WirePhantom& phantom, ImageOrientation orientation,
             const std::optional<Eigen::Vector2d>& pixel_mm, const WireMatchOptions& options)
      : spots_(spots),
        phantom_(phantom),
        view_(wire_end_view(phantom)),
        canonical_from_image_(canonical_from_image(orientation)),
        pixel_mm_(pixel_mm),
        options_(options),
        width_mm_(phantom_width_mm(phantom)) {
    for (const BrightSpot& spot : spots) at_.emplace_back(canonical_from_image_ * spot.centre_px);
    const std::size_t count = phantom.patterns.size();
    needed_ = count >= 3 && pixel_mm ? count - 1 : count;
  }

  std::optional<WireMatch> identify() const {
    std::optional<Eigen::Vector2d> canonical_pixel_mm;
    if (pixel_mm_) canonical_pixel_mm = (canonical_from_image_ * *pixel_mm_).cwiseAbs();
    const WireReadings found(spots_, at_, view_, canonical_pixel_mm, needed_, options_);
    const std::vector<WireReading>& readings = found.readings();
    std::optional<WireMatch> best;
    double best_score = 0.0;
    for (std::size_t i = 0; i < std::min(kFitted, readings.size()); ++i) {
      const std::optional<WireMatch> match = fitted(readings[i]);
      if (!match) continue;
      const double score = match->points + 2.0 * match->mean_contrast / found.brightest() -
                           match->rms_mm / (options_.max_rms * width_mm_);
      if (best && score <= best_score) continue;
      best = match;
      best_score = score;
    }
    return best;
  }

 private:
  /// An affine map from pixels to the phantom: x and z as in the coarse view, the place along the wires from the
  /// ratios.
  Eigen::Affine3d start_of(const WireReading& reading) const {
    Eigen::Matrix2d image_from_mm;
    image_from_mm << reading.view.right, reading.view.down;
    const Eigen::Matrix2d mm_from_image = image_from_mm.inverse();
    std::vector<Eigen::Vector3d> rows;
    std::vector<double> along_mm;
    for (std::size_t k = 0; k < view_.patterns.size(); ++k) {
      if (reading.triples[k] == nullptr) continue;
      const WireTriple& triple = *reading.triples[k];
      const WireEndView::Pattern& pattern = view_.patterns[k];
      const double along = (triple.ratio - pattern.front_ratio) / (pattern.back_ratio - pattern.front_ratio);
      const Eigen::Vector2d at = mm_from_image * (triple.left + triple.ratio * triple.span - reading.view.origin);
      rows.emplace_back(1.0, at.x(), at.y());
      along_mm.push_back(pattern.front_mm + along * (pattern.back_mm - pattern.front_mm));
    }
    // The place is a plane over (x, z); slopes are kept small where the points leave them open.
    constexpr double kSlope = 1e-2;
    Eigen::Matrix3d normal = Eigen::Vector3d(0.0, kSlope, kSlope).asDiagonal();
    Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      normal += rows[i] * rows[i].transpose();
      right_side += rows[i] * along_mm[i];
    }
    const Eigen::Vector3d plane = normal.ldlt().solve(right_side);
    const double limit = std::tan(options_.max_tilt_rad);
    const Eigen::Vector2d slope(std::clamp(plane.y(), -limit, limit), std::clamp(plane.z(), -limit, limit));

    const auto lifted = [&](const Eigen::Vector2d& x_mm, double along) {
      return Eigen::Vector3d(view_.phantom_from_view * Eigen::Vector3d(x_mm.x(), along, x_mm.y()));
    };
    const Eigen::Matrix2d mm_from_pixel = mm_from_image * canonical_from_image_;
    Eigen::Affine3d start = Eigen::Affine3d::Identity();
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d column = mm_from_pixel.col(axis);
      start.linear().col(axis) = lifted(column, slope.dot(column));
    }
    const Eigen::Vector2d origin = -mm_from_image * reading.view.origin;
    start.translation() = lifted(origin, plane.x() + slope.dot(origin));
    start.linear().col(2) = start.linear().col(0).cross(start.linear().col(1)).normalized();
    return start;
  }

  std::optional<WireMatch> fitted(const WireReading& reading) const {
    WireMatch match;
    match.spots.resize(view_.patterns.size());
    for (std::size_t k = 0; k < view_.patterns.size(); ++k) {
      if (reading.triples[k] == nullptr) continue;
      for (std::size_t wire = 0; wire < 3; ++wire) match.spots[k][wire] = reading.triples[k]->spots[wire];
    }
    std::optional<Eigen::Vector2d> pixel_mm = pixel_mm_;
    const Eigen::Affine3d start = start_of(reading);
    if (!pixel_mm && view_.patterns.size() == 1) {
      pixel_mm = Eigen::Vector2d::Constant(1.0 / reading.view.right.norm());
    }
    if (!fit(match, start, pixel_mm)) return std::nullopt;
    if (take_missing(match) && !fit(match, match.phantom_from_image, pixel_mm)) return std::nullopt;

    for (const auto& pattern : match.spots) {
      const auto here =
          std::count_if(pattern.begin(), pattern.end(), [](const auto& spot) { return spot.has_value(); });
      match.points += static_cast<int>(here);
      if (here == 3) ++match.complete_patterns;
      for (const auto& spot : pattern) {
        if (spot) match.mean_contrast += spots_[*spot].contrast;
      }
    }
    match.mean_contrast /= match.points;
    return match;
  }

  bool fit(WireMatch& match, const Eigen::Affine3d& start, const std::optional<Eigen::Vector2d>& pixel_mm) const {
    std::vector<Eigen::Vector2d> at_px;
    std::vector<Wire> wires;
    for (std::size_t k = 0; k < match.spots.size(); ++k) {
      for (std::size_t wire = 0; wire < 3; ++wire) {
        if (!match.spots[k][wire]) continue;
        at_px.push_back(spots_[*match.spots[k][wire]].centre_px);
        wires.push_back(phantom_.patterns[k][wire]);
      }
    }
    const std::optional<Eigen::Affine3d> plane = fit_image_plane(at_px, wires, start, pixel_mm);
    if (!plane) return false;
    match.phantom_from_image = *plane;
    match.pixel_mm = {plane->linear().col(0).norm(), plane->linear().col(1).norm()};
    if (!pixel_mm) {
      const double aspect = match.pixel_mm.x() / match.pixel_mm.y();
      if (aspect > options_.max_pixel_aspect || aspect * options_.max_pixel_aspect < 1.0) return false;
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < at_px.size(); ++i) {
      const Eigen::Vector3d x = *plane * Eigen::Vector3d(at_px[i].x(), at_px[i].y(), 0.0);
      const double distance = distance_to_wire_mm(wires[i], x);
      if (distance > options_.max_distance * width_mm_) return false;
      const Eigen::Vector3d wire = wires[i].back - wires[i].front;
      const double along = wire.dot(x - wires[i].front) / wire.squaredNorm();
      if (along < -2.0 * kBeyondWire || along > 1.0 + 2.0 * kBeyondWire) return false;
      sum += distance * distance;
    }
    match.rms_mm = std::sqrt(sum / static_cast<double>(at_px.size()));
    const Eigen::Vector3d normal = plane->linear().col(0).cross(plane->linear().col(1)).normalized();
    const double along_wires = std::abs(normal.dot(view_.phantom_from_view.col(1)));
    return match.rms_mm <= options_.max_rms * width_mm_ && along_wires >= std::cos(options_.max_tilt_rad);
  }

  static bool is_taken(const WireMatch& match, std::size_t spot) {
    return std::any_of(match.spots.begin(), match.spots.end(), [&](const auto& pattern) {
      return std::find(pattern.begin(), pattern.end(), std::optional<std::size_t>(spot)) != pattern.end();
    });
  }

  /// Looks where the fitted plane meets wires that have no spot yet. Returns whether there was one.
  bool take_missing(WireMatch& match) const {
    bool taken = false;
    const Eigen::Affine3d image_from_phantom = match.phantom_from_image.inverse();
    for (std::size_t k = 0; k < match.spots.size(); ++k) {
      for (std::size_t wire = 0; wire < 3; ++wire) {
        if (match.spots[k][wire]) continue;
        const Eigen::Vector3d front = image_from_phantom * phantom_.patterns[k][wire].front;
        const Eigen::Vector3d back = image_from_phantom * phantom_.patterns[k][wire].back;
        if (front.z() == back.z()) continue;
        const Eigen::Vector3d meets = front + (back - front) * (front.z() / (front.z() - back.z()));
        std::optional<std::size_t> nearest;
        double distance = options_.max_distance * width_mm_ / match.pixel_mm.mean();
        for (std::size_t spot = 0; spot < spots_.size(); ++spot) {
          const double here = (spots_[spot].centre_px - meets.head<2>()).norm();
          if (here >= distance || is_taken(match, spot)) continue;
          distance = here;
          nearest = spot;
        }
        if (!nearest) continue;
        match.spots[k][wire] = nearest;
        taken = true;
      }
    }
    return taken;
  }

  std::span<const BrightSpot> spots_;
  const WirePhantom& phantom_;
  WireEndView view_;
  Eigen::Matrix2d canonical_from_image_;
  std::optional<Eigen::Vector2d> pixel_mm_;
  const WireMatchOptions& options_;
  double width_mm_;
  std::size_t needed_ = 0;
  std::vector<Eigen::Vector2d> at_;  // canonical: wire 0 on the left, the first pattern at the top
};

}  // namespace

std::optional<WireMatch> identify_wires(std::span<const BrightSpot> spots, const WirePhantom& phantom,
                                        ImageOrientation orientation, const std::optional<Eigen::Vector2d>& pixel_mm,
                                        const WireMatchOptions& options) {
  require_usable(phantom);
  return Identifier(spots, phantom, orientation, pixel_mm, options).identify();
}

}  // namespace fathom
