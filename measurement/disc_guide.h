#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "measurement/section_shape.h"

namespace fathom {

/// Where the parts of a section go on a neighbouring one, as its maximal discs tell. Treece 2000, sections 3.2.4 and
/// 3.2.5, with the average of the discs' vectors normalised by the weights in it (as printed, (3.7) halves equal
/// vectors) and by the same weights inside and outside as at the outline, and with the weight of a pair of discs fading
/// to nothing where its error reaches a radius, beyond which (3.6) leaves it out.
///
/// All vectors are in the common coordinates (a, b) of the two sections, millimetres, from the first to the second.
class DiscGuide {
 public:
  /// Points in a block: enough for the processor's vector units, few enough to stay at hand.
  static constexpr std::size_t kBlock = 16;

  /// Neither section may be absent. They are used only here: the guide keeps copies of the discs that have partners.
  DiscGuide(const SectionShape& first, const SectionShape& second);

  /// Points at which a correspondence is wanted, with the codes of both sections there (in units of their own cells).
  /// All are worked on, so that those not needed must be finite.
  struct Block {
    std::array<float, kBlock> a_mm{}, b_mm{}, first_code{}, second_code{};
  };

  /// From the first section to the second at the points of a block; zero where no disc has a partner. Exchanging the
  /// sections changes its sign and nothing else.
  void correspondence(const Block& block, std::array<float, kBlock>& ca_mm, std::array<float, kBlock>& cb_mm) const;

  /// No vector is longer than this.
  double longest_mm() const { return longest_mm_; }

  /// The discs of a section that have partners, those inside first, in arrays for fast loops.
  struct Discs {
    std::vector<float> a_mm, b_mm, radius;  ///< radius in units of the larger of both cells, negative outside
    std::vector<float> ca_mm, cb_mm;        ///< to the other section
    std::size_t inside = 0;
  };
  const Discs& first() const { return first_; }
  const Discs& second() const { return second_; }

 private:
  float cells_per_mm_ = 1.0F;  // of the larger cells of both
  float first_scale_ = 1.0F;   // from a section's own units to these
  float second_scale_ = 1.0F;
  Discs first_;
  Discs second_;
  double longest_mm_ = 0.0;
};

}  // namespace fathom
