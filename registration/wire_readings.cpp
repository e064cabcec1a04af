#include "registration/wire_readings.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

constexpr double kLeastSpan = 0.06;      // of the farthest distance of two spots: an N is not narrower
constexpr double kLeastOffset_px = 2.5;  // spots are not placed better than this in the coarse comparison

bool shares_a_spot(const WireTriple& a, const WireTriple& b) {
  return std::any_of(a.spots.begin(), a.spots.end(), [&](std::size_t spot) {
    return std::find(b.spots.begin(), b.spots.end(), spot) != b.spots.end();
  });
}

std::vector<WireTriple> triples_on_lines(std::span<const Eigen::Vector2d> at, const WireMatchOptions& options) {
  double farthest = 0.0;
  for (const Eigen::Vector2d& a : at) {
    for (const Eigen::Vector2d& b : at) farthest = std::max(farthest, (a - b).norm());
  }
  std::vector<WireTriple> triples;
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

}  // namespace

WireReadings::WireReadings(std::span<const BrightSpot> spots, std::vector<Eigen::Vector2d> at, const WireEndView& view,
                           const std::optional<Eigen::Vector2d>& canonical_pixel_mm, std::size_t needed,
                           const WireMatchOptions& options)
    : spots_(spots),
      at_(std::move(at)),
      view_(view),
      pixel_mm_(canonical_pixel_mm),
      needed_(needed),
      options_(options) {
  for (const BrightSpot& spot : spots) brightest_ = std::max(brightest_, spot.contrast);
  if (at_.size() < 3 * needed_) return;
  find_triples();
  if (view_.patterns.size() == 1) {
    for (const WireTriple& triple : triples_[0]) add_lone(triple);
  } else {
    for (std::size_t a = 0; a + 1 < view_.patterns.size(); ++a) {
      for (std::size_t b = a + 1; b < view_.patterns.size(); ++b) {
        if (needed_ == view_.patterns.size() && (a != 0 || b != 1)) continue;  // every reading has these two
        compare(a, b);
      }
    }
  }
  std::stable_sort(readings_.begin(), readings_.end(),
                   [](const WireReading& a, const WireReading& b) { return a.promise > b.promise; });
}

void WireReadings::find_triples() {
  const std::vector<WireTriple> all = triples_on_lines(at_, options_);
  triples_.resize(view_.patterns.size());
  for (std::size_t k = 0; k < view_.patterns.size(); ++k) {
    const WireEndView::Pattern& pattern = view_.patterns[k];
    for (const WireTriple& triple : all) {
      const double along = (triple.ratio - pattern.front_ratio) / (pattern.back_ratio - pattern.front_ratio);
      if (along > -kBeyondWire && along < 1.0 + kBeyondWire) triples_[k].push_back(triple);
    }
  }
}

/// Whether pixels of a possible size see the phantom in this way; tilting the image only makes it larger.
bool WireReadings::plausible(const CoarseWireView& view) const {
  const double right = view.right.norm();
  const double down = view.down.norm();
  const double cosine = std::abs(view.right.dot(view.down)) / (right * down);
  if (view.down.y() <= 0.0 || cosine > std::sin(options_.max_tilt_rad)) return false;
  const double stretch = 1.0 / std::cos(options_.max_tilt_rad);
  if (!pixel_mm_) return right < options_.max_pixel_aspect * down && down < options_.max_pixel_aspect * right;
  // Turned in the image, either pixel size may be met.
  const double smallest = pixel_mm_->minCoeff() * (1.0 - options_.scale_tolerance);
  const double largest = pixel_mm_->maxCoeff() * (1.0 + options_.scale_tolerance);
  return right * largest > 1.0 && down * largest > 1.0 && right * smallest < stretch && down * smallest < stretch;
}

void WireReadings::compare(std::size_t a, std::size_t b) {
  const WireEndView::Pattern& first = view_.patterns[a];
  const WireEndView::Pattern& second = view_.patterns[b];
  const Eigen::Vector2d span_a_mm = first.right - first.left;
  const Eigen::Vector2d span_b_mm = second.right - second.left;
  for (const WireTriple& upper : triples_[a]) {
    for (const WireTriple& lower : triples_[b]) {
      // The outer wires of a pattern are level in the phantom's x to within its drilling: enough for a comparison.
      const Eigen::Vector2d right_a = upper.span / span_a_mm.x();
      const Eigen::Vector2d right_b = lower.span / span_b_mm.x();
      if ((right_a - right_b).squaredNorm() >
          options_.width_tolerance * options_.width_tolerance * right_a.squaredNorm()) {
        continue;
      }
      CoarseWireView view;
      view.right = (right_a + right_b) / 2.0;
      const Eigen::Vector2d middle_a = upper.left + upper.span / 2.0;
      const Eigen::Vector2d middle_b = lower.left + lower.span / 2.0;
      const Eigen::Vector2d between_mm = (second.left + second.right - first.left - first.right) / 2.0;
      if (std::abs(between_mm.y()) < kLeastPatternSize_mm) continue;
      view.down = (middle_b - middle_a - view.right * between_mm.x()) / between_mm.y();
      const Eigen::Vector2d middle_mm = (first.left + first.right) / 2.0;
      view.origin = middle_a - view.right * middle_mm.x() - view.down * middle_mm.y();
      if (!plausible(view) || shares_a_spot(upper, lower)) continue;
      add_reading(a, upper, b, lower, view, (right_a - right_b).norm() / right_a.norm());
    }
  }
}

void WireReadings::add_reading(std::size_t a, const WireTriple& upper, std::size_t b, const WireTriple& lower,
                               const CoarseWireView& view, double misfit) {
  WireReading reading;
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
    for (const WireTriple& triple : triples_[k]) {
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
  for (const WireTriple* triple : reading.triples) {
    if (triple == nullptr) continue;
    for (const std::size_t spot : triple->spots) contrast += spots_[spot].contrast / brightest_;
  }
  reading.promise = static_cast<double>(3 * found) + contrast / static_cast<double>(3 * found) - misfit;
  readings_.push_back(std::move(reading));
}

void WireReadings::add_lone(const WireTriple& triple) {
  const WireEndView::Pattern& pattern = view_.patterns[0];
  WireReading reading;
  reading.triples = {&triple};
  // A square pixel, and a plane square to the wires, until more is known.
  reading.view.right = triple.span / (pattern.right - pattern.left).norm();
  reading.view.down = Eigen::Vector2d(-reading.view.right.y(), reading.view.right.x());
  reading.view.origin = triple.left - reading.view.right * pattern.left.x() - reading.view.down * pattern.left.y();
  if (!plausible(reading.view)) return;
  for (const std::size_t spot : triple.spots) reading.promise += spots_[spot].contrast;
  readings_.push_back(std::move(reading));
}

}  // namespace fathom
