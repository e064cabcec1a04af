#include "segmentation/outline_editing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <opencv2/core.hpp>

#include "core/error.h"
#include "segmentation/outline_distance.h"
#include "segmentation/outline_loops.h"
#include "segmentation/outline_mask.h"
#include "segmentation/outline_resampling.h"
#include "segmentation/outline_splicing.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

constexpr double kMostRadius_px = 500.0;
constexpr double kLeastRadius_px = 0.5;
constexpr double kMostWidth_px = 100.0;
constexpr double kBand_px = 2.0;       // distances are needed this far beside the outlines that come out
constexpr double kLeastArea_px = 0.5;  // smaller crumbs are no parts
constexpr double kTouching_px = 1.0;   // outlines so near to a stroke are drawn anew
constexpr double kSmoothingSpacing_px = 1.0;

bool in_range(double value, double low, double high) { return value >= low && value <= high; }

double distance_between(const Polygon& outline, std::span<const Eigen::Vector2d> line) {
  double nearest = std::numeric_limits<double>::infinity();
  const auto to_piece = [](const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const Eigen::Vector2d edge = b - a;
    const double length = edge.squaredNorm();
    return (p - a - (length > 0.0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0.0) * edge).norm();
  };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
    for (std::size_t j = 0; j < line.size(); ++j) {
      const Eigen::Vector2d& c = line[j];
      const Eigen::Vector2d& d = line[std::min(j + 1, line.size() - 1)];
      nearest = std::min({nearest, to_piece(a, c, d), to_piece(c, a, b), to_piece(d, a, b)});
    }
  }
  return nearest;
}

// Edges no longer than that: where a line crosses one, an end of the edge is near.
Polygon fine(const Polygon& outline, double spacing_px) {
  Polygon points;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    const int parts = static_cast<int>(std::clamp(std::ceil(edge.norm() / spacing_px), 1.0, 10000.0));
    for (int k = 0; k < parts; ++k) points.push_back(outline[i] + k * edge / parts);
  }
  return points;
}

// Shifts every point across the outline until it has this area again.
Polygon with_area(Polygon outline, double area) {
  for (int round = 0; round < 8; ++round) {
    const double now = signed_area(outline);
    const double shift = (area - now) / perimeter(outline);
    if (std::abs(area - now) <= 1e-9 * std::abs(area)) break;
    const Polygon before = outline;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d along = before[(i + 1) % before.size()] - before[(i + before.size() - 1) % before.size()];
      // Outwards of a clockwise outline is to the left.
      if (along.norm() > 0.0) outline[i] += shift * Eigen::Vector2d(along.y(), -along.x()).normalized();
    }
  }
  return outline;
}

}  // namespace

void BrushStroke::check() const {
  if (line_px.empty()) throw Error("brush: the stroke has no points");
  const bool finite = std::all_of(line_px.begin(), line_px.end(), [](const auto& p) { return p.allFinite(); });
  if (!finite) throw Error("brush: the stroke has a point that is not finite");
  if (!in_range(radius_px, kLeastRadius_px, kMostRadius_px)) {
    throw Error("brush: the radius must be from 0.5 to 500 pixels");
  }
}

std::vector<Polygon> brushed(std::span<const Polygon> outlines, const BrushStroke& stroke) {
  stroke.check();
  std::vector<Polygon> result;
  std::vector<Polygon> touched;
  for (const Polygon& outline : outlines) {
    const bool near =
        distance_between(fine(outline, stroke.radius_px), stroke.line_px) < stroke.radius_px + kTouching_px;
    (near ? touched : result).push_back(outline);
  }
  // The others lie wholly on one side of the stroke. Inside an odd number of them, what is to be inside must be
  // enclosed by an even number of the rest, and the other way round.
  const bool inverted = encloses(result, stroke.line_px.front());
  const bool add = stroke.erase == inverted;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : stroke.line_px) box.extend(point);
  const cv::Rect window = window_around(touched, box, stroke.radius_px + kBand_px);
  DistanceField field = signed_distance(touched, window, kBand_px);
  const cv::Mat brush = stroke_distance(stroke.line_px, stroke.radius_px, window).values;
  field.values = add ? cv::Mat(cv::max(field.values, brush)) : cv::Mat(cv::min(field.values, -brush));
  const auto unchanged = [&stroke](const Eigen::Vector2d& point) {
    return distance_between(Polygon{point}, stroke.line_px) > stroke.radius_px + kTouching_px;
  };
  for (Polygon& outline : with_old_parts(outlines_at(field, 0.0, kLeastArea_px), touched, unchanged)) {
    result.push_back(std::move(outline));
  }
  return result;
}

std::vector<Polygon> grown(std::span<const Polygon> outlines, double distance_px) {
  if (!in_range(std::abs(distance_px), 0.0, kMostRadius_px)) {
    throw Error("outlines: can be grown by -500 to 500 pixels");
  }
  if (outlines.empty() || distance_px == 0.0) return {outlines.begin(), outlines.end()};
  const double reach = std::abs(distance_px) + kBand_px;
  const cv::Rect window = window_around(outlines, {}, std::max(distance_px, 0.0) + kBand_px);
  return thinned(outlines_at(signed_distance(outlines, window, reach), -distance_px, kLeastArea_px));
}

void CleanOptions::check() const {
  if (!in_range(close_px, 0.0, kMostRadius_px) || !in_range(open_px, 0.0, kMostRadius_px)) {
    throw Error("clean-up: radii must be from 0 to 500 pixels");
  }
  if (!(min_part_px >= 0.0 && fill_holes_px >= 0.0) || !std::isfinite(min_part_px + fill_holes_px)) {
    throw Error("clean-up: areas must not be negative; 0 leaves all as it is");
  }
}

std::vector<Polygon> cleaned(std::span<const Polygon> outlines, const CleanOptions& options) {
  options.check();
  std::vector<Polygon> now(outlines.begin(), outlines.end());
  if (options.close_px > 0.0) now = grown(grown(now, options.close_px), -options.close_px);
  if (options.open_px > 0.0) now = grown(grown(now, -options.open_px), options.open_px);
  const std::vector<Nesting> places = nesting(now);
  std::vector<Polygon> dropped;
  std::vector<Polygon> kept;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const double least = places[i] == Nesting::kHole ? options.fill_holes_px : options.min_part_px;
    (std::abs(signed_area(now[i])) < least ? dropped : kept).push_back(now[i]);
  }
  // What lies inside of something dropped goes with it: else a part in a hole would become a hole.
  std::erase_if(kept, [&](const Polygon& outline) {
    return std::any_of(dropped.begin(), dropped.end(),
                       [&](const Polygon& around) { return encloses(std::span(&around, 1), outline.front()); });
  });
  return kept;
}

std::vector<Polygon> evened_out(std::span<const Polygon> outlines, double width_px) {
  if (!in_range(width_px, 0.0, kMostWidth_px)) throw Error("smoothing: the width must be from 0 to 100 pixels");
  const std::vector<Polygon> drawn(outlines.begin(), outlines.end());
  for (double width = width_px; width > 0.25; width *= 0.5) {
    std::vector<Polygon> tried;
    for (const Polygon& outline : drawn) {
      const double area = signed_area(outline);
      const double length = perimeter(outline);
      // No more than a twelfth of the way around, or a circle would shrink to nothing.
      const double here = std::min(width, length / 12.0);
      const Polygon points = resampled(outline, std::min(kSmoothingSpacing_px, here), 8);
      const double spacing = length / static_cast<double>(points.size());
      const int passes = static_cast<int>(std::lround(2.0 * std::pow(here / spacing, 2)));  // each has variance 1/2
      tried.push_back(with_area(smoothed(points, std::max(passes, 1)), area));
    }
    if (!outline_fault(tried)) return tried;
  }
  return drawn;
}

}  // namespace fathom
