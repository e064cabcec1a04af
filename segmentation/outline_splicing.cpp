#include "segmentation/outline_splicing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

constexpr double kTolerance_px = 0.05;  // of points that are left out

// A place on one of the old outlines: an edge, and a share of it.
struct Place {
  std::size_t outline = 0;
  double along = 0.0;  // the edge's number and the share
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
};

Place nearest_place(std::span<const Polygon> outlines, const Eigen::Vector2d& point) {
  Place best;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    for (std::size_t i = 0; i < outlines[k].size(); ++i) {
      const Eigen::Vector2d& a = outlines[k][i];
      const Eigen::Vector2d edge = outlines[k][(i + 1) % outlines[k].size()] - a;
      const double length = edge.squaredNorm();
      const double share = length > 0.0 ? std::clamp((point - a).dot(edge) / length, 0.0, 1.0) : 0.0;
      const double distance = (point - a - share * edge).squaredNorm();
      if (distance >= nearest) continue;
      nearest = distance;
      best = {k, static_cast<double>(i) + share, a + share * edge};
    }
  }
  return best;
}

Polygon fewer_points(const Polygon& line, bool closed) {
  if (line.size() < 3) return line;
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& p : line) {
    const Eigen::Vector2d moved = p - line.front();  // floats are fine for the size, not for the place
    points.emplace_back(static_cast<float>(moved.x()), static_cast<float>(moved.y()));
  }
  std::vector<cv::Point2f> fewer;
  cv::approxPolyDP(points, fewer, kTolerance_px, closed);
  if (closed && fewer.size() < 3) return line;
  Polygon made;
  for (const cv::Point2f& p : fewer) made.push_back(line.front() + Eigen::Vector2d(p.x, p.y));
  return made;
}

// The old outline from where a run of unchanged points starts to where it ends, the way that its middle lies.
Polygon old_part(std::span<const Polygon> old, const Polygon& run) {
  const Place first = nearest_place(old, run.front());
  const Place middle = nearest_place(old, run[run.size() / 2]);
  const Place last = nearest_place(old, run.back());
  if (run.size() < 3 || first.outline != middle.outline || last.outline != middle.outline) {
    return fewer_points(run, false);
  }
  const Polygon& outline = old[first.outline];
  const auto count = static_cast<double>(outline.size());
  const auto ahead = [count](double from, double to) { return to >= from ? to - from : to - from + count; };
  const bool forward = ahead(first.along, middle.along) <= ahead(first.along, last.along);
  Polygon part = {first.point};
  const double whole = forward ? ahead(first.along, last.along) : ahead(last.along, first.along);
  const double start = forward ? std::floor(first.along) + 1.0 : std::ceil(first.along) - 1.0;
  for (double i = 0.0; i < count; i += 1.0) {
    const double corner = std::fmod((forward ? start + i : start - i) + 2.0 * count, count);
    if ((forward ? ahead(first.along, corner) : ahead(corner, first.along)) >= whole) break;
    part.push_back(outline[static_cast<std::size_t>(corner)]);
  }
  part.push_back(last.point);
  return part;
}

Polygon spliced(const Polygon& made, std::span<const Polygon> old,
                const std::function<bool(const Eigen::Vector2d&)>& unchanged) {
  std::vector<bool> same;
  for (const Eigen::Vector2d& point : made) same.push_back(unchanged(point));
  const auto changed = std::find(same.begin(), same.end(), false);
  if (changed == same.end()) return old[nearest_place(old, made.front()).outline];
  // From the start of a changed run on, so that no run goes beyond the end.
  std::size_t start = static_cast<std::size_t>(changed - same.begin());
  const std::size_t count = made.size();
  for (std::size_t i = 0; i < count && !same[(start + count - 1) % count]; ++i) start = (start + count - 1) % count;
  if (std::find(same.begin(), same.end(), true) == same.end()) return fewer_points(made, true);
  Polygon result;
  for (std::size_t done = 0; done < count;) {
    const bool kept = same[(start + done) % count];
    Polygon run;
    while (done < count && same[(start + done) % count] == kept) run.push_back(made[(start + done++) % count]);
    const Polygon part = kept ? old_part(old, run) : fewer_points(run, false);
    result.insert(result.end(), part.begin(), part.end());
  }
  return result;
}

}  // namespace

std::vector<Polygon> thinned(std::vector<Polygon> outlines) {
  std::vector<Polygon> fewer;
  for (const Polygon& outline : outlines) fewer.push_back(fewer_points(outline, true));
  return outline_fault(fewer) ? outlines : fewer;
}

std::vector<Polygon> with_old_parts(const std::vector<Polygon>& made, std::span<const Polygon> old,
                                    const std::function<bool(const Eigen::Vector2d&)>& unchanged) {
  if (old.empty()) return thinned(made);
  std::vector<Polygon> result;
  for (const Polygon& outline : made) result.push_back(spliced(outline, old, unchanged));
  return outline_fault(result) ? thinned(made) : result;
}

}  // namespace fathom
