#include "cli/seed_input.h"

#include <cmath>
#include <map>
#include <utility>

#include "cli/options.h"
#include "core/error.h"

namespace fathom {

std::vector<FrameSeeds> SeedInput::read() const {
  std::vector<FrameSeeds> seeds;
  if (!file.empty()) seeds = read_seeds(file);
  std::map<int, FrameSeeds> by_frame;
  for (const std::vector<double>& numbers : typed) {
    if (numbers[0] < 0.0 || numbers[0] > 1e9 || numbers[0] != std::floor(numbers[0])) {
      throw CLI::ValidationError("--seed", "the first number is a frame, from 0");
    }
    FrameSeeds& frame = by_frame[static_cast<int>(numbers[0])];
    frame.frame = static_cast<int>(numbers[0]);
    frame.points_px.emplace_back(numbers[1], numbers[2]);
  }
  for (auto& [frame, one] : by_frame) seeds.push_back(std::move(one));
  if (seeds.empty()) throw CLI::RequiredError("--seed or --seeds");
  return seeds;
}

void SeedInput::require_recordings(std::size_t count) const {
  for (const FrameSeeds& one : read()) {
    if (static_cast<std::size_t>(one.recording) < count) continue;
    throw Error("seeds: stand on recording " + std::to_string(one.recording) + ", but there are only " +
                std::to_string(count) + "; recordings count from 0");
  }
}

void add_seeds(CLI::App& command, SeedInput& seeds, const std::string& group) {
  add_number_lists(command, "--seed", seeds.typed, 3, "frame,x,y",
                   "A point on the outline, in order (live-wire), or inside (region), in pixels")
      ->group(group);
  command.add_option("--seeds", seeds.file, "A file of seeds")->group(group);
}

}  // namespace fathom
