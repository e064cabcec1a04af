#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "measurement/carried_planes.h"
#include "measurement/frame_marks.h"
#include "measurement/section_gap.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"
#include "surface/sampled_layer.h"

namespace fathom {

/// One marked frame and what was made of it for a surface through contours.
struct SurfaceSection {
  int frame = 0;
  std::vector<Polygon> outlines_px;
  std::optional<Eigen::Vector2d> extremity_px;
  CarriedPlane place;
  std::shared_ptr<const SectionShape> shape;  ///< null until make_shapes
  std::shared_ptr<const SampledLayer> layer;  ///< null until it is sampled

  PlacedSection placed() const { return {place.plane, shape}; }
  bool absent() const { return outlines_px.empty() && !extremity_px; }
  bool marked_as(const FrameMarks& marks) const;
};

/// A rectangle in (a, b), millimetres; empty at first.
struct SurfaceBounds {
  Eigen::Vector2d low;
  Eigen::Vector2d high;

  SurfaceBounds();
  void extend(const Eigen::Vector2d& point);
};

/// Of all outlines and extremities.
SurfaceBounds bounds_of(const std::vector<SurfaceSection>& sections);

/// How far the planes of two sections are apart where the structure is.
struct SectionDistance {
  double mean_mm = 0.0;     ///< over the rectangle of their outlines
  double largest_mm = 0.0;  ///< the same
  /// The geometric mean along their outlines: a lattice with layers a spacing apart by this is stretched as much on one
  /// side as it is squeezed on the other. For parallel planes as the mean, in a fan from its axis on 0.74 of it.
  double lattice_mm = 0.0;
};

SectionDistance distance_between(const SurfaceSection& first, const SurfaceSection& second);

/// The marked frames of `structure` with a place in `planes`, ascending, without absent ones before the first and
/// behind the last outline. What is marked as in `before` is taken over with shape and layer. Adds to `warnings` what
/// was left out. Throws Error, which starts with `owner`, for fewer than two outlined frames or none with an area.
std::vector<SurfaceSection> surface_sections(const Structure& structure, const FrameLocator& locator,
                                             const std::vector<std::optional<CarriedPlane>>& planes,
                                             const std::vector<SurfaceSection>& before, const std::string& owner,
                                             std::vector<std::string>& warnings);

/// An eightieth of the largest extent, to two digits.
double default_spacing_mm(const std::vector<SurfaceSection>& sections);

/// Throws Error, which starts with `owner`, where no surface leads from a section to the next: on the same plane, or
/// turned away from it.
void require_gaps(const std::vector<SurfaceSection>& sections, double spacing_mm, const std::string& owner);

/// The distance fields that are not there yet, in cells that suit the lattice.
void make_shapes(std::vector<SurfaceSection>& sections, double spacing_mm);

/// Rounded up.
double to_two_digits(double value);

}  // namespace fathom
