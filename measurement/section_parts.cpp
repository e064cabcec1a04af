#include "measurement/section_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

double signed_area(const Polygon& polygon) {
  double twice = 0.0;
  const Eigen::Vector2d* from = &polygon.back();
  for (const Eigen::Vector2d& to : polygon) {
    twice += (*from - polygon.front()).x() * (to - polygon.front()).y() -
             (*from - polygon.front()).y() * (to - polygon.front()).x();
    from = &to;
  }
  return 0.5 * twice;
}

Eigen::Vector2d first_moment(const Polygon& polygon) {
  // About the first point, then shifted: small numbers keep their digits.
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  const Eigen::Vector2d origin = polygon.front();
  Eigen::Vector2d from = polygon.back() - origin;
  for (const Eigen::Vector2d& point : polygon) {
    const Eigen::Vector2d to = point - origin;
    sum += (from.x() * to.y() - from.y() * to.x()) * (from + to) / 6.0;
    from = to;
  }
  return sum + signed_area(polygon) * origin;
}

Eigen::AlignedBox2d bounds(const Polygon& polygon) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : polygon) box.extend(point);
  return box;
}

// Most points of a hole decide: single ones may lie on the outline around it.
bool lies_in(const Polygon& hole, const Polygon& outline) {
  std::size_t inside = 0;
  for (const Eigen::Vector2d& point : hole) {
    bool in = false;
    const Eigen::Vector2d* from = &outline.back();
    for (const Eigen::Vector2d& to : outline) {
      if ((from->y() <= point.y()) != (to.y() <= point.y())) {
        const double x = from->x() + (to.x() - from->x()) * (point.y() - from->y()) / (to.y() - from->y());
        in ^= point.x() < x;
      }
      from = &to;
    }
    inside += in ? 1 : 0;
  }
  return 2 * inside > hole.size();
}

// The part that a hole is in: the smallest around it, where parts are nested in holes of others.
std::size_t smallest_around(const Polygon& hole, const std::vector<const Polygon*>& outlines,
                            const std::vector<Nesting>& nestings) {
  std::size_t best = outlines.size();
  double best_area = 0.0;
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    if (nestings[i] != Nesting::kPart || !lies_in(hole, *outlines[i])) continue;
    const double area = std::abs(signed_area(*outlines[i]));
    if (best < outlines.size() && area >= best_area) continue;
    best = i;
    best_area = area;
  }
  return best;
}

SectionPart part_of(std::shared_ptr<const SectionShape> shape) {
  SectionPart part;
  if (shape->kind() == SectionKind::kPoint) {
    part.centroid_mm = shape->inside_discs().front().centre_mm;
    part.size_mm = Eigen::Vector2d::Zero();
  } else {
    // The first outline is the outer one; the others are holes.
    double area = 0.0;
    Eigen::Vector2d moment = Eigen::Vector2d::Zero();
    for (const Polygon& outline : shape->outlines_mm()) {
      const double own = signed_area(outline);
      const double factor = (own < 0.0) == (&outline == &shape->outlines_mm().front()) ? -1.0 : 1.0;
      area += factor * own;
      moment += factor * first_moment(outline);
    }
    const Eigen::AlignedBox2d box = bounds(shape->outlines_mm().front());
    part.centroid_mm = std::abs(area) > 0.0 ? Eigen::Vector2d(moment / area) : Eigen::Vector2d(box.center());
    part.size_mm = box.sizes();
  }
  part.shape = std::move(shape);
  return part;
}

std::size_t nearest(const SectionPart& part, const std::vector<SectionPart>& others) {
  const auto closest = std::min_element(others.begin(), others.end(), [&](const SectionPart& a, const SectionPart& b) {
    return (a.centroid_mm - part.centroid_mm).squaredNorm() < (b.centroid_mm - part.centroid_mm).squaredNorm();
  });
  return static_cast<std::size_t>(closest - others.begin());
}

}  // namespace

bool parts_meet(const SectionPart& a, const SectionPart& b) {
  if (a.shape->kind() == SectionKind::kPoint) return b.shape->distance_mm(a.centroid_mm) >= 0.0F;
  const SectionRaster& raster = a.shape->raster();
  const Eigen::AlignedBox2d box = bounds(a.shape->outlines_mm().front());
  const Eigen::Vector2i from = ((box.min() - raster.origin_mm) / raster.cell_mm).cast<int>();
  const Eigen::Vector2i to = ((box.max() - raster.origin_mm) / raster.cell_mm).cast<int>();
  for (int j = from.y(); j <= to.y(); ++j) {
    for (int i = from.x(); i <= to.x(); ++i) {
      const Eigen::Vector2d ab = raster.origin_mm + raster.cell_mm * Eigen::Vector2d(i, j);
      if (a.shape->distance_mm(ab) >= 0.0F && b.shape->distance_mm(ab) >= 0.0F) return true;
    }
  }
  return b.shape->kind() == SectionKind::kPoint && a.shape->distance_mm(b.centroid_mm) >= 0.0F;
}

std::vector<SectionPart> section_parts(const std::shared_ptr<const SectionShape>& shape) {
  if (shape->kind() == SectionKind::kAbsent) return {};
  if (shape->kind() == SectionKind::kPoint || shape->outlines_mm().size() == 1) return {part_of(shape)};
  std::vector<const Polygon*> outlines;
  for (const Polygon& outline : shape->outlines_mm()) outlines.push_back(&outline);
  const std::vector<Nesting> nestings = nesting(outlines);
  std::vector<SectionPart> parts;
  for (std::size_t outer = 0; outer < outlines.size(); ++outer) {
    if (nestings[outer] != Nesting::kPart) continue;
    std::vector<Polygon> polygons = {*outlines[outer]};
    for (std::size_t hole = 0; hole < outlines.size(); ++hole) {
      if (nestings[hole] != Nesting::kHole) continue;
      if (smallest_around(*outlines[hole], outlines, nestings) == outer) polygons.push_back(*outlines[hole]);
    }
    const SectionRaster raster = section_raster(polygons, shape->cell_mm());
    parts.push_back(part_of(std::make_shared<SectionShape>(std::move(polygons), raster)));
  }
  return parts;
}

std::vector<PartPair> matching_parts(const std::shared_ptr<const SectionShape>& first,
                                     const std::shared_ptr<const SectionShape>& second) {
  const std::vector<SectionPart> a = section_parts(first);
  const std::vector<SectionPart> b = section_parts(second);
  std::vector<PartPair> pairs;
  if (a.empty() || b.empty()) {
    for (const SectionPart& part : a) pairs.push_back({part, {}});
    for (const SectionPart& part : b) pairs.push_back({{}, part});
    return pairs;
  }
  std::vector<std::vector<bool>> joined(a.size(), std::vector<bool>(b.size(), false));
  std::vector<bool> a_overlaps(a.size(), false);
  std::vector<bool> b_overlaps(b.size(), false);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) {
      if (parts_meet(a[i], b[k])) joined[i][k] = a_overlaps[i] = b_overlaps[k] = true;
    }
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!a_overlaps[i]) joined[i][nearest(a[i], b)] = true;
  }
  for (std::size_t k = 0; k < b.size(); ++k) {
    if (!b_overlaps[k]) joined[nearest(b[k], a)][k] = true;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) {
      if (joined[i][k]) pairs.push_back({a[i], b[k]});
    }
  }
  return pairs;
}

}  // namespace fathom
