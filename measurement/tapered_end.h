#pragma once

#include <limits>
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
/// parabola does, or at the end's plane if that lies beyond, with more doubt; half-way if the parabola has no end.
class TaperedEnd {
 public:
  /// `sections` are the outlined ones from the end on, the nearest first: at least one, and no more than three count.
  /// All share (a, b). `end` is a point, which belongs to the part nearest to it, or absent.
  TaperedEnd(const PlacedSection& end, std::span<const PlacedSection> sections);

  /// A part whose sections do not tell where it ends.
  struct OpenPart {
    std::size_t index = 0;
    std::shared_ptr<const SectionShape> shape;           ///< on the section
    Eigen::Vector2d drift_mm = Eigen::Vector2d::Zero();  ///< of its centre, from the end to the section
  };
  std::vector<OpenPart> open_parts() const;

  /// Lets an open part end at `tip` of the way.
  void end_at(std::size_t index, double tip);

  /// A distance, positive inside; and half the thickness, on the section, of the part that it belongs to, a multiple of
  /// it where nothing tells where that ends.
  struct Value {
    float distance_mm = -std::numeric_limits<float>::infinity();
    float doubt_mm = 0.0F;
  };

  /// At `w` of the way from the end (0) to the nearest section (1). Far outside the distance is a bound of it.
  Value value_mm(const Eigen::Vector2d& ab_mm, double w) const;

 private:
  struct Part {
    std::shared_ptr<const SectionShape> shape;
    double doubt = 1.0;
    bool open = false;
    double ball = 1.0;  ///< how far half a ball of the part's thickness reaches along the way
    double tip = 0.0;   ///< where it ends, of the way from the end to the section
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

  std::vector<Part> parts_;
};

}  // namespace fathom
