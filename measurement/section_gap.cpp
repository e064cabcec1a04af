#include "measurement/section_gap.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

namespace fathom {

namespace {

// Millimetres. Where the planes cross there is no way from one to the other; this keeps the weights finite there.
constexpr float kTouching = 1e-6F;

// Cells. Bilinear interpolation of distances is off by less than this near ridges, at both ends of an edge.
constexpr double kRidge = 2.0;

constexpr double kSmallestSize = 1e-6;  // of a bounding box, millimetres: a point has none

constexpr float kMostShare = 0.25F;  // w (1 - w) is no more

constexpr float kNothingThere = -1.0F;  // millimetres, between two absent sections: any value outside

bool is_absent(const PlacedSection& section) { return section.shape->kind() == SectionKind::kAbsent; }

// The size of a part as one number, for distances that scale with it.
double length_of(const Eigen::Vector2d& size_mm) {
  return std::sqrt(std::max(size_mm.x(), kSmallestSize) * std::max(size_mm.y(), kSmallestSize));
}

}  // namespace

// Where the interpolation line through a point meets both planes, as parts of the correspondence vector back to the
// first and on to the second, and the weight of the second.
struct SectionGap::Line {
  float back;
  float on;
  float second_weight;
};

SectionGap::SectionGap(PlacedSection first, PlacedSection second, Guide guide)
    : first_(std::move(first)), second_(std::move(second)), guide_(guide) {
  assert(first_.shape && second_.shape);
  Eigen::Vector3d average = first_.plane.normal() + second_.plane.normal();
  average = average.norm() > kSmallestSize ? average.normalized().eval() : first_.plane.normal();
  ahead_at_origin_mm_ = average.dot(second_.plane.origin_mm - first_.plane.origin_mm);
  ahead_slope_ = {average.dot(second_.plane.a_axis - first_.plane.a_axis),
                  average.dot(second_.plane.b_axis - first_.plane.b_axis)};
  if (is_absent(first_) && is_absent(second_)) {
    absent_mm_ = kNothingThere;
  } else if (is_absent(first_) || is_absent(second_)) {
    const SectionShape& present = is_absent(first_) ? *second_.shape : *first_.shape;
    absent_mm_ = -std::max(present.largest_inside_mm(), 0.5F * static_cast<float>(present.cell_mm()));
  } else if (guide_ == Guide::kDiscs) {
    discs_.emplace(*first_.shape, *second_.shape);
  }
  if (guide_ == Guide::kCentroids) pairs_ = matching_parts(first_.shape, second_.shape);
}

float SectionGap::distance_mm(const PlacedSection& section, const Eigen::Vector2d& ab_mm) const {
  return is_absent(section) ? absent_mm_ : section.shape->distance_mm(ab_mm);
}

// Along the average normal the planes are `ahead_mm` apart at the point, and `rise_mm` more at the far end of the
// correspondence vector. Laid on the plane on which it points away from the point, the vector makes the line meet that
// plane at the vector's own share, and the other plane nearer by ahead / (ahead + |rise|). Figure 3.15.
SectionGap::Line SectionGap::line(float ahead_mm, float rise_mm, float u) {
  const float apart = std::abs(ahead_mm) + kTouching;
  const float nearer = apart / (apart + std::abs(rise_mm));
  Line result{u, 1.0F - u, u};
  (ahead_mm * rise_mm >= 0.0F ? result.back : result.on) *= nearer;
  const float length = result.back + result.on;
  if (length > 0.0F) result.second_weight = result.back / length;
  return result;
}

float SectionGap::along_mm(const Eigen::Vector2d& ab_mm, const Eigen::Vector2d& c_mm, double u) const {
  const Line through =
      line(static_cast<float>(ahead_mm(ab_mm)), static_cast<float>(ahead_slope_.dot(c_mm)), static_cast<float>(u));
  const float d1 = distance_mm(first_, ab_mm - through.back * c_mm);
  const float d2 = distance_mm(second_, ab_mm + through.on * c_mm);
  return d1 + through.second_weight * (d2 - d1);
}

float SectionGap::bulge_share(const Eigen::Vector2d& ab_mm, double u) const {
  if (u <= 0.0 || u >= 1.0) return 0.0F;
  const float rise = static_cast<float>(ahead_slope_.dot(correspondence_mm(ab_mm)));
  const float weight = line(static_cast<float>(ahead_mm(ab_mm)), rise, static_cast<float>(u)).second_weight;
  return weight * (1.0F - weight);
}

std::vector<Eigen::Vector2d> SectionGap::correspondences_mm(const std::vector<Eigen::Vector2d>& ab_mm) const {
  std::vector<Eigen::Vector2d> vectors(ab_mm.size(), Eigen::Vector2d::Zero());
  if (!discs_) return vectors;
  DiscGuide::Block block;
  std::array<float, DiscGuide::kBlock> ca;
  std::array<float, DiscGuide::kBlock> cb;
  for (std::size_t from = 0; from < ab_mm.size(); from += DiscGuide::kBlock) {
    const std::size_t count = std::min(DiscGuide::kBlock, ab_mm.size() - from);
    for (std::size_t k = 0; k < count; ++k) {
      const Eigen::Vector2d& ab = ab_mm[from + k];
      block.a_mm[k] = static_cast<float>(ab.x());
      block.b_mm[k] = static_cast<float>(ab.y());
      block.first_code[k] = first_.shape->code(ab);
      block.second_code[k] = second_.shape->code(ab);
    }
    discs_->correspondence(block, ca, cb);
    for (std::size_t k = 0; k < count; ++k) vectors[from + k] = {ca[k], cb[k]};
  }
  return vectors;
}

Eigen::Vector2d SectionGap::correspondence_mm(const Eigen::Vector2d& ab_mm) const {
  return correspondences_mm({ab_mm}).front();
}

// A part and its partner, both scaled to the size that the structure has at u. Treece 2000, section 3.5.
float SectionGap::part_value_mm(const PartPair& pair, const Eigen::Vector2d& ab_mm, double u) const {
  const SectionPart& p = pair.first;
  const SectionPart& q = pair.second;
  if (!p.shape || !q.shape) {
    const SectionPart& present = p.shape ? p : q;
    const float share = static_cast<float>(p.shape ? u : 1.0 - u);
    const float d = present.shape->distance_mm(ab_mm);
    return d + share * (absent_mm_ - d);
  }
  const Eigen::Vector2d centre = p.centroid_mm + u * (q.centroid_mm - p.centroid_mm);
  const Eigen::Vector2d size = (p.size_mm + u * (q.size_mm - p.size_mm)).cwiseMax(kSmallestSize);
  const Eigen::Vector2d relative = (ab_mm - centre).cwiseQuotient(size);
  const Eigen::Vector2d on_p = p.centroid_mm + relative.cwiseProduct(p.size_mm);
  const Eigen::Vector2d on_q = q.centroid_mm + relative.cwiseProduct(q.size_mm);
  const Eigen::Vector2d c = on_q - on_p;
  const Line through =
      line(static_cast<float>(ahead_mm(ab_mm)), static_cast<float>(ahead_slope_.dot(c)), static_cast<float>(u));
  const double length = length_of(size);
  const auto scaled = [&](const SectionPart& part, const Eigen::Vector2d& at) {
    return static_cast<float>(length / length_of(part.size_mm)) * part.shape->distance_mm(at);
  };
  const float d1 =
      p.size_mm.isZero() ? p.shape->distance_mm(ab_mm - through.back * c) : scaled(p, ab_mm - through.back * c);
  const float d2 =
      q.size_mm.isZero() ? q.shape->distance_mm(ab_mm + through.on * c) : scaled(q, ab_mm + through.on * c);
  return d1 + through.second_weight * (d2 - d1);
}

float SectionGap::value_mm(const Eigen::Vector2d& ab_mm, double u) const {
  if (u <= 0.0) return distance_mm(first_, ab_mm);
  if (u >= 1.0) return distance_mm(second_, ab_mm);
  if (guide_ != Guide::kCentroids || pairs_.empty()) return along_mm(ab_mm, correspondence_mm(ab_mm), u);
  float value = std::numeric_limits<float>::lowest();
  for (const PartPair& pair : pairs_) value = std::max(value, part_value_mm(pair, ab_mm, u));
  return value;
}

int SectionGap::sweep_sign(const Eigen::Vector2d& ab_mm) const {
  const double ahead = ahead_mm(ab_mm);
  return (ahead > 0.0) - (ahead < 0.0);
}

// What is interpolated along a correspondence vector c differs from what is interpolated straight across,
// d = (1 - u) d1 + u d2, in two ways. The distances are read elsewhere, by which the result changes by no more than
// 2 u (1 - u) |c|. And where the planes are not parallel the weight is not u but w(u) = u / (u + (1 - u) n), or the
// same from the other end, with n <= 1 of `line`; w - u is at most (1 - sqrt(n)) / (1 + sqrt(n)). To both comes how
// much d itself changes to the second neighbour. Beyond all that neither the sign of the sample nor that of a neighbour
// can be another one.
float SectionGap::certain_mm(const ColumnGrid& grid, double layer_step, const Eigen::Vector2d& ab_mm,
                             float difference_mm) const {
  const double longest = longest_mm();
  const double edges = 2.0 * grid.longest_edge_mm();
  const double slope = ahead_slope_.norm();
  const double apart = std::max(0.0, std::abs(ahead_mm(ab_mm)) - slope * edges);
  const double rise = slope * longest;
  const double root = rise > 0.0 ? std::sqrt(apart / (apart + rise)) : 1.0;
  const double weight_off = (1.0 - root) / (1.0 + root);
  return static_cast<float>(certain_mm(grid) +
                            (2.0 * layer_step + weight_off) * (std::abs(difference_mm) + 2.0 * edges));
}

double SectionGap::longest_mm() const { return discs_ ? discs_->longest_mm() : 0.0; }

double SectionGap::certain_mm(const ColumnGrid& grid) const {
  const double cell = std::max(first_.shape->cell_mm(), second_.shape->cell_mm());
  return 0.5 * longest_mm() + 2.0 * grid.longest_edge_mm() + kRidge * cell;
}

float SectionGap::least_outside_mm(const PlacedSection& section, const Eigen::Vector2d& ab_mm) const {
  return is_absent(section) ? -absent_mm_ : section.shape->least_outside_mm(ab_mm);
}

bool SectionGap::may_cross(const Eigen::Vector2d& ab_mm, double certain_mm) const {
  if (std::min(least_outside_mm(first_, ab_mm), least_outside_mm(second_, ab_mm)) >= certain_mm) return false;
  const float d1 = distance_mm(first_, ab_mm);
  const float d2 = distance_mm(second_, ab_mm);
  return std::max(d1, d2) > -certain_mm && std::min(d1, d2) < certain_mm;
}

GapColumns SectionGap::prepare(const ColumnGrid& grid, double layer_step, const GapBulges* bulges) const {
  GapColumns columns;
  columns.grid_ = grid;
  assert(!bulges || guide_ != Guide::kCentroids);
  if (guide_ == Guide::kCentroids) return columns;
  if (is_absent(first_) || is_absent(second_)) bulges = nullptr;
  columns.first_mm_.resize(grid.size());
  columns.second_mm_.resize(grid.size());
  const bool straight = longest_mm() == 0.0 && !bulges;
  const auto certain_linear = static_cast<float>(certain_mm(grid));
  const float certain_anywhere = certain_linear + (bulges ? kMostShare * bulges->largest_mm : 0.0F);
  std::vector<Eigen::Vector2d> guided_ab_mm;
  std::size_t at = 0;
  for (int j = 0; j < grid.rows; ++j) {
    const Eigen::Vector2d start = grid.row_start_mm(j);
    for (int i = 0; i < grid.columns; ++i, ++at) {
      const Eigen::Vector2d ab = start + i * grid.column_step_mm;
      float& d1 = columns.first_mm_[at];
      float& d2 = columns.second_mm_[at];
      d1 = -least_outside_mm(first_, ab);
      d2 = -least_outside_mm(second_, ab);
      if (d1 <= -certain_anywhere && d2 <= -certain_anywhere) continue;
      d1 = distance_mm(first_, ab);
      d2 = distance_mm(second_, ab);
      const float most_added = bulges ? kMostShare * bulges->most_near_mm(ab) : 0.0F;
      const float certain = certain_linear + most_added;
      if (straight || std::max(d1, d2) <= -certain || std::min(d1, d2) >= certain) continue;
      GapColumns::Guided guided;
      guided.index = at;
      guided.first_cells = first_.shape->in_cells(ab);
      guided.second_cells = second_.shape->in_cells(ab);
      guided.ahead_mm = static_cast<float>(ahead_mm(ab));
      guided.certain_mm = certain_mm(grid, layer_step, ab, d2 - d1) + most_added;
      guided.bulge_mm = bulges ? bulges->at_mm(ab) : 0.0F;
      columns.guided_.push_back(guided);
      guided_ab_mm.push_back(ab);
    }
  }
  find_correspondences(columns, guided_ab_mm);
  return columns;
}

void SectionGap::find_correspondences(GapColumns& columns, const std::vector<Eigen::Vector2d>& ab_mm) const {
  if (!discs_) return;
  const auto first_per_mm = static_cast<float>(1.0 / first_.shape->cell_mm());
  const auto second_per_mm = static_cast<float>(1.0 / second_.shape->cell_mm());
  const Eigen::Vector2f slope = ahead_slope_.cast<float>();
  const std::vector<Eigen::Vector2d> vectors = correspondences_mm(ab_mm);
  for (std::size_t k = 0; k < vectors.size(); ++k) {
    GapColumns::Guided& guided = columns.guided_[k];
    const Eigen::Vector2f c = vectors[k].cast<float>();
    guided.c_first_cells = first_per_mm * c;
    guided.c_second_cells = second_per_mm * c;
    guided.rise_mm = slope.dot(c);
  }
}

void SectionGap::sample(const GapColumns& columns, double u, std::span<float> out) const {
  const ColumnGrid& grid = columns.grid_;
  assert(out.size() == grid.size());
  if (guide_ == Guide::kCentroids) {
    std::size_t at = 0;
    for (int j = 0; j < grid.rows; ++j) {
      const Eigen::Vector2d start = grid.row_start_mm(j);
      for (int i = 0; i < grid.columns; ++i) out[at++] = value_mm(start + i * grid.column_step_mm, u);
    }
    return;
  }
  const auto weight = static_cast<float>(u);
  const float* first = columns.first_mm_.data();
  const float* second = columns.second_mm_.data();
  for (std::size_t at = 0; at < out.size(); ++at) out[at] = first[at] + weight * (second[at] - first[at]);
  for (const GapColumns::Guided& guided : columns.guided_) {
    float& value = out[guided.index];
    if (std::abs(value) > guided.certain_mm) continue;
    const Line through = line(guided.ahead_mm, guided.rise_mm, weight);
    const float d1 = first_.shape->distance_at_mm(guided.first_cells - through.back * guided.c_first_cells);
    const float d2 = second_.shape->distance_at_mm(guided.second_cells + through.on * guided.c_second_cells);
    const float w = through.second_weight;
    value = d1 + w * (d2 - d1) + w * (1.0F - w) * guided.bulge_mm;
  }
}

}  // namespace fathom
