#include <algorithm>
#include <cmath>
#include <limits>

#include "registration/reslice_frames.h"

namespace fathom {

namespace {

constexpr int kNobody = -1;

// Cuts columns to those at which low <= at + u * step < high. They are one range, as the function is linear, so that
// nothing is divided where both ends are inside.
void keep_between(double at, double step, double low, double high, int& first, int& end) {
  if (first >= end) return;
  const auto inside = [&](int u) {
    const double value = at + u * step;
    return value >= low && value < high;
  };
  if (inside(first) && inside(end - 1)) return;
  if (step == 0.0) {
    end = first;
    return;
  }
  double enters = (low - at) / step;
  double leaves = (high - at) / step;
  if (step < 0.0) std::swap(enters, leaves);
  const double from = std::max(static_cast<double>(first), std::floor(enters));
  const double to = std::min(static_cast<double>(end), std::ceil(leaves) + 1.0);
  if (!(from < to)) {
    end = first;
    return;
  }
  first = static_cast<int>(from);
  end = static_cast<int>(to);
  // What the divisions rounded.
  while (first < end && !inside(first)) ++first;
  while (first < end && !inside(end - 1)) --end;
}

// The first column after 0 that lies on the other side of 0 than column 0, at most `columns`. 0 counts as above.
int change_of_side(double at, double step, int columns) {
  const bool front = at >= 0.0;
  if (!(front ? step < 0.0 : step > 0.0)) return columns;
  const double root = std::min(-at / step, static_cast<double>(columns));
  const int whole = static_cast<int>(root);
  const int change = front || whole < root ? whole + 1 : whole;
  return std::min(change, columns);
}

}  // namespace

RowRuns::RowRuns(const ResliceFrames& frames, const NearFrames& near, int columns, double spacing_mm,
                 const SpacePartition* partition)
    : frames_(frames),
      near_(near),
      columns_(columns),
      half_pixel_mm_(0.5 * spacing_mm),
      partition_(partition),
      change_(static_cast<std::size_t>(near.count())),
      front_(static_cast<std::size_t>(near.count())),
      least_mm_(static_cast<std::size_t>(columns)),
      winner_(static_cast<std::size_t>(columns)) {}

void RowRuns::divide_by_sweeps(const ResliceRow& row) {
  of_sweep_.clear();
  if (partition_ == nullptr) return;
  std::vector<int> cuts{0, columns_};
  for (const DividingPlane& plane : partition_->planes()) {
    cuts.push_back(change_of_side(plane.signedDistance(row.start_mm), plane.normal().dot(row.step_mm), columns_));
  }
  std::sort(cuts.begin(), cuts.end());
  of_sweep_.resize(frames_.max_gap_mm.size());
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    const Columns part{cuts[i - 1], cuts[i]};
    if (part.first == part.end) continue;
    const auto sweep = partition_->sweep_at(row.start_mm + 0.5 * (part.first + part.end - 1) * row.step_mm);
    for (std::size_t s = 0; s < of_sweep_.size(); ++s) {
      if (!sweep || *sweep == s) of_sweep_[s].push_back(part);
    }
  }
}

bool RowRuns::shows(int frame, int column) const {
  if (frames_.mask.empty()) return true;
  const auto pixel = [&](int axis, int size) {
    const double at = functions_.image_at(axis, frame) + column * functions_.image_step(axis, frame);
    return std::clamp(static_cast<int>(std::floor(at + 0.5)), 0, size - 1);
  };
  return frames_.mask.at<std::uint8_t>(pixel(1, frames_.used.height), pixel(0, frames_.used.width)) != 0;
}

void RowRuns::cut_to_image(int frame, Columns& columns) const {
  const int sizes[2] = {frames_.used.width, frames_.used.height};
  for (int axis = 0; axis < 2; ++axis) {
    keep_between(functions_.image_at(axis, frame), functions_.image_step(axis, frame), -0.5, sizes[axis] - 0.5,
                 columns.first, columns.end);
  }
}

void RowRuns::offer_pair(int frame, int first, int end) {
  Columns columns{first, end};
  const double at = functions_.distance_at(frame) - functions_.distance_at(frame + 1);
  const double step = functions_.distance_step(frame) - functions_.distance_step(frame + 1);
  const double limit_mm = frames_.max_gap_mm[frames_.frames[near_.index[static_cast<std::size_t>(frame)]].sweep];
  keep_between(at, step, -limit_mm, limit_mm, columns.first, columns.end);
  cut_to_image(frame, columns);
  cut_to_image(frame + 1, columns);
  const bool masked = !frames_.mask.empty();
  for (int u = columns.first; u < columns.end; ++u) {
    const double sum_mm = std::abs(at + u * step);
    const auto i = static_cast<std::size_t>(u);
    if (sum_mm >= least_mm_[i] || (masked && !(shows(frame, u) && shows(frame + 1, u)))) continue;
    least_mm_[i] = sum_mm;
    winner_[i] = 2 * frame + 1;
  }
}

void RowRuns::offer_alone(int frame, int first, int end) {
  Columns columns{first, end};
  const double at = functions_.distance_at(frame);
  const double step = functions_.distance_step(frame);
  keep_between(at, step, -half_pixel_mm_, half_pixel_mm_, columns.first, columns.end);
  cut_to_image(frame, columns);
  for (int u = columns.first; u < columns.end; ++u) {
    const auto i = static_cast<std::size_t>(u);
    if (winner_[i] != kNobody && (winner_[i] & 1) != 0) continue;  // a pair shows it
    const double distance_mm = std::abs(at + u * step);
    if (distance_mm >= least_mm_[i] || !shows(frame, u)) continue;
    least_mm_[i] = distance_mm;
    winner_[i] = 2 * frame;
  }
}

void RowRuns::change_columns() {
  for (int k = 0; k < near_.count(); ++k) {
    const double at = functions_.distance_at(k);
    front_[static_cast<std::size_t>(k)] = at >= 0.0;
    change_[static_cast<std::size_t>(k)] = change_of_side(at, functions_.distance_step(k), columns_);
  }
}

void RowRuns::find(const ResliceRow& row, std::vector<ResliceRun>& runs) {
  functions_.set(near_, row, 0, near_.count());
  divide_by_sweeps(row);
  change_columns();
  std::fill(least_mm_.begin(), least_mm_.end(), std::numeric_limits<double>::infinity());
  std::fill(winner_.begin(), winner_.end(), kNobody);

  const std::vector<Columns> everywhere{{0, columns_}};
  const auto allowed = [&](int frame) -> const std::vector<Columns>& {
    if (of_sweep_.empty()) return everywhere;
    return of_sweep_[frames_.frames[near_.index[static_cast<std::size_t>(frame)]].sweep];
  };
  // A column lies between two frames where it is in front of one and behind the other. Both frames of a pair, and the
  // pairs to their other sides, take the change from the same number: pairs neither overlap nor leave a gap.
  for (int k = 0; k + 1 < near_.count(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (!near_.linked[i]) continue;
    const auto [low, high] = std::minmax(change_[i], change_[i + 1]);
    const bool apart = front_[i] != front_[i + 1];
    if (low == high && !apart) continue;
    for (const Columns& part : allowed(k)) {
      const auto offer = [&](int first, int end) {
        first = std::max(first, part.first);
        end = std::min(end, part.end);
        if (first < end) offer_pair(k, first, end);
      };
      if (apart) {
        offer(0, low);
        offer(high, columns_);
      } else {
        offer(low, high);
      }
    }
  }
  if (std::find(winner_.begin(), winner_.end(), kNobody) != winner_.end()) {
    for (int k = 0; k < near_.count(); ++k) {
      for (const Columns& part : allowed(k)) offer_alone(k, part.first, part.end);
    }
  }
  for (int u = 0; u < columns_;) {
    const int winner = winner_[static_cast<std::size_t>(u)];
    int end = u + 1;
    while (end < columns_ && winner_[static_cast<std::size_t>(end)] == winner) ++end;
    if (winner != kNobody) runs.push_back({winner / 2, (winner & 1) != 0, u, end});
    u = end;
  }
}

}  // namespace fathom
