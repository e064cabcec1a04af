#include "surface/self_intersections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>

#include "surface/exact_orientation.h"

namespace fathom {

namespace {

constexpr std::size_t kLeaf = 4;  // triangles in a box that is not divided any more

using Corners = std::array<Eigen::Vector3d, 3>;

Corners corners_of(const Mesh& mesh, std::size_t t) {
  const auto at = [&](std::size_t k) -> const Eigen::Vector3d& {
    return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])];
  };
  return {at(0), at(1), at(2)};
}

/// Along one axis.
Eigen::Vector2d projected(const Eigen::Vector3d& point, int axis) {
  return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
}

/// The axis along which a triangle looks largest; empty if it has no area along any.
std::optional<int> projection_axis(const Corners& triangle) {
  const Eigen::Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).cwiseAbs();
  std::array<int, 3> axes = {0, 1, 2};
  std::sort(axes.begin(), axes.end(),
            [&](int i, int j) { return normal[i] != normal[j] ? normal[i] > normal[j] : i < j; });
  for (const int axis : axes) {
    if (orientation(projected(triangle[0], axis), projected(triangle[1], axis), projected(triangle[2], axis)) != 0) {
      return axis;
    }
  }
  return std::nullopt;
}

bool segments_meet(const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& a,
                   const Eigen::Vector2d& b) {
  const int at_p = orientation(a, b, p);
  const int at_q = orientation(a, b, q);
  if (at_p * at_q > 0) return false;
  if (at_p == 0 && at_q == 0) {  // on one line, where boxes decide
    return std::max(std::min(p.x(), q.x()), std::min(a.x(), b.x())) <=
               std::min(std::max(p.x(), q.x()), std::max(a.x(), b.x())) &&
           std::max(std::min(p.y(), q.y()), std::min(a.y(), b.y())) <=
               std::min(std::max(p.y(), q.y()), std::max(a.y(), b.y()));
  }
  return orientation(p, q, a) * orientation(p, q, b) <= 0;
}

/// All in one plane.
bool flat_segment_meets(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Corners& triangle, int axis) {
  const Eigen::Vector2d from = projected(p, axis);
  const Eigen::Vector2d to = projected(q, axis);
  int left = 0;
  int right = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector2d a = projected(triangle[k], axis);
    const Eigen::Vector2d b = projected(triangle[(k + 1) % 3], axis);
    if (segments_meet(from, to, a, b)) return true;
    const int side = orientation(a, b, from);
    left += side > 0;
    right += side < 0;
  }
  return left == 3 || right == 3;
}

/// Whether the segment from `p` to `q` has a point in common with a triangle that has an area.
bool segment_meets(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Corners& triangle, int axis) {
  const auto& [a, b, c] = triangle;
  const int at_p = orientation(a, b, c, p);
  const int at_q = orientation(a, b, c, q);
  if (at_p * at_q > 0) return false;
  if (at_p == 0 && at_q == 0) return flat_segment_meets(p, q, triangle, axis);
  const int ab = orientation(p, q, a, b);
  const int bc = orientation(p, q, b, c);
  if (ab * bc < 0) return false;
  const int ca = orientation(p, q, c, a);
  return bc * ca >= 0 && ca * ab >= 0;
}

/// Decides about pairs of triangles of one mesh.
class PairTest {
 public:
  explicit PairTest(const Mesh& mesh) : mesh_(mesh), axes_(mesh.triangles.size()) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) axes_[t] = projection_axis(corners_of(mesh, t));
  }

  bool has_area(std::size_t t) const { return axes_[t].has_value(); }

  bool operator()(std::size_t t, std::size_t u) const {
    // Corner i of t is corner matches[i] of u.
    std::array<std::size_t, 3> matches = {3, 3, 3};
    std::size_t shared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        if (mesh_.triangles[t][i] != mesh_.triangles[u][j]) continue;
        matches[i] = j;
        ++shared;
      }
    }
    if (shared == 3) return true;
    const Corners a = corners_of(mesh_, t);
    const Corners b = corners_of(mesh_, u);
    if (shared == 2) return folded(a, b, matches, *axes_[t]);
    if (surely_apart(a, b, matches, *axes_[t])) return false;
    if (shared == 1) {
      const std::size_t i = matches[0] < 3 ? 0 : matches[1] < 3 ? 1 : 2;
      const std::size_t j = matches[i];
      // What the triangles share is convex: more than their common corner reaches to the side opposite of one.
      return segment_meets(a[(i + 1) % 3], a[(i + 2) % 3], b, *axes_[u]) ||
             segment_meets(b[(j + 1) % 3], b[(j + 2) % 3], a, *axes_[t]);
    }
    if (on_one_side(a, b) || on_one_side(b, a)) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      if (segment_meets(a[k], a[(k + 1) % 3], b, *axes_[u])) return true;
      if (segment_meets(b[k], b[(k + 1) % 3], a, *axes_[t])) return true;
    }
    return false;
  }

 private:
  static bool on_one_side(const Corners& points, const Corners& plane) {
    const int first = orientation(plane[0], plane[1], plane[2], points[0]);
    return first != 0 && first == orientation(plane[0], plane[1], plane[2], points[1]) &&
           first == orientation(plane[0], plane[1], plane[2], points[2]);
  }

  // Two triangles with a side in common lie on each other if they are in one plane, on the same side of it.
  static bool folded(const Corners& a, const Corners& b, const std::array<std::size_t, 3>& matches, int axis) {
    const std::size_t lone = matches[0] == 3 ? 0 : matches[1] == 3 ? 1 : 2;
    const std::size_t other = 3 - matches[(lone + 1) % 3] - matches[(lone + 2) % 3];
    const Eigen::Vector2d from = projected(a[(lone + 1) % 3], axis);
    const Eigen::Vector2d to = projected(a[(lone + 2) % 3], axis);
    // The exact test of the plane is slow just where a surface is flat; there this one mostly answers.
    const int own = orientation(from, to, projected(a[lone], axis));
    if (certain_orientation(from, to, projected(b[other], axis)) == -own) return false;
    return orientation(a[0], a[1], a[2], b[other]) == 0 && orientation(from, to, projected(b[other], axis)) == own;
  }

  // Whether, seen along an axis, a side of one triangle divides it from the other. Never in doubt when true; spares
  // the exact tests where a surface is flat. A shared corner must be an end of that side.
  static bool surely_apart(const Corners& a, const Corners& b, const std::array<std::size_t, 3>& matches, int axis) {
    std::array<std::size_t, 3> back = {3, 3, 3};
    for (std::size_t i = 0; i < 3; ++i) {
      if (matches[i] < 3) back[matches[i]] = i;
    }
    return divides(a, b, matches, back, axis) || divides(b, a, back, matches, axis);
  }

  static bool divides(const Corners& a, const Corners& b, const std::array<std::size_t, 3>& matches,
                      const std::array<std::size_t, 3>& back, int axis) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t opposite = (k + 2) % 3;
      if (matches[opposite] < 3) continue;
      const Eigen::Vector2d from = projected(a[k], axis);
      const Eigen::Vector2d to = projected(a[(k + 1) % 3], axis);
      const int own = certain_orientation(from, to, projected(a[opposite], axis));
      if (own == 0) continue;
      bool apart = true;
      for (std::size_t j = 0; j < 3 && apart; ++j) {
        apart = back[j] < 3 || certain_orientation(from, to, projected(b[j], axis)) == -own;
      }
      if (apart) return true;
    }
    return false;
  }

  const Mesh& mesh_;
  std::vector<std::optional<int>> axes_;
};

/// Boxes in boxes around triangles. Unlike the cells of a grid they also suit a mesh of large and small triangles, such
/// as one with flat caps.
class BoxTree {
 public:
  BoxTree(const Mesh& mesh, const PairTest& test) {
    boxes_.resize(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (!test.has_area(t)) continue;
      for (const Eigen::Vector3d& corner : corners_of(mesh, t)) boxes_[t].extend(corner);
      order_.push_back(t);
    }
    if (!order_.empty()) divide(0, order_.size());
  }

  /// Calls `found(t, u)` for the pairs whose boxes overlap, until it returns false.
  template <typename Found>
  void for_each_pair(Found found) const {
    if (nodes_.empty()) return;
    std::vector<std::pair<std::size_t, std::size_t>> open = {{0, 0}};
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      const Node& a = nodes_[i];
      const Node& b = nodes_[j];
      if (!a.box.intersects(b.box)) continue;
      if (i == j && a.right != 0) {
        open.insert(open.end(), {{i + 1, i + 1}, {a.right, a.right}, {i + 1, a.right}});
      } else if (a.right == 0 && b.right == 0) {
        for (std::size_t k = a.begin; k < a.end; ++k) {
          for (std::size_t l = i == j ? k + 1 : b.begin; l < b.end; ++l) {
            const auto [t, u] = std::minmax(order_[k], order_[l]);
            if (boxes_[t].intersects(boxes_[u]) && !found(t, u)) return;
          }
        }
      } else if (b.right == 0 || (a.right != 0 && a.end - a.begin >= b.end - b.begin)) {
        open.insert(open.end(), {{i + 1, j}, {a.right, j}});
      } else {
        open.insert(open.end(), {{i, j + 1}, {i, b.right}});
      }
    }
  }

 private:
  /// Of triangles `begin` to `end - 1` in `order_`. The left half is the next node; without halves `right` is 0.
  struct Node {
    Eigen::AlignedBox3d box;
    std::size_t begin = 0;
    std::size_t end = 0;
    std::size_t right = 0;
  };

  void divide(std::size_t begin, std::size_t end) {
    const std::size_t self = nodes_.size();
    nodes_.push_back({{}, begin, end, 0});
    Eigen::AlignedBox3d middles;
    for (std::size_t k = begin; k < end; ++k) {
      nodes_[self].box.extend(boxes_[order_[k]]);
      middles.extend(boxes_[order_[k]].center());
    }
    if (end - begin <= kLeaf) return;
    Eigen::Index axis = 0;
    middles.sizes().maxCoeff(&axis);
    const std::size_t half = begin + (end - begin) / 2;
    const auto at = [&](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(at(begin), at(half), at(end), [&](std::size_t t, std::size_t u) {
      const double of_t = boxes_[t].min()[axis] + boxes_[t].max()[axis];
      const double of_u = boxes_[u].min()[axis] + boxes_[u].max()[axis];
      return of_t != of_u ? of_t < of_u : t < u;
    });
    divide(begin, half);
    nodes_[self].right = nodes_.size();
    divide(half, end);
  }

  std::vector<Eigen::AlignedBox3d> boxes_;  // by triangle
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace

std::vector<std::pair<std::int32_t, std::int32_t>> self_intersections(const Mesh& mesh, std::size_t limit) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  const PairTest test(mesh);
  BoxTree(mesh, test).for_each_pair([&](std::size_t t, std::size_t u) {
    if (pairs.size() == limit) return false;
    if (test(t, u)) pairs.emplace_back(static_cast<std::int32_t>(t), static_cast<std::int32_t>(u));
    return true;
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace fathom
