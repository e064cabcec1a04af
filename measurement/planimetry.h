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
  std::optional<double> cubic_ml;     ///< in the 2D representation; the number to quote
  std::optional<double> cubic_3d_ml;
};

/// The volume enclosed by a sequence of cross-sections in scan order, in millimetres. Each of the three throws Error
/// when fewer than two sections are given, a value is not finite, or the end planes do not face the object in the
/// same sense (`same_sense`). With two sections all three are the trapezoid.
/// Treece 2000, section 2.2: equation (2.2); (2.3), (2.7), (B.4), (B.5); and (2.1) with cubic s and omega.
double linear_planimetry_ml(std::span<const CrossSection> sections);
double cubic_planimetry_ml(std::span<const CrossSection> sections);
double cubic_planimetry_3d_ml(std::span<const CrossSection> sections);

/// Whether the first and last planes face the object in the same sense, without which (2.1) has no meaning: a
/// rotational sweep does not.
bool same_sense(std::span<const CrossSection> sections);

/// The volume of one structure, with everything the user must know about it.
struct VolumeMeasurement {
  PlanimetryVolumes volumes;
  int sections = 0;
  std::vector<std::string> warnings;  ///< one section only, a sweep that turns back, a rotational sweep, ...
};

/// Measures by all methods. Never throws for a sweep that has no volume: says why in `warnings` instead.
VolumeMeasurement measure_planimetry(std::span<const CrossSection> sections);

}  // namespace fathom
