#include "sim/studies/outlining_study.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>

#include "segmentation/outline_loops.h"
#include "segmentation/outline_mask.h"

namespace fathom {

namespace {

constexpr double kStep_px = 3.0;  // how far the pointer moves from one look at the wire to the next
constexpr std::size_t kLooksOn =
    7;  // so many looks at a wire that went astray before the user gives up: some 20 pixels
constexpr int kMostClicks = 60;

// Points at equal distances along a closed outline, from its topmost point on.
Polygon walk_along(const Polygon& outline, double step_px) {
  const auto top =
      std::min_element(outline.begin(), outline.end(), [](const auto& a, const auto& b) { return a.y() < b.y(); });
  Polygon turned(top, outline.end());
  turned.insert(turned.end(), outline.begin(), top + 1);
  Polygon walk;
  double left = 0.0;
  for (std::size_t i = 0; i + 1 < turned.size(); ++i) {
    const Eigen::Vector2d edge = turned[i + 1] - turned[i];
    const double length = edge.norm();
    double at = left;
    for (; at < length; at += step_px) walk.push_back(turned[i] + at / length * edge);
    left = at - length;
  }
  return walk;
}

double distance_to(const Eigen::Vector2d& point, const Polygon& line, std::size_t first, std::size_t last) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = first; i < last; ++i) {
    const Eigen::Vector2d& a = line[i % line.size()];
    const Eigen::Vector2d edge = line[(i + 1) % line.size()] - a;
    const double share = std::clamp((point - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (point - a - share * edge).norm());
  }
  return nearest;
}

// How far apart the wire and the true outline between two places on it are on average, whichever is watched.
double mean_gap_px(const Polygon& wire, const Polygon& walk, std::size_t first, std::size_t last) {
  double from_wire = 0.0;
  for (const Eigen::Vector2d& point : wire) from_wire += distance_to(point, walk, first, last);
  double from_walk = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    from_walk += distance_to(walk[i % walk.size()], wire, 0, wire.size() - 1);
  }
  return std::max(from_wire / static_cast<double>(wire.size()), from_walk / static_cast<double>(last - first + 1));
}

}  // namespace

OutliningTrial scripted_outline(const cv::Mat& image, const Polygon& truth, double wanted_dice,
                                const LiveWireOptions& options) {
  const Polygon walk = walk_along(truth, kStep_px);
  const double length_px = kStep_px * static_cast<double>(walk.size());
  const double most_px = 2.0 * std::abs(signed_area(truth)) * (1.0 - wanted_dice) / length_px;
  LiveWire wire(image, options);
  OutliningTrial trial;
  wire.add_seed(walk.front());
  trial.clicks = 1;
  std::size_t at = 0;
  while (at < walk.size() && trial.clicks < kMostClicks) {
    const auto holds = [&](std::size_t end) {
      return mean_gap_px(wire.wire_to(walk[end % walk.size()]), walk, at, end) <= most_px;
    };
    std::size_t reached = at + 1;
    for (std::size_t end = at + 2; end <= std::min(walk.size(), reached + kLooksOn); ++end) {
      if (holds(end)) reached = end;
    }
    ++trial.clicks;
    at = reached;
    if (at < walk.size()) wire.add_seed(walk[at]);
  }
  wire.close();
  const std::vector<Polygon> right = {truth};
  trial.outline_px = wire.line();
  trial.dice = dice(std::vector<Polygon>{trial.outline_px}, right);
  trial.dice_straight = dice(std::vector<Polygon>{wire.seeds()}, right);
  return trial;
}

std::vector<OutliningTrial> live_wire_study(const SimulateOptions& scan_options, int every, double least_area_px,
                                            double wanted_dice, const LiveWireOptions& options) {
  const SimulatedScan scan = simulate(scan_options);
  const RecordingHeader& header = scan.recording->header();
  std::map<int, std::vector<const Contour*>> by_frame;
  for (const Contour& contour : scan.outlines.front().contours) by_frame[contour.frame].push_back(&contour);
  std::vector<OutliningTrial> trials;
  for (const auto& [frame, contours] : by_frame) {
    const Polygon& truth = contours.front()->points_px;
    const bool within = std::all_of(truth.begin(), truth.end(), [&](const Eigen::Vector2d& p) {
      return p.minCoeff() > 2.0 && p.x() < header.width - 3.0 && p.y() < header.height - 3.0;
    });
    if (frame % every != 0 || contours.size() != 1 || !within || std::abs(signed_area(truth)) < least_area_px) continue;
    OutliningTrial trial = scripted_outline(scan.recording->image(frame), truth, wanted_dice, options);
    trial.frame = frame;
    trials.push_back(trial);
  }
  return trials;
}

}  // namespace fathom
