#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "measurement/section_gap.h"

namespace fathom {

/// How a structure ends between its last section and a plane that only touches it, or on which it is not there.
///
/// Every part of the section shrinks without changing its shape: its area follows the parabola that the areas of the
/// sections on the other side continue, its centre their centres, down to the point that is touched. Both are exact for
/// ellipsoids and elliptic paraboloids cut by parallel planes. Where nothing is touched the part ends where the
/// parabola does, or half-way if it does not end between the planes.
class TaperedEnd {
 public:
  /// `end` is a point or absent; `sections` are the outlined ones from it on, the nearest first: at least one, and no
  /// more than three count. All share (a, b).
  TaperedEnd(const PlacedSection& end, std::span<const PlacedSection> sections);

  /// The distance in millimetres, positive inside, at `w` of the way from the end (0) to the nearest section (1).
  float value_mm(const Eigen::Vector2d& ab_mm, double w) const;

  /// Half the thickness of the part that is nearest there, on the nearest section; as far as its tip is known from the
  /// sections alone a multiple of it.
  float doubt_mm(const Eigen::Vector2d& ab_mm, double w) const;

 private:
  struct Part {
    std::shared_ptr<const SectionShape> shape;
    double doubt = 1.0;
    double tip = 0.0;  ///< where it ends, of the way from the end to the section
    // The area, as a share of that on the section, `from_tip` steps of the way behind the tip, and the centre.
    double slope = 1.0;
    double bend = 0.0;
    double grown = 1.0;                                   ///< from so far behind the tip on it is that on the section
    Eigen::Vector2d centre_mm = Eigen::Vector2d::Zero();  ///< on the section
    Eigen::Vector2d centre_slope_mm = Eigen::Vector2d::Zero();  ///< per way, there
    Eigen::Vector2d centre_bend_mm = Eigen::Vector2d::Zero();

    double share_of_area(double w) const;
    Eigen::Vector2d centre_at(double w) const;
    double value_mm(const Eigen::Vector2d& ab_mm, double w) const;
  };

  const Part& nearest(const Eigen::Vector2d& ab_mm, double w) const;

  std::vector<Part> parts_;
};

}  // namespace fathom
