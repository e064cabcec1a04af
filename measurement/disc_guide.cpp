#include "measurement/disc_guide.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "measurement/chamfer.h"

namespace fathom {

namespace {

// (One cell)^2 in chamfer units: keeps the weight of a perfect match finite. The mu of equations (3.5) and (3.8).
constexpr float kMu = kChamferStep * kChamferStep;

// A disc on its way to a correspondence vector.
struct Partnered {
  float a_mm, b_mm, radius;
  float own_far;  // the other section's code at its centre
  float weight = 0.0F;
  float ca_mm = 0.0F;
  float cb_mm = 0.0F;
};

std::vector<Partnered> prepared(const std::vector<Disc>& discs, float scale, const SectionShape& other,
                                float other_scale) {
  std::vector<Partnered> result;
  result.reserve(discs.size());
  for (const Disc& disc : discs) {
    result.push_back({static_cast<float>(disc.centre_mm.x()), static_cast<float>(disc.centre_mm.y()),
                      scale * static_cast<float>(disc.radius), other_scale * other.code(disc.centre_mm)});
  }
  return result;
}

// Equations (3.4) to (3.6) for discs that are all inside or all outside. A pair is left out where its error reaches a
// disc's radius, and here it fades until then: else a pair that is hardly one has all its weight, and an edit by a
// hundredth of a pixel moves the surface from one organ to its neighbour.
void find_partners(std::vector<Partnered>& first, std::vector<Partnered>& second, float cells_per_mm) {
  for (Partnered& a : first) {
    for (Partnered& b : second) {
      const float la = b.a_mm - a.a_mm;
      const float lb = b.b_mm - a.b_mm;
      const float apart = chamfer_length(cells_per_mm * la, cells_per_mm * lb);
      const float error_a = apart - std::abs(a.radius - b.own_far);
      const float error_b = apart - std::abs(b.radius - a.own_far);
      const float fit_a = 1.0F - error_a / std::abs(a.radius);
      const float fit_b = 1.0F - error_b / std::abs(b.radius);
      if (fit_a <= 0.0F || fit_b <= 0.0F) continue;
      const float weight = fit_a * fit_b * (1.0F / (error_a * error_a + kMu) + 1.0F / (error_b * error_b + kMu));
      a.weight += weight;
      a.ca_mm += weight * la;
      a.cb_mm += weight * lb;
      b.weight += weight;
      b.ca_mm -= weight * la;
      b.cb_mm -= weight * lb;
    }
  }
}

void keep_partnered(const std::vector<Partnered>& discs, DiscGuide::Discs& kept, double& longest_mm) {
  for (const Partnered& disc : discs) {
    if (disc.weight == 0.0F) continue;
    kept.a_mm.push_back(disc.a_mm);
    kept.b_mm.push_back(disc.b_mm);
    kept.radius.push_back(disc.radius);
    kept.ca_mm.push_back(disc.ca_mm / disc.weight);
    kept.cb_mm.push_back(disc.cb_mm / disc.weight);
    longest_mm = std::max(longest_mm, std::hypot(static_cast<double>(kept.ca_mm.back()), kept.cb_mm.back()));
  }
}

// Weighted sums over some discs, for every point of a block.
struct Sums {
  std::array<float, DiscGuide::kBlock> weight{}, ca{}, cb{}, apart{};
};

// Equations (3.8), (3.9) and the sums of (3.7) and (3.10). All arrays have kBlock elements: the inner loop is over
// points and not over discs, so that it needs no sum across a vector and its result no order of summation.
void add_discs(const DiscGuide::Discs& discs, std::size_t from, std::size_t to, float cells_per_mm, const float* a_mm,
               const float* b_mm, const float* code, Sums& sums) {
  for (std::size_t k = from; k < to; ++k) {
    const float a = discs.a_mm[k];
    const float b = discs.b_mm[k];
    const float radius = discs.radius[k];
    const float ca = discs.ca_mm[k];
    const float cb = discs.cb_mm[k];
    for (std::size_t p = 0; p < DiscGuide::kBlock; ++p) {
      const float apart = chamfer_length(cells_per_mm * (a_mm[p] - a), cells_per_mm * (b_mm[p] - b));
      const float error = apart - std::abs(radius - code[p]);
      const float weight = 1.0F / (error * error + kMu);
      sums.weight[p] += weight;
      sums.ca[p] += weight * ca;
      sums.cb[p] += weight * cb;
      sums.apart[p] += weight * apart;
    }
  }
}

// Equation (3.7) for the vectors of one section, added with a factor.
void add_combined(const Sums& inside, const Sums& outside, const float* code, float factor, float* ca_mm,
                  float* cb_mm) {
  for (std::size_t p = 0; p < DiscGuide::kBlock; ++p) {
    float share_in = 1.0F;
    float share_out = 1.0F;
    if (inside.weight[p] > 0.0F && outside.weight[p] > 0.0F) {
      if (code[p] > 0.0F) {
        share_out = inside.apart[p] / inside.weight[p];
        share_in = share_out + 2.0F * code[p];
      } else {
        share_in = outside.apart[p] / outside.weight[p];
        share_out = share_in - 2.0F * code[p];
      }
    }
    const float total = share_in * inside.weight[p] + share_out * outside.weight[p];
    if (!(total > 0.0F)) continue;
    ca_mm[p] += factor * (share_in * inside.ca[p] + share_out * outside.ca[p]) / total;
    cb_mm[p] += factor * (share_in * inside.cb[p] + share_out * outside.cb[p]) / total;
  }
}

void add_section(const DiscGuide::Discs& discs, float cells_per_mm, const float* a_mm, const float* b_mm,
                 const float* code, float factor, float* ca_mm, float* cb_mm) {
  Sums inside;
  Sums outside;
  add_discs(discs, 0, discs.inside, cells_per_mm, a_mm, b_mm, code, inside);
  add_discs(discs, discs.inside, discs.a_mm.size(), cells_per_mm, a_mm, b_mm, code, outside);
  add_combined(inside, outside, code, factor, ca_mm, cb_mm);
}

}  // namespace

DiscGuide::DiscGuide(const SectionShape& first, const SectionShape& second) {
  assert(first.kind() != SectionKind::kAbsent && second.kind() != SectionKind::kAbsent);
  const double cell_mm = std::max(first.cell_mm(), second.cell_mm());
  cells_per_mm_ = static_cast<float>(1.0 / cell_mm);
  first_scale_ = static_cast<float>(first.cell_mm() / cell_mm);
  second_scale_ = static_cast<float>(second.cell_mm() / cell_mm);
  for (const auto discs : {&SectionShape::inside_discs, &SectionShape::outside_discs}) {
    std::vector<Partnered> of_first = prepared((first.*discs)(), first_scale_, second, second_scale_);
    std::vector<Partnered> of_second = prepared((second.*discs)(), second_scale_, first, first_scale_);
    find_partners(of_first, of_second, cells_per_mm_);
    keep_partnered(of_first, first_, longest_mm_);
    keep_partnered(of_second, second_, longest_mm_);
    if (discs == &SectionShape::inside_discs) {
      first_.inside = first_.a_mm.size();
      second_.inside = second_.a_mm.size();
    }
  }
}

void DiscGuide::correspondence(const Block& block, std::array<float, kBlock>& ca_mm,
                               std::array<float, kBlock>& cb_mm) const {
  std::array<float, kBlock> code;
  ca_mm.fill(0.0F);
  cb_mm.fill(0.0F);
  // The two sections' vectors point at each other, so that their average is half the difference.
  for (std::size_t p = 0; p < kBlock; ++p) code[p] = first_scale_ * block.first_code[p];
  add_section(first_, cells_per_mm_, block.a_mm.data(), block.b_mm.data(), code.data(), 0.5F, ca_mm.data(),
              cb_mm.data());
  for (std::size_t p = 0; p < kBlock; ++p) code[p] = second_scale_ * block.second_code[p];
  add_section(second_, cells_per_mm_, block.a_mm.data(), block.b_mm.data(), code.data(), -0.5F, ca_mm.data(),
              cb_mm.data());
}

}  // namespace fathom
