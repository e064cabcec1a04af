#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measurement/cross_section.h"

namespace fathom {

/// Volumes by every method of planimetry; empty where a method has no answer. Millilitres, never negative.
struct PlanimetryVolumes {
  std::optional<double> linear_ml;
  std::optional<double> cubic_ml;  ///< in the 2D representation
  std::optional<double> cubic_3d_ml;
  std::optional<double> quadric_ml;  ///< needs the fewest sections (docs/results.md)

  /// The number to quote, and what its interval is about.
  const std::optional<double>& recommended_ml() const { return quadric_ml; }
};

/// That method, as people call it and as files do.
inline constexpr const char* kRecommendedMethod = "quadric planimetry";
inline constexpr const char* kRecommendedKey = "cubic_planimetry_quadric";

/// The point that cubic planimetry makes up beyond each end of a sweep, where p2 is the end and p3, p4 lie inwards.
enum class SplineEnd {
  kRepeat,   ///< p1 = p3, as in Treece 2000, figure 2.6, third choice
  kContinue  ///< p1 = 3 p2 - 3 p3 + p4, which keeps the curvature: exact for quadrics cut by parallel planes
};

/// The volume enclosed by a sequence of cross-sections in scan order, in millimetres. Each of the three throws Error
/// when fewer than two sections are given, none has an area, a value is not finite, or the end planes do not face the
/// object in the same sense (`same_sense`). With two sections all three are the trapezoid. None depends on the end
/// that the sweep is read from.
/// Treece 2000, section 2.2: equation (2.2); (2.3), (2.7), (B.4), (B.5); and (2.1) with cubic s and omega.
double linear_planimetry_ml(std::span<const CrossSection> sections);
double cubic_planimetry_ml(std::span<const CrossSection> sections, SplineEnd end = SplineEnd::kRepeat);
double cubic_planimetry_3d_ml(std::span<const CrossSection> sections, SplineEnd end = SplineEnd::kRepeat);

/// Cubic planimetry for sections that are not evenly spaced: in space, with tangents from parabolas through three
/// sections, over the way that the frames have come (CrossSection::along_mm), and the curvature kept at the ends
/// (SplineEnd::kContinue). Evenly spaced it is cubic_planimetry_3d_ml with those ends; exact for quadrics cut by
/// parallel planes at any spacing, from three sections on.
double quadric_planimetry_ml(std::span<const CrossSection> sections);

/// The volume between each two neighbours among the sections, in mm3 and signed, by linear planimetry (2.2) and by
/// quadric planimetry; `sections` as above. What the two differ by is what the sections between them leave open.
struct GapVolumes {
  double linear_mm3 = 0.0;
  double quadric_mm3 = 0.0;
};
std::vector<GapVolumes> gap_volumes(std::span<const CrossSection> sections);

/// Whether the first and last planes face the object in the same sense, without which (2.1) has no meaning: they do
/// not after half a turn about the object, nor in a sweep that ends where it began. `sections` are at least two, with
/// finite values.
bool same_sense(std::span<const CrossSection> sections);

/// The volume of one structure, with everything the user must know about it.
struct VolumeMeasurement {
  PlanimetryVolumes volumes;
  int sections = 0;
  std::vector<std::string> warnings;  ///< one section only, a sweep that turns back or stops short, ...
};

/// Ends at which sections are known to be cut off, so that nobody need be told that they are still large.
struct CutEnds {
  bool first = false;
  bool last = false;
};

/// Measures by all methods. Never throws for a sweep that has no volume: says why in `warnings` instead. More is
/// refused than by the single methods: also a rotational sweep by less than half a turn, whose end planes cross in
/// the middle of the object.
VolumeMeasurement measure_planimetry(std::span<const CrossSection> sections, const CutEnds& cut = {});

}  // namespace fathom
