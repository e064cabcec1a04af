#include "registration/wire_identification.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"

namespace fathom {

namespace {

constexpr double kLeastSize_mm = 1.0;    // of a pattern, either way
constexpr double kParallel = 0.02;       // radians: wires are strung through drilled holes
constexpr double kBeyondWire = 0.04;     // of its length, how far the middle wire may be met beyond its ends
constexpr double kLeastSpan = 0.06;      // of the farthest distance of two spots: an N is not narrower
constexpr double kLeastOffset_px = 2.5;  // spots are not placed better than this in the coarse comparison
constexpr std::size_t kFitted = 40;      // most promising readings that are fitted in space

Eigen::Matrix2d canonical_from_image(ImageOrientation orientation) {
  Eigen::Matrix2d matrix;
  switch (orientation) {
    case ImageOrientation::kWire0Left:
      matrix << 1, 0, 0, 1;
      break;
    case ImageOrientation::kWire0Right:
      matrix << -1, 0, 0, 1;
      break;
    case ImageOrientation::kUpsideDownWire0Left:
      matrix << 1, 0, 0, -1;
      break;
    case ImageOrientation::kUpsideDownWire0Right:
      matrix << -1, 0, 0, -1;
      break;
    case ImageOrientation::kFirstPatternLeft:
      matrix << 0, 1, 1, 0;
      break;
    case ImageOrientation::kFirstPatternLeftMirrored:
      matrix << 0, -1, 1, 0;
      break;
    case ImageOrientation::kFirstPatternRight:
      matrix << 0, 1, -1, 0;
      break;
    case ImageOrientation::kFirstPatternRightMirrored:
      matrix << 0, -1, -1, 0;
      break;
  }
  return matrix;
}

/// The phantom seen along its outer wires: x from wire 0 to wire 2, z from the first pattern to the last.
struct EndView {
  Eigen::Matrix3d phantom_from_view;  ///< columns: x, along the wires (front to back), z
  struct Pattern {
    Eigen::Vector2d left;      ///< wire 0, (x, z), mm
    Eigen::Vector2d right;     ///< wire 2
    double front_ratio = 0.0;  ///< of the middle wire's front, 0 at wire 0 and 1 at wire 2
    double back_ratio = 0.0;
    double front_mm = 0.0;  ///< where the middle wire's ends are along the wires
    double back_mm = 0.0;
  };
  std::vector<Pattern> patterns;
};

EndView end_view(const WirePhantom& phantom) {
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  for (const NPattern& pattern : phantom.patterns) {
    along += (pattern[0].back - pattern[0].front).normalized() + (pattern[2].back - pattern[2].front).normalized();
    across += pattern[2].front - pattern[0].front;
  }
  along.normalize();
  across = (across - along * along.dot(across)).normalized();
  Eigen::Vector3d down = across.cross(along);
  const NPattern& first = phantom.patterns.front();
  const NPattern& last = phantom.patterns.back();
  if (down.dot(last[0].front + last[2].front - first[0].front - first[2].front) < 0.0) down = -down;

  EndView view;
  view.phantom_from_view << across, along, down;
  const auto seen = [&](const Eigen::Vector3d& x) { return Eigen::Vector2d(across.dot(x), down.dot(x)); };
  for (const NPattern& pattern : phantom.patterns) {
    EndView::Pattern& to = view.patterns.emplace_back();
    to.left = seen((pattern[0].front + pattern[0].back) / 2.0);
    to.right = seen((pattern[2].front + pattern[2].back) / 2.0);
    const Eigen::Vector2d span = to.right - to.left;
    to.front_ratio = (seen(pattern[1].front) - to.left).dot(span) / span.squaredNorm();
    to.back_ratio = (seen(pattern[1].back) - to.left).dot(span) / span.squaredNorm();
    to.front_mm = along.dot(pattern[1].front);
    to.back_mm = along.dot(pattern[1].back);
  }
  return view;
}

/// Three spots that may be an N.
struct Triple {
  std::array<std::size_t, 3> spots;  // left, middle, right
  Eigen::Vector2d left;
  Eigen::Vector2d span;
  double ratio = 0.0;
};

bool shares_a_spot(const Triple& a, const Triple& b) {
  return std::any_of(a.spots.begin(), a.spots.end(), [&](std::size_t spot) {
    return std::find(b.spots.begin(), b.spots.end(), spot) != b.spots.end();
  });
}

std::vector<Triple> triples_on_lines(std::span<const Eigen::Vector2d> at, const WireMatchOptions& options) {
  double farthest = 0.0;
  for (const Eigen::Vector2d& a : at) {
    for (const Eigen::Vector2d& b : at) farthest = std::max(farthest, (a - b).norm());
  }
  std::vector<Triple> triples;
  for (std::size_t left = 0; left < at.size(); ++left) {
    for (std::size_t right = 0; right < at.size(); ++right) {
      const Eigen::Vector2d span = at[right] - at[left];
      const double length = span.norm();
      if (span.x() <= 0.0 || length < kLeastSpan * farthest) continue;
      if (std::abs(std::atan2(span.y(), span.x())) > options.max_turn_rad) continue;
      const double off_line = std::max(kLeastOffset_px, options.collinearity * length);
      for (std::size_t middle = 0; middle < at.size(); ++middle) {
        if (middle == left || middle == right) continue;
        const Eigen::Vector2d to = at[middle] - at[left];
        const double ratio = to.dot(span) / (length * length);
        if (ratio <= 0.0 || ratio >= 1.0) continue;
        if (std::abs(to.x() * span.y() - to.y() * span.x()) > off_line * length) continue;
        triples.push_back({{left, middle, right}, at[left], span, ratio});
      }
    }
  }
  return triples;
}

/// The coarse comparison: what two patterns say of the image, in pixels for each millimetre.
struct CoarseView {
  Eigen::Vector2d right;  ///< along the phantom's x
  Eigen::Vector2d down;   ///< along its z
  Eigen::Vector2d origin;
  Eigen::Vector2d at(const Eigen::Vector2d& x_mm) const { return origin + right * x_mm.x() + down * x_mm.y(); }
};

class Identifier {
 public:
  Identifier(std::span<const BrightSpot> spots, const WirePhantom& phantom, ImageOrientation orientation,
             const std::optional<Eigen::Vector2d>& pixel_mm, const WireMatchOptions& options)
      : spots_(spots),
        phantom_(phantom),
        view_(end_view(phantom)),
        canonical_from_image_(canonical_from_image(orientation)),
        pixel_mm_(pixel_mm),
        options_(options),
        width_mm_(phantom_width_mm(phantom)) {
    for (const BrightSpot& spot : spots) {
      at_.emplace_back(canonical_from_image_ * spot.centre_px);
      brightest_ = std::max(brightest_, spot.contrast);
    }
    const std::size_t count = phantom.patterns.size();
    needed_ = count >= 3 && pixel_mm ? count - 1 : count;
  }

  std::optional<WireMatch> identify() {
    if (at_.size() < 3 * needed_) return std::nullopt;
    find_triples();
    if (view_.patterns.size() == 1) {
      for (std::size_t i = 0; i < triples_[0].size(); ++i) add_lone(i);
    } else {
      for (std::size_t a = 0; a + 1 < view_.patterns.size(); ++a) {
        for (std::size_t b = a + 1; b < view_.patterns.size(); ++b) {
          if (needed_ == view_.patterns.size() && (a != 0 || b != 1)) continue;  // every reading has these two
          compare(a, b);
        }
      }
    }
    std::stable_sort(readings_.begin(), readings_.end(),
                     [](const Reading& a, const Reading& b) { return a.promise > b.promise; });
    std::optional<WireMatch> best;
    double best_score = 0.0;
    for (std::size_t i = 0; i < std::min(kFitted, readings_.size()); ++i) {
      const std::optional<WireMatch> match = fitted(readings_[i]);
      if (!match) continue;
      const double score =
          match->points + 2.0 * match->mean_contrast / brightest_ - match->rms_mm / (options_.max_rms * width_mm_);
      if (best && score <= best_score) continue;
      best = match;
      best_score = score;
    }
    return best;
  }

 private:
  struct Reading {
    std::vector<const Triple*> triples;  // one for each pattern, null where there is none
    CoarseView view;
    double promise = 0.0;
  };

  void find_triples() {
    const std::vector<Triple> all = triples_on_lines(at_, options_);
    triples_.resize(view_.patterns.size());
    for (std::size_t k = 0; k < view_.patterns.size(); ++k) {
      const EndView::Pattern& pattern = view_.patterns[k];
      for (const Triple& triple : all) {
        const double along = (triple.ratio - pattern.front_ratio) / (pattern.back_ratio - pattern.front_ratio);
        if (along > -kBeyondWire && along < 1.0 + kBeyondWire) triples_[k].push_back(triple);
      }
    }
  }

  /// Whether pixels of a possible size see the phantom in this way; tilting the image only makes it larger.
  bool plausible(const CoarseView& view) const {
    const double right = view.right.norm();
    const double down = view.down.norm();
    const double cosine = std::abs(view.right.dot(view.down)) / (right * down);
    if (view.down.y() <= 0.0 || cosine > std::sin(options_.max_tilt_rad)) return false;
    const double stretch = 1.0 / std::cos(options_.max_tilt_rad);
    if (!pixel_mm_) return right < options_.max_pixel_aspect * down && down < options_.max_pixel_aspect * right;
    const Eigen::Vector2d pixel = (canonical_from_image_ * *pixel_mm_).cwiseAbs();
    // Turned in the image, either pixel size may be met.
    const double smallest = pixel.minCoeff() * (1.0 - options_.scale_tolerance);
    const double largest = pixel.maxCoeff() * (1.0 + options_.scale_tolerance);
    return right * largest > 1.0 && down * largest > 1.0 && right * smallest < stretch && down * smallest < stretch;
  }

  void compare(std::size_t a, std::size_t b) {
    const EndView::Pattern& first = view_.patterns[a];
    const EndView::Pattern& second = view_.patterns[b];
    const Eigen::Vector2d span_a_mm = first.right - first.left;
    const Eigen::Vector2d span_b_mm = second.right - second.left;
    for (const Triple& upper : triples_[a]) {
      for (const Triple& lower : triples_[b]) {
        // The outer wires of a pattern are level in the phantom's x to within its drilling: enough for a comparison.
        const Eigen::Vector2d right_a = upper.span / span_a_mm.x();
        const Eigen::Vector2d right_b = lower.span / span_b_mm.x();
        if ((right_a - right_b).squaredNorm() >
            options_.width_tolerance * options_.width_tolerance * right_a.squaredNorm()) {
          continue;
        }
        CoarseView view;
        view.right = (right_a + right_b) / 2.0;
        const Eigen::Vector2d middle_a = upper.left + upper.span / 2.0;
        const Eigen::Vector2d middle_b = lower.left + lower.span / 2.0;
        const Eigen::Vector2d between_mm = (second.left + second.right - first.left - first.right) / 2.0;
        if (std::abs(between_mm.y()) < kLeastSize_mm) continue;
        view.down = (middle_b - middle_a - view.right * between_mm.x()) / between_mm.y();
        const Eigen::Vector2d middle_mm = (first.left + first.right) / 2.0;
        view.origin = middle_a - view.right * middle_mm.x() - view.down * middle_mm.y();
        if (!plausible(view) || shares_a_spot(upper, lower)) continue;
        add_reading(a, upper, b, lower, view, (right_a - right_b).norm() / right_a.norm());
      }
    }
  }

  void add_reading(std::size_t a, const Triple& upper, std::size_t b, const Triple& lower, const CoarseView& view,
                   double misfit) {
    Reading reading;
    reading.view = view;
    reading.triples.assign(view_.patterns.size(), nullptr);
    reading.triples[a] = &upper;
    reading.triples[b] = &lower;
    std::size_t found = 2;
    for (std::size_t k = 0; k < view_.patterns.size(); ++k) {
      if (reading.triples[k] != nullptr) continue;
      const Eigen::Vector2d left = view.at(view_.patterns[k].left);
      const Eigen::Vector2d right = view.at(view_.patterns[k].right);
      // What two patterns say of a third is the less sure the farther it is.
      double nearest = 2.0 * options_.width_tolerance * (right - left).norm();
      for (const Triple& triple : triples_[k]) {
        const double distance = std::max((triple.left - left).norm(), (triple.left + triple.span - right).norm());
        if (distance >= nearest || shares_a_spot(triple, upper) || shares_a_spot(triple, lower)) continue;
        nearest = distance;
        reading.triples[k] = &triple;
      }
      if (reading.triples[k] == nullptr) continue;
      ++found;
      misfit += nearest / (right - left).norm();
    }
    if (found < needed_) return;
    double contrast = 0.0;
    for (const Triple* triple : reading.triples) {
      if (triple == nullptr) continue;
      for (const std::size_t spot : triple->spots) contrast += spots_[spot].contrast / brightest_;
    }
    reading.promise = static_cast<double>(3 * found) + contrast / static_cast<double>(3 * found) - misfit;
    readings_.push_back(std::move(reading));
  }

  void add_lone(std::size_t i) {
    const Triple& triple = triples_[0][i];
    const EndView::Pattern& pattern = view_.patterns[0];
    Reading reading;
    reading.triples = {&triple};
    // A square pixel, and a plane square to the wires, until more is known.
    reading.view.right = triple.span / (pattern.right - pattern.left).norm();
    reading.view.down = Eigen::Vector2d(-reading.view.right.y(), reading.view.right.x());
    reading.view.origin = triple.left - reading.view.right * pattern.left.x() - reading.view.down * pattern.left.y();
    if (!plausible(reading.view)) return;
    for (const std::size_t spot : triple.spots) reading.promise += spots_[spot].contrast;
    readings_.push_back(std::move(reading));
  }

  /// An affine map from pixels to the phantom: x and z as in the coarse view, the place along the wires from the
  /// ratios.
  Eigen::Affine3d start_of(const Reading& reading) const {
    Eigen::Matrix2d image_from_mm;
    image_from_mm << reading.view.right, reading.view.down;
    const Eigen::Matrix2d mm_from_image = image_from_mm.inverse();
    std::vector<Eigen::Vector3d> rows;
    std::vector<double> along_mm;
    for (std::size_t k = 0; k < view_.patterns.size(); ++k) {
      if (reading.triples[k] == nullptr) continue;
      const Triple& triple = *reading.triples[k];
      const EndView::Pattern& pattern = view_.patterns[k];
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

  std::optional<WireMatch> fitted(const Reading& reading) const {
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
  EndView view_;
  Eigen::Matrix2d canonical_from_image_;
  std::optional<Eigen::Vector2d> pixel_mm_;
  const WireMatchOptions& options_;
  double width_mm_;
  double brightest_ = 0.0;
  std::size_t needed_ = 0;
  std::vector<Eigen::Vector2d> at_;           // canonical: wire 0 on the left, the first pattern at the top
  std::vector<std::vector<Triple>> triples_;  // that may be each pattern
  std::vector<Reading> readings_;
};

}  // namespace

void require_usable(const WirePhantom& phantom) {
  const auto refuse = [&](const std::string& what) {
    throw Error("wire phantom" + (phantom.name.empty() ? "" : " \"" + phantom.name + "\"") + ": " + what +
                "; correct the phantom's description");
  };
  if (phantom.patterns.empty()) refuse("it has no N of three wires");
  std::optional<Eigen::Vector3d> common;
  for (std::size_t k = 0; k < phantom.patterns.size(); ++k) {
    const NPattern& pattern = phantom.patterns[k];
    const std::string name = "pattern " + std::to_string(k + 1);
    for (const Wire& wire : pattern) {
      if (!wire.front.allFinite() || !wire.back.allFinite()) refuse(name + " has an end that is not a finite number");
      if ((wire.back - wire.front).norm() < kLeastSize_mm) refuse(name + " has a wire shorter than 1 mm");
    }
    for (const std::size_t outer : {std::size_t{0}, std::size_t{2}}) {
      const Eigen::Vector3d along = (pattern[outer].back - pattern[outer].front).normalized();
      if (!common) common = along;
      if (common->cross(along).norm() > kParallel || common->dot(along) < 0.0) {
        refuse("the outer wires of " + name + " do not run as those of the others, front to back");
      }
    }
    const Eigen::Vector3d across = pattern[2].front - pattern[0].front;
    if ((across - *common * common->dot(across)).norm() < kLeastSize_mm) refuse(name + " is narrower than 1 mm");
    const Eigen::Vector3d middle = pattern[1].back - pattern[1].front;
    if (std::abs(middle.dot(across)) < 0.01 * across.squaredNorm()) {
      refuse("the middle wire of " + name + " does not run from one side to the other");
    }
  }
  const EndView view = end_view(phantom);
  for (std::size_t a = 0; a < view.patterns.size(); ++a) {
    for (std::size_t b = a + 1; b < view.patterns.size(); ++b) {
      if (std::abs(view.patterns[a].left.y() - view.patterns[b].left.y()) < kLeastSize_mm) {
        refuse("patterns " + std::to_string(a + 1) + " and " + std::to_string(b + 1) + " are at the same depth");
      }
      if (view.patterns[a].left.y() > view.patterns[b].left.y()) {
        refuse("patterns are not listed from the one nearest to the probe to the farthest");
      }
    }
  }
}

double phantom_width_mm(const WirePhantom& phantom) {
  double width = 0.0;
  for (const EndView::Pattern& pattern : end_view(phantom).patterns) {
    width += (pattern.right - pattern.left).norm() / static_cast<double>(phantom.patterns.size());
  }
  return width;
}

std::optional<WireMatch> identify_wires(std::span<const BrightSpot> spots, const WirePhantom& phantom,
                                        ImageOrientation orientation, const std::optional<Eigen::Vector2d>& pixel_mm,
                                        const WireMatchOptions& options) {
  require_usable(phantom);
  return Identifier(spots, phantom, orientation, pixel_mm, options).identify();
}

}  // namespace fathom
