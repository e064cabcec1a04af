#include "segmentation/seeds.h"

#include <cstddef>
#include <limits>
#include <string>

#include "core/error.h"
#include "core/json.h"

namespace fathom {

namespace {

constexpr std::size_t kMostPoints = 10'000;
constexpr double kFarthest_px = 1e6;

FrameSeeds read_entry(const JsonValue& value) {
  FrameSeeds seeds;
  seeds.frame = value.at("frame").integer(0, std::numeric_limits<int>::max());
  if (value.has("recording")) seeds.recording = value.at("recording").integer(0, std::numeric_limits<int>::max());
  const JsonValue points = value.at("points");
  if (points.size() < 1 || points.size() > kMostPoints) points.fail("must have 1 to 10000 points");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const JsonValue point = points[i];
    if (point.size() != 2) point.fail("must be a point: two numbers, x and y");
    seeds.points_px.emplace_back(point[0].number(), point[1].number());
    if (seeds.points_px.back().cwiseAbs().maxCoeff() > kFarthest_px) {
      point.fail("lies more than a million pixels away; give pixels");
    }
  }
  return seeds;
}

}  // namespace

std::vector<FrameSeeds> read_seeds(const std::filesystem::path& path) {
  const nlohmann::json document = JsonValue::read_file(path);
  const JsonValue root(document, path);
  require_version(root, "fathom_seeds", 1);
  const JsonValue list = root.at("outlines");
  std::vector<FrameSeeds> seeds;
  for (std::size_t i = 0; i < list.size(); ++i) seeds.push_back(read_entry(list[i]));
  if (seeds.empty()) list.fail("has no seeds; add some");
  return seeds;
}

void require_seeds_on_images(const std::vector<FrameSeeds>& seeds, const Recording& from, int recording) {
  const RecordingHeader& header = from.header();
  for (const FrameSeeds& one : seeds) {
    if (one.recording != recording) continue;
    const std::string frame = from.name() + ": frame " + std::to_string(one.frame);
    if (one.frame < 0 || one.frame >= header.frame_count()) {
      throw Error(frame + " is not there, but has seeds; it has frames 0 to " +
                  std::to_string(header.frame_count() - 1));
    }
    if (!header.frames[static_cast<std::size_t>(one.frame)].image_valid()) {
      throw Error(frame + " has seeds, but its image is marked as invalid; place them on another");
    }
    for (const Eigen::Vector2d& point : one.points_px) {
      if (point.allFinite() && point.minCoeff() >= -0.5 && point.x() <= header.width - 0.5 &&
          point.y() <= header.height - 0.5) {
        continue;
      }
      throw Error(frame + " has a seed outside of its " + std::to_string(header.width) + " x " +
                  std::to_string(header.height) + " pixels; place it inside");
    }
  }
}

}  // namespace fathom
