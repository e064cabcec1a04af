#include "measurement/outline_crossing.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fathom {

namespace {

constexpr double kInside_blocks = 0.5;   // nearer to an outline blocks belong to neither side
constexpr double kOutside_blocks = 1.5;  // the resolution blurs a part's echoes into what is around it
constexpr double kAround_blocks = 8.0;   // how far beside a part its surroundings are looked at
constexpr double kFewest_blocks = 4.0;   // of a drawn part, to know how bright it is

PlacedSection placed(const CrossedSection& section) { return {section.place.plane, section.shape}; }

/// How the nearest section ends.
TaperedEnd ending(const CrossedSection& end, const CrossedSection& nearest, std::span<const CrossedSection> farther) {
  std::vector<PlacedSection> sections = {placed(nearest)};
  for (const CrossedSection& section : farther) {
    if (section.shape->kind() != SectionKind::kOutlined) break;
    sections.push_back(placed(section));
  }
  return {placed(end), sections};
}

/// Grey inside less grey around a part that is moved by `drift_mm`; and the blocks inside.
struct Seen {
  double contrast = 0.0;
  double blocks = 0.0;
};

Seen seen_of(const TaperedEnd::OpenPart& part, const Eigen::Vector2d& drift_mm, const CrossedFrame& frame,
             const PixelGrid& grid) {
  const double per_block = 1.0 / block_mm(frame.place, grid);
  double in = 0.0;
  double in_weight = 1e-9;
  double out = 0.0;
  double out_weight = 1e-9;
  for (int j = 0; j < grid.size.height; ++j) {
    for (int i = 0; i < grid.size.width; ++i) {
      const Eigen::Vector2d ab = frame.place.ab_from_image * grid.middle_px(i, j) - drift_mm;
      if (part.shape->least_outside_mm(ab) > 0.0) continue;
      const double d = per_block * static_cast<double>(part.shape->distance_mm(ab));
      if (d < -kAround_blocks || frame.seen.at<float>(j, i) == 0.0F) continue;
      const double grey = frame.grey.at<float>(j, i);
      if (d > kInside_blocks) {
        in += grey;
        in_weight += 1.0;
      } else if (d < -kOutside_blocks) {
        out += grey;
        out_weight += 1.0;
      }
    }
  }
  if (in_weight < 1.0 || out_weight < 1.0) return {};
  return {in / in_weight - out / out_weight, in_weight};
}

/// How far a part reaches, of the way from the first of `frames`, on which it is drawn, to the last: most probably,
/// when what is seen of it is either the drawn contrast or none, with the same scatter. Empty where the drawn part is
/// not seen itself, so that nothing can be missed elsewhere.
std::optional<double> reach_of(const TaperedEnd::OpenPart& part, const std::vector<const CrossedFrame*>& frames,
                               const PixelGrid& grid) {
  const Eigen::Vector2d middle_mm = part.shape->inside_discs().front().centre_mm;
  const SectionPlane& from = frames.front()->place.plane;
  const auto ahead_mm = [&](const CrossedFrame& frame) {
    return from.normal().dot(frame.place.plane.at(middle_mm) - from.at(middle_mm));
  };
  const double whole_mm = ahead_mm(*frames.back());
  if (whole_mm == 0.0) return std::nullopt;
  std::vector<double> ways;
  for (const CrossedFrame* frame : frames) ways.push_back(ahead_mm(*frame) / whole_mm);
  const Seen drawn = seen_of(part, Eigen::Vector2d::Zero(), *frames.front(), grid);
  if (drawn.blocks < kFewest_blocks || drawn.contrast == 0.0) return std::nullopt;
  double best = 0.0;
  double sum = 0.0;
  double reach = 0.5 * ways[1];
  for (std::size_t k = 1; k + 1 < frames.size(); ++k) {
    const Seen seen = seen_of(part, -ways[k] * part.drift_mm, *frames[k], grid);
    sum += seen.blocks * drawn.contrast * (seen.contrast - 0.5 * drawn.contrast);
    if (sum <= best) continue;
    best = sum;
    reach = 0.5 * (ways[k] + ways[k + 1]);
  }
  return reach;
}

void find_tips_of(TaperedEnd& end, const std::vector<const CrossedFrame*>& frames, const PixelGrid& grid) {
  for (const TaperedEnd::OpenPart& part : end.open_parts()) {
    if (const auto reach = reach_of(part, frames, grid)) end.end_at(part.index, 1.0 - *reach);
  }
}

}  // namespace

OutlineCrossing::OutlineCrossing(const CrossedSection& first, const CrossedSection& second,
                                 std::span<const CrossedSection> before, std::span<const CrossedSection> after,
                                 bool tapered)
    : gap_(placed(first), placed(second), Guide::kDiscs) {
  if (tapered && second.shape->kind() != SectionKind::kOutlined) {
    first_ends_ = ending(second, first, before);
  } else if (tapered && first.shape->kind() != SectionKind::kOutlined) {
    second_ends_ = ending(first, second, after);
  } else {
    if (!before.empty()) gap_before_.emplace(placed(before.front()), gap_.first(), Guide::kDiscs);
    if (!after.empty()) gap_after_.emplace(gap_.second(), placed(after.front()), Guide::kDiscs);
    curved_.emplace(gap_, gap_before_ ? &*gap_before_ : nullptr, gap_after_ ? &*gap_after_ : nullptr);
  }
}

void OutlineCrossing::find_tips(std::span<const CrossedFrame> frames, const PixelGrid& grid) {
  std::vector<const CrossedFrame*> ordered;
  for (const CrossedFrame& frame : frames) ordered.push_back(&frame);
  if (first_ends_) find_tips_of(*first_ends_, ordered, grid);
  std::reverse(ordered.begin(), ordered.end());
  if (second_ends_) find_tips_of(*second_ends_, ordered, grid);
}

PredictedOutline OutlineCrossing::predict(const CarriedPlane& place, const PixelGrid& grid) const {
  return predict_outline(
      gap_,
      {curved_ ? &*curved_ : nullptr, first_ends_ ? &*first_ends_ : nullptr, second_ends_ ? &*second_ends_ : nullptr},
      place, grid);
}

}  // namespace fathom
