#include "registration/partition.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/error.h"

namespace fathom {

namespace {

constexpr double kReach = 20.0;     // radii of the data within which cells are looked for
constexpr double kThinnest = 1e-7;  // of that reach: a thinner cell comes from rounding, or holds no pixel
constexpr int kDiscCorners = 64;    // a disc drawn with fewer looks angular
constexpr double kUnitTolerance = 1e-6;

std::uint32_t bit(std::size_t plane) { return std::uint32_t{1} << plane; }

void require_plane(const DividingPlane& plane) {
  if (!plane.coeffs().allFinite()) throw Error("a dividing plane is not finite; give it a normal and an offset");
  if (std::abs(plane.normal().norm() - 1.0) > kUnitTolerance) {
    throw Error("a dividing plane's normal is not a unit vector; divide it by its length");
  }
}

void require_count(std::size_t planes) {
  if (planes > SpacePartition::kMaxPlanes) {
    throw Error("more than 32 dividing planes; remove those that separate nothing");
  }
}

}  // namespace

void SweepShape::add(const Eigen::Affine3d& reference_from_image, int width, int height) {
  const double right = width - 1.0;
  const double bottom = height - 1.0;
  const auto place = [&](double x, double y) -> Eigen::Vector3d {
    return reference_from_image * Eigen::Vector3d(x, y, 0.0);
  };
  centres_mm.push_back(place(0.5 * right, 0.5 * bottom));
  last_corners_mm = {place(0.0, 0.0), place(right, 0.0), place(right, bottom), place(0.0, bottom)};
  if (first_corners_mm.empty()) first_corners_mm = last_corners_mm;
}

Eigen::Vector3d SweepShape::centre_mm() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& centre : centres_mm) sum += centre;
  return sum / static_cast<double>(centres_mm.size());
}

SweepShape sweep_shape(const Sweep& sweep, const FrameLocator& locator, int width, int height) {
  SweepShape shape;
  for (int frame = std::max(0, sweep.first); frame <= std::min(sweep.last, locator.frame_count() - 1); ++frame) {
    const auto map = locator.reference_from_image(frame);
    if (map) shape.add(*map, width, height);
  }
  if (shape.centres_mm.empty()) {
    throw Error(locator.recording_name() + ": no frame from " + std::to_string(sweep.first) + " to " +
                std::to_string(sweep.last) + " has a pose; drop this sweep");
  }
  return shape;
}

SpacePartition::SpacePartition(std::vector<SweepShape> sweeps, std::vector<DividingPlane> planes)
    : sweeps_(std::move(sweeps)), planes_(std::move(planes)) {
  require_count(planes_.size());
  for (const DividingPlane& plane : planes_) require_plane(plane);
  Eigen::AlignedBox3d box;
  for (const SweepShape& sweep : sweeps_) {
    assert(!sweep.centres_mm.empty());
    for (const auto* points : {&sweep.centres_mm, &sweep.first_corners_mm, &sweep.last_corners_mm}) {
      for (const Eigen::Vector3d& point : *points) box.extend(point);
    }
  }
  if (!box.isEmpty()) {
    centre_mm_ = box.center();
    radius_mm_ = std::max(1.0, 0.5 * box.diagonal().norm());
  }
  update();
}

void SpacePartition::add(const DividingPlane& plane) {
  require_count(planes_.size() + 1);
  require_plane(plane);
  planes_.push_back(plane);
  update();
}

void SpacePartition::move(std::size_t plane, const DividingPlane& to) {
  assert(plane < planes_.size());
  require_plane(to);
  planes_[plane] = to;
  update();
}

void SpacePartition::remove(std::size_t plane) {
  assert(plane < planes_.size());
  planes_.erase(planes_.begin() + static_cast<std::ptrdiff_t>(plane));
  update();
}

std::size_t SpacePartition::remove_redundant() {
  std::size_t removed = 0;
  for (std::size_t i = 0; i < planes_.size();) {
    if (separates(i)) {
      ++i;
      continue;
    }
    remove(i);
    ++removed;
    i = 0;  // assignments may have changed, so that another plane separates no more
  }
  return removed;
}

void SpacePartition::update() {
  distances_mm_.clear();
  for (const SweepShape& sweep : sweeps_) {
    Eigen::ArrayXXd distances(sweep.centres_mm.size(), planes_.size());
    for (std::size_t j = 0; j < planes_.size(); ++j) {
      for (std::size_t i = 0; i < sweep.centres_mm.size(); ++i) {
        distances(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            planes_[j].signedDistance(sweep.centres_mm[i]);
      }
    }
    distances_mm_.push_back(std::move(distances));
  }
  // Cut a large cube by one plane after another: only cells that exist are ever held.
  const double reach_mm = kReach * std::max(1.0, radius_mm_);
  std::vector<std::pair<std::uint32_t, ConvexBody>> bodies{{0, make_cube(centre_mm_, reach_mm)}};
  for (std::size_t j = 0; j < planes_.size(); ++j) {
    std::vector<std::pair<std::uint32_t, ConvexBody>> cut;
    for (const auto& [sides, body] : bodies) {
      SplitBody parts = split_body(body, planes_[j], kThinnest * reach_mm);
      if (!parts.negative.faces.empty()) cut.emplace_back(sides, std::move(parts.negative));
      if (!parts.positive.faces.empty()) cut.emplace_back(sides | bit(j), std::move(parts.positive));
    }
    bodies = std::move(cut);
  }
  cells_.clear();
  for (const auto& [sides, body] : bodies) cells_.push_back({sides, best_sweep(sides), 0, middle(body)});
  std::sort(cells_.begin(), cells_.end(), [](const Cell& a, const Cell& b) { return a.sides < b.sides; });

  // Cells whose sides differ in one plane only share a face of it.
  regions_ = 0;
  std::vector<bool> seen(cells_.size(), false);
  for (std::size_t start = 0; start < cells_.size(); ++start) {
    if (seen[start]) continue;
    std::vector<std::size_t> waiting{start};
    seen[start] = true;
    while (!waiting.empty()) {
      const std::size_t at = waiting.back();
      waiting.pop_back();
      cells_[at].region = regions_;
      for (std::size_t j = 0; j < planes_.size(); ++j) {
        const Cell* next = find_cell(cells_[at].sides ^ bit(j));
        if (next == nullptr || next->sweep != cells_[at].sweep) continue;
        const auto index = static_cast<std::size_t>(next - cells_.data());
        if (seen[index]) continue;
        seen[index] = true;
        waiting.push_back(index);
      }
    }
    ++regions_;
  }
}

std::optional<std::size_t> SpacePartition::best_sweep(std::uint32_t sides) const {
  if (sweeps_.empty()) return {};
  if (sweeps_.size() == 1) return 0;
  if (planes_.empty()) return {};
  // Equation (4.2).
  std::size_t best = 0;
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < sweeps_.size(); ++s) {
    Eigen::ArrayXd least = Eigen::ArrayXd::Constant(distances_mm_[s].rows(), std::numeric_limits<double>::infinity());
    for (std::size_t j = 0; j < planes_.size(); ++j) {
      const double sign = (sides & bit(j)) != 0 ? 1.0 : -1.0;
      least = least.min(sign * distances_mm_[s].col(static_cast<Eigen::Index>(j)));
    }
    const double inside = least.mean();
    if (inside > largest) {
      largest = inside;
      best = s;
    }
  }
  return best;
}

const SpacePartition::Cell* SpacePartition::find_cell(std::uint32_t sides) const {
  const auto found = std::lower_bound(cells_.begin(), cells_.end(), sides,
                                      [](const Cell& cell, std::uint32_t value) { return cell.sides < value; });
  return found != cells_.end() && found->sides == sides ? &*found : nullptr;
}

std::uint32_t SpacePartition::sides_at(const Eigen::Vector3d& point_mm) const {
  std::uint32_t sides = 0;
  for (std::size_t j = 0; j < planes_.size(); ++j) {
    if (planes_[j].signedDistance(point_mm) >= 0.0) sides |= bit(j);
  }
  return sides;
}

std::optional<std::size_t> SpacePartition::sweep_at(const Eigen::Vector3d& point_mm) const {
  const std::uint32_t sides = sides_at(point_mm);
  const Cell* cell = find_cell(sides);
  return cell != nullptr ? cell->sweep : best_sweep(sides);
}

std::optional<std::size_t> SpacePartition::sweep_in(std::size_t region) const {
  const auto cell =
      std::find_if(cells_.begin(), cells_.end(), [&](const Cell& candidate) { return candidate.region == region; });
  return cell != cells_.end() ? cell->sweep : std::nullopt;
}

bool SpacePartition::separates(std::size_t plane) const {
  return std::any_of(cells_.begin(), cells_.end(), [&](const Cell& cell) {
    const Cell* other = find_cell(cell.sides ^ bit(plane));
    return other != nullptr && other->sweep != cell.sweep;
  });
}

std::vector<DividingPlane> SpacePartition::bounds(const Cell& cell) const {
  std::vector<DividingPlane> turned = planes_;
  for (std::size_t j = 0; j < planes_.size(); ++j) {
    if ((cell.sides & bit(j)) == 0) turned[j].coeffs() *= -1.0;
  }
  return turned;
}

std::vector<std::vector<Eigen::Vector2d>> SpacePartition::hatched(std::size_t sweep,
                                                                  const Eigen::Affine3d& reference_from_image,
                                                                  int width, int height) const {
  const double right = width - 0.5;
  const double bottom = height - 0.5;
  const Polygon3 rectangle{reference_from_image * Eigen::Vector3d(-0.5, -0.5, 0),
                           reference_from_image * Eigen::Vector3d(right, -0.5, 0),
                           reference_from_image * Eigen::Vector3d(right, bottom, 0),
                           reference_from_image * Eigen::Vector3d(-0.5, bottom, 0)};
  const Eigen::Affine3d image_from_reference = reference_from_image.inverse();
  std::vector<std::vector<Eigen::Vector2d>> regions;
  for (const Cell& cell : cells_) {
    if (!cell.sweep || *cell.sweep == sweep) continue;
    const Polygon3 part = clip_polygon(rectangle, bounds(cell));
    if (part.size() < 3) continue;
    std::vector<Eigen::Vector2d> region;
    for (const Eigen::Vector3d& corner : part) region.push_back((image_from_reference * corner).head<2>());
    regions.push_back(std::move(region));
  }
  return regions;
}

std::vector<Polygon3> SpacePartition::visible_disc(std::size_t plane) const {
  assert(plane < planes_.size());
  const double distance_mm = planes_[plane].signedDistance(centre_mm_);
  if (std::abs(distance_mm) >= radius_mm_) return {};
  const double disc_mm = std::sqrt(radius_mm_ * radius_mm_ - distance_mm * distance_mm);
  const Eigen::Vector3d across = planes_[plane].normal().unitOrthogonal();
  const Eigen::Vector3d up = planes_[plane].normal().cross(across);
  Polygon3 disc;
  for (int i = 0; i < kDiscCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kDiscCorners;
    disc.push_back(planes_[plane].projection(centre_mm_) + disc_mm * (std::cos(angle) * across + std::sin(angle) * up));
  }
  std::vector<Polygon3> parts;
  for (const Cell& cell : cells_) {
    if ((cell.sides & bit(plane)) == 0) continue;
    const Cell* other = find_cell(cell.sides ^ bit(plane));
    if (other == nullptr || other->sweep == cell.sweep) continue;
    std::vector<DividingPlane> others = bounds(cell);
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(plane));
    Polygon3 part = clip_polygon(disc, others);
    if (part.size() > 2) parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace fathom
