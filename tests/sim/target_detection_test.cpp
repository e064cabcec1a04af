#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "core/statistics.h"
#include "registration/wire_detection.h"
#include "tests/sim/target_scans.h"

namespace fathom {
namespace {

/// Distances of what the detectors find in simulated images from the truth, in pixels.
struct Found {
  int frames = 0;
  std::vector<double> distance_px;
  Eigen::Vector2d bias_px = Eigen::Vector2d::Zero();

  void add(const Eigen::Vector2d& off) {
    distance_px.push_back(off.norm());
    bias_px += (off - bias_px) / static_cast<double>(distance_px.size());
  }
};

Found wires_found(const SimulatedTargetScan& scan, const WirePhantom& phantom) {
  const TruePlaces places = places_of(scan);
  const WireDetection detection = find_wires(*scan.recording, phantom);
  Found found;
  found.frames = detection.frames_with_wires();
  for (const WirePoint& point : detection.points) {
    const std::string& name = phantom.patterns[point.pattern][point.wire].name;
    const auto at = places.find({point.frame, name});
    found.add(at == places.end() ? Eigen::Vector2d(1e3, 1e3) : Eigen::Vector2d(point.position_px - at->second));
  }
  return found;
}

Found wall_found(const SimulatedTargetScan& scan) {
  const TruePlaces places = places_of(scan);
  Found found;
  for (const WallLine& line : detect_wall(*scan.recording)) {
    const Eigen::Vector2d left = places.at({line.frame, "left"});
    const Eigen::Vector2d along = (places.at({line.frame, "right"}) - left).normalized();
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector2d off = line.point_px + side * line.reach_px * line.direction - left;
      found.add(off - off.dot(along) * along);
    }
    ++found.frames;
  }
  return found;
}

Found point_found(const SimulatedTargetScan& scan) {
  const TruePlaces places = places_of(scan);
  Found found;
  for (const SpotPoint& point : detect_point(*scan.recording)) {
    found.add(point.position_px - places.at({point.frame, "point"}));
    ++found.frames;
  }
  return found;
}

class TargetDetection : public testing::TestWithParam<std::tuple<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(Targets, TargetDetection,
                         testing::Combine(testing::Values("wires", "wall", "point"),
                                          testing::Values("linear", "curvilinear")),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param)) + "_" + std::get<1>(test.param);
                         });

TEST_P(TargetDetection, FindsWhatIsThereAndWhereItIs) {
  const auto [object, probe] = GetParam();
  TargetScanOptions options = target_scan_of(object, 24, 7);
  options.probe = probe;
  const SimulatedTargetScan scan = simulate_target(options);
  const Found found = options.object == "wires"  ? wires_found(scan, options.phantom)
                      : options.object == "wall" ? wall_found(scan)
                                                 : point_found(scan);
  const double middle = median(found.distance_px);
  std::printf("%s, %s: %d of %d frames; median %.2f px, worst %.2f, bias %.2f, %.2f\n", object, probe, found.frames,
              scan.frames_in_view, middle, *std::max_element(found.distance_px.begin(), found.distance_px.end()),
              found.bias_px.x(), found.bias_px.y());
  EXPECT_GE(found.frames, 0.97 * scan.frames_in_view);
  EXPECT_LE(middle, options.object == "wires" ? 1.0 : 0.5);
}

}  // namespace
}  // namespace fathom
