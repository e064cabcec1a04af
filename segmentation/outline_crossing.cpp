#include "segmentation/outline_crossing.h"

#include <algorithm>
#include <cmath>

namespace fathom {

using Eigen::Vector2d;

namespace {

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Whether a point of the line through a and b lies between them, and on neither.
bool strictly_between(const Vector2d& a, const Vector2d& b, const Vector2d& point) {
  const Vector2d along = b - a;
  const double margin = kTouchPx * along.norm();
  const double place = along.dot(point - a);
  return place > margin && place < along.squaredNorm() - margin;
}

bool same_direction(const Vector2d& a, const Vector2d& b) {
  return std::abs(cross(a, b)) <= kTouchPx * std::max(a.norm(), b.norm()) && a.dot(b) > 0.0;
}

// Whether b lies in the sector that is swept counter-clockwise from `from` to `to`.
bool in_sector(const Vector2d& from, const Vector2d& to, const Vector2d& b) {
  if (cross(from, to) > 0.0) return cross(from, b) > 0.0 && cross(b, to) > 0.0;
  return !(cross(to, b) > 0.0 && cross(b, from) > 0.0);
}

// Whether the outlines pass through each other at the point where edges i and j both start.
bool cross_at_corner(const OutlineEdges& edges, std::size_t i, std::size_t j) {
  const Vector2d& corner = edges.start(i);
  const Vector2d a_in = edges.start(edges.previous(i)) - corner;
  const Vector2d a_out = edges.end(i) - corner;
  const Vector2d b_in = edges.start(edges.previous(j)) - corner;
  const Vector2d b_out = edges.end(j) - corner;
  for (const Vector2d& b : {b_in, b_out}) {
    if (same_direction(a_in, b) || same_direction(a_out, b)) return false;  // they run along each other
  }
  return in_sector(a_in, a_out, b_in) != in_sector(a_in, a_out, b_out);
}

// Whether the corner at which edge j starts lies on edge i, and the outline passes from one side of i to the other.
bool crosses_through(const OutlineEdges& edges, std::size_t i, std::size_t j) {
  if (!strictly_between(edges.start(i), edges.end(i), edges.start(j))) return false;
  const int before = side_of_line(edges.start(i), edges.end(i), edges.start(edges.previous(j)));
  const int after = side_of_line(edges.start(i), edges.end(i), edges.end(j));
  return before * after < 0;
}

}  // namespace

int side_of_line(const Vector2d& a, const Vector2d& b, const Vector2d& point) {
  const Vector2d along = b - a;
  const double turn = cross(along, point - a);
  if (turn * turn <= kTouchPx * kTouchPx * along.squaredNorm()) return 0;
  return turn > 0.0 ? 1 : -1;
}

bool between(const Vector2d& a, const Vector2d& b, const Vector2d& point) {
  const Vector2d along = b - a;
  const double margin = kTouchPx * along.norm();
  const double place = along.dot(point - a);
  return place >= -margin && place <= along.squaredNorm() + margin;
}

std::optional<Vector2d> crossing(const OutlineEdges& edges, std::size_t i, std::size_t j) {
  const Vector2d& p = edges.start(i);
  const Vector2d& q = edges.end(i);
  const Vector2d& r = edges.start(j);
  const Vector2d& s = edges.end(j);
  const int r_side = side_of_line(p, q, r);
  const int s_side = side_of_line(p, q, s);
  if (r_side * s_side > 0) return std::nullopt;
  const int p_side = side_of_line(r, s, p);
  const int q_side = side_of_line(r, s, q);
  if (p_side * q_side > 0) return std::nullopt;
  if (r_side * s_side < 0 && p_side * q_side < 0) {
    const double share = cross(r - p, s - r) / cross(q - p, s - r);
    return Vector2d(p + share * (q - p));
  }
  if ((p - r).norm() <= kTouchPx) return cross_at_corner(edges, i, j) ? std::optional(p) : std::nullopt;
  if (r_side == 0 && crosses_through(edges, i, j)) return r;
  if (p_side == 0 && crosses_through(edges, j, i)) return p;
  return std::nullopt;
}

}  // namespace fathom
