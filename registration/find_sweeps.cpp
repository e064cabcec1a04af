#include "registration/find_sweeps.h"

#include <cmath>
#include <optional>
#include <string>

#include "acquisition/live/folder_names.h"
#include "core/error.h"

namespace fathom {

namespace {

void require_sweep(const std::vector<Sweep>& sweeps, std::size_t index) {
  if (index < sweeps.size()) return;
  throw Error("there is no sweep " + std::to_string(index + 1) + "; there are " + std::to_string(sweeps.size()));
}

}  // namespace

void FindSweepsOptions::check() const {
  if (!(pause_s > 0.0) || !std::isfinite(pause_s)) throw Error("the pause between sweeps must be above 0 seconds");
  if (!(jump_mm > 0.0) || !std::isfinite(jump_mm)) throw Error("the jump between sweeps must be above 0 mm");
  if (lost_poses < 0) throw Error("the number of lost poses must not be negative");
  if (min_frames < 1) throw Error("a sweep must have at least one frame");
}

std::vector<Sweep> find_sweeps(const Recording& recording, const FrameLocator& locator,
                               const FindSweepsOptions& options) {
  options.check();
  const RecordingHeader& header = recording.header();
  const Eigen::Vector2d middle_px(0.5 * (header.width - 1), 0.5 * (header.height - 1));
  const Eigen::Vector2d follow_px = options.follow_px.value_or(middle_px);
  std::vector<Sweep> sweeps;
  std::optional<Sweep> current;
  Eigen::Vector3d before_mm = Eigen::Vector3d::Zero();
  const auto finish = [&] {
    if (current && frame_count(*current) >= options.min_frames) sweeps.push_back(*current);
    current.reset();
  };
  for (int i = 0; i < header.frame_count(); ++i) {
    const FrameHeader& frame = header.frames[static_cast<std::size_t>(i)];
    if (!frame.image_valid()) {
      finish();
      continue;
    }
    const auto reference_from_image = locator.reference_from_image(i);
    if (!reference_from_image) continue;
    const Eigen::Vector3d place_mm = *reference_from_image * Eigen::Vector3d(follow_px.x(), follow_px.y(), 0.0);
    if (current) {
      const FrameHeader& last = header.frames[static_cast<std::size_t>(current->last)];
      const int steps = i - current->last;
      const bool pause = frame.time_s && last.time_s && *frame.time_s - *last.time_s > options.pause_s;
      const bool jump = (place_mm - before_mm).norm() > options.jump_mm * steps;
      const bool told = sweep_of(frame) != sweep_of(last);
      if (pause || jump || told || steps - 1 > options.lost_poses) finish();
    }
    if (!current) current = Sweep{0, i, i};
    current->last = i;
    before_mm = place_mm;
  }
  finish();
  return sweeps;
}

void split_sweep(std::vector<Sweep>& sweeps, std::size_t index, int frame) {
  require_sweep(sweeps, index);
  if (frame <= sweeps[index].first || frame > sweeps[index].last) {
    throw Error("sweep " + std::to_string(index + 1) + " cannot be split before frame " + std::to_string(frame) +
                "; it has frames " + std::to_string(sweeps[index].first) + " to " + std::to_string(sweeps[index].last));
  }
  Sweep second = sweeps[index];
  second.first = frame;
  sweeps[index].last = frame - 1;
  sweeps.insert(sweeps.begin() + static_cast<std::ptrdiff_t>(index) + 1, second);
}

void join_sweeps(std::vector<Sweep>& sweeps, std::size_t index) {
  require_sweep(sweeps, index);
  require_sweep(sweeps, index + 1);
  if (sweeps[index].recording != sweeps[index + 1].recording) {
    throw Error("sweeps of two recordings cannot be joined; join within one recording");
  }
  sweeps[index].last = sweeps[index + 1].last;
  drop_sweep(sweeps, index + 1);
}

void drop_sweep(std::vector<Sweep>& sweeps, std::size_t index) {
  require_sweep(sweeps, index);
  sweeps.erase(sweeps.begin() + static_cast<std::ptrdiff_t>(index));
}

}  // namespace fathom
