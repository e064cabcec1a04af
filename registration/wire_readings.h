#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "registration/wire_end_view.h"

namespace fathom {

inline constexpr double kBeyondWire = 0.04;  ///< of its length, how far the middle wire may be met beyond its ends

/// Three spots that may be an N.
struct WireTriple {
  std::array<std::size_t, 3> spots;  // left, middle, right
  Eigen::Vector2d left;
  Eigen::Vector2d span;
  double ratio = 0.0;
};

/// The coarse comparison: what two patterns say of the image, in pixels for each millimetre.
struct CoarseWireView {
  Eigen::Vector2d right;  ///< along the phantom's x
  Eigen::Vector2d down;   ///< along its z
  Eigen::Vector2d origin;
  Eigen::Vector2d at(const Eigen::Vector2d& x_mm) const { return origin + right * x_mm.x() + down * x_mm.y(); }
};

/// One way to take spots for the wires, by the coarse comparison alone.
struct WireReading {
  std::vector<const WireTriple*> triples;  // one for each pattern, null where there is none
  CoarseWireView view;
  double promise = 0.0;
};

/// Finds the readings of an image: pairs of patterns that agree with each other, and what goes with them.
class WireReadings {
 public:
  /// `at` are the spots' places turned by canonical_from_image. Patterns that a reading needs: `needed`. References
  /// stay in use.
  WireReadings(std::span<const BrightSpot> spots, std::vector<Eigen::Vector2d> at, const WireEndView& view,
               const std::optional<Eigen::Vector2d>& canonical_pixel_mm, std::size_t needed,
               const WireMatchOptions& options);

  /// The most promising first.
  const std::vector<WireReading>& readings() const { return readings_; }

  double brightest() const { return brightest_; }

 private:
  void find_triples();
  bool plausible(const CoarseWireView& view) const;
  void compare(std::size_t a, std::size_t b);
  void add_reading(std::size_t a, const WireTriple& upper, std::size_t b, const WireTriple& lower,
                   const CoarseWireView& view, double misfit);
  void add_lone(const WireTriple& triple);

  std::span<const BrightSpot> spots_;
  std::vector<Eigen::Vector2d> at_;  ///< wire 0 on the left, the first pattern at the top
  const WireEndView& view_;
  std::optional<Eigen::Vector2d> pixel_mm_;
  std::size_t needed_;
  const WireMatchOptions& options_;
  double brightest_ = 0.0;
  std::vector<std::vector<WireTriple>> triples_;  ///< that may be each pattern
  std::vector<WireReading> readings_;
};

}  // namespace fathom
