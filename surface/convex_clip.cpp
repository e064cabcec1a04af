#include "surface/convex_clip.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fathom {

namespace {

using Plane = Eigen::Hyperplane<double, 3>;

// The convex polygon through points of a plane, in order of their angle about their middle.
Polygon3 ordered_about_middle(Polygon3 points, const Eigen::Vector3d& normal) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) centre += point;
  centre /= static_cast<double>(points.size());
  const Eigen::Vector3d across = normal.unitOrthogonal();
  const Eigen::Vector3d up = normal.cross(across);
  std::vector<std::pair<double, Eigen::Vector3d>> keyed;
  for (const Eigen::Vector3d& point : points) {
    keyed.emplace_back(std::atan2((point - centre).dot(up), (point - centre).dot(across)), point);
  }
  std::sort(keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = keyed[i].second;
  return points;
}

}  // namespace

Eigen::Vector3d vector_area(const Polygon3& polygon) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    sum += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  }
  return 0.5 * sum;
}

SplitPolygon split_polygon(const Polygon3& polygon, const Plane& plane) {
  SplitPolygon parts;
  if (polygon.empty()) return parts;
  bool any_above = false;
  bool any_below = false;
  const Eigen::Vector3d* before = &polygon.back();
  double before_distance = plane.signedDistance(*before);
  for (const Eigen::Vector3d& point : polygon) {
    const double distance = plane.signedDistance(point);
    if (before_distance > 0.0 && distance < 0.0) {
      const Eigen::Vector3d cut = plane_crossing(*before, before_distance, point, distance);
      parts.positive.push_back(cut);
      parts.negative.push_back(cut);
    } else if (before_distance < 0.0 && distance > 0.0) {
      const Eigen::Vector3d cut = plane_crossing(point, distance, *before, before_distance);
      parts.positive.push_back(cut);
      parts.negative.push_back(cut);
    }
    if (distance >= 0.0) parts.positive.push_back(point);
    if (distance <= 0.0) parts.negative.push_back(point);
    any_above = any_above || distance > 0.0;
    any_below = any_below || distance < 0.0;
    before = &point;
    before_distance = distance;
  }
  if (!any_above) parts.positive.clear();
  if (!any_below) parts.negative.clear();
  // A polygon that lies in the plane must not vanish: it goes to the positive side.
  if (!any_above && !any_below) parts.positive = polygon;
  return parts;
}

Polygon3 clip_polygon(Polygon3 polygon, const std::vector<Plane>& planes) {
  for (const Plane& plane : planes) polygon = split_polygon(polygon, plane).positive;
  return polygon;
}

std::vector<Polygon3> clip_line(const Polygon3& line, const std::vector<Plane>& planes) {
  std::vector<Polygon3> pieces{line};
  for (const Plane& plane : planes) {
    std::vector<Polygon3> clipped;
    for (const Polygon3& piece : pieces) {
      Polygon3 part;
      for (std::size_t i = 0; i < piece.size(); ++i) {
        const double distance = plane.signedDistance(piece[i]);
        const double before = i == 0 ? distance : plane.signedDistance(piece[i - 1]);
        if (before < 0.0 && distance > 0.0) part.push_back(plane_crossing(piece[i], distance, piece[i - 1], before));
        if (before > 0.0 && distance < 0.0) part.push_back(plane_crossing(piece[i - 1], before, piece[i], distance));
        if (distance >= 0.0) part.push_back(piece[i]);
        if (distance >= 0.0) continue;
        if (part.size() > 1) clipped.push_back(std::move(part));
        part.clear();
      }
      if (part.size() > 1) clipped.push_back(std::move(part));
    }
    pieces = std::move(clipped);
  }
  return pieces;
}

ConvexBody make_cube(const Eigen::Vector3d& centre, double half) {
  ConvexBody cube;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-half, half}) {
      Polygon3 face;
      for (const auto& [u, v] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
        Eigen::Vector3d corner = centre;
        corner[axis] += side;
        corner[(axis + 1) % 3] += u * half;
        corner[(axis + 2) % 3] += v * half;
        face.push_back(corner);
      }
      cube.faces.push_back(std::move(face));
    }
  }
  return cube;
}

Eigen::Vector3d middle(const ConvexBody& body) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  for (const Polygon3& face : body.faces) {
    for (const Eigen::Vector3d& corner : face) sum += corner;
    count += face.size();
  }
  return sum / static_cast<double>(count);
}

SplitBody split_body(const ConvexBody& body, const Plane& plane, double tolerance_mm) {
  double above = 0.0;
  double below = 0.0;
  for (const Polygon3& face : body.faces) {
    for (const Eigen::Vector3d& corner : face) {
      const double distance = plane.signedDistance(corner);
      above = std::max(above, distance);
      below = std::max(below, -distance);
    }
  }
  if (below <= tolerance_mm) return {body, {}};
  if (above <= tolerance_mm) return {{}, body};
  SplitBody parts;
  Polygon3 cut;
  for (const Polygon3& face : body.faces) {
    SplitPolygon split = split_polygon(face, plane);
    if (!split.positive.empty() && !split.negative.empty()) {
      for (const Eigen::Vector3d& corner : split.positive) {
        if (std::abs(plane.signedDistance(corner)) <= 1e-3 * tolerance_mm) cut.push_back(corner);
      }
    }
    if (split.positive.size() > 2) parts.positive.faces.push_back(std::move(split.positive));
    if (split.negative.size() > 2) parts.negative.faces.push_back(std::move(split.negative));
  }
  if (cut.size() > 2) {
    // Every corner of the cut came from two faces: once is enough.
    Polygon3 ordered = ordered_about_middle(std::move(cut), plane.normal());
    Polygon3 lid;
    for (const Eigen::Vector3d& corner : ordered) {
      if (lid.empty() || (corner - lid.back()).norm() > 1e-3 * tolerance_mm) lid.push_back(corner);
    }
    parts.positive.faces.push_back(lid);
    parts.negative.faces.push_back(std::move(lid));
  }
  return parts;
}

}  // namespace fathom
