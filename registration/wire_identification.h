#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "registration/bright_spots.h"
#include "registration/wire_phantom.h"

namespace fathom {

/// How an image lies over a phantom, up to small turns. In the first two, upright orientations the first pattern is the
/// one nearest to the top of the image (the probe), and wire 0 of every pattern is on the left or on the right,
/// depending on the side from which the probe looks. The others are those of images stored upside down or turned.
enum class ImageOrientation {
  kWire0Left,
  kWire0Right,
  kUpsideDownWire0Left,
  kUpsideDownWire0Right,
  kFirstPatternLeft,
  kFirstPatternLeftMirrored,
  kFirstPatternRight,
  kFirstPatternRightMirrored,
};

inline constexpr std::array kImageOrientations = {
    ImageOrientation::kWire0Left,           ImageOrientation::kWire0Right,
    ImageOrientation::kUpsideDownWire0Left, ImageOrientation::kUpsideDownWire0Right,
    ImageOrientation::kFirstPatternLeft,    ImageOrientation::kFirstPatternLeftMirrored,
    ImageOrientation::kFirstPatternRight,   ImageOrientation::kFirstPatternRightMirrored,
};

inline bool is_upright(ImageOrientation orientation) {
  return orientation == ImageOrientation::kWire0Left || orientation == ImageOrientation::kWire0Right;
}

/// The wires that a phantom's spots were taken for: an index into the spots for each wire of each pattern.
using SpotOfWire = std::vector<std::array<std::optional<std::size_t>, 3>>;

/// One reading of an image.
struct WireMatch {
  SpotOfWire spots;
  Eigen::Affine3d phantom_from_image = Eigen::Affine3d::Identity();  ///< pixels (z = 0) to mm, columns perpendicular
  Eigen::Vector2d pixel_mm = Eigen::Vector2d::Zero();                ///< lengths of its first two columns
  double rms_mm = 0.0;                                               ///< distance of the spots from the wires
  double mean_contrast = 0.0;
  int complete_patterns = 0;
  int points = 0;
};

/// What a reading must satisfy. Lengths are relative, as the scale need not be known.
struct WireMatchOptions {
  double collinearity = 0.025;    ///< distance of the middle spot from the line of the outer two, of their distance
  double width_tolerance = 0.08;  ///< misfit of patterns to each other in the first, coarse comparison
  double max_rms = 0.025;         ///< of the spots from the wires, of the phantom's width
  double max_distance = 0.05;     ///< of one spot from its wire, of the phantom's width
  double max_turn_rad = 0.87;     ///< in the image, 50 degrees
  double max_tilt_rad = 0.96;     ///< of the image plane from across the wires, 55 degrees
  double max_pixel_aspect = 2.0;  ///< of width to height or height to width of a pixel, where the scale is not known
  double scale_tolerance = 0.15;  ///< of a pixel size fitted to one image alone to the known one
};

/// Throws Error unless the phantom has a pattern, its numbers are finite, the outer wires of every pattern are parallel
/// to those of all others, no pattern is narrower than 1 mm or shorter than 1 mm, and no two are in the same place.
void require_usable(const WirePhantom& phantom);

/// Mean distance of the outer wires of a pattern, mm.
double phantom_width_mm(const WirePhantom& phantom);

/// Which spot is which wire, or empty where no reading fits.
///
/// Three spots on a line whose ratio lies between those of the middle wire's ends may be an N; several Ns must have
/// widths and distances that agree with one image plane, checked by fitting a plane with perpendicular axes to the
/// wires in space. With the pixel size known the plane is fitted with it, and readings may lack the wires of one
/// pattern (where there are three or more); with it
/// unknown every wire must be there (a lone pattern gives the scale itself, of square pixels). Among the readings that
/// fit, the one with most wires, then the brightest, counts.
std::optional<WireMatch> identify_wires(std::span<const BrightSpot> spots, const WirePhantom& phantom,
                                        ImageOrientation orientation, const std::optional<Eigen::Vector2d>& pixel_mm,
                                        const WireMatchOptions& options = {});

/// Fits an image plane (position, turn, and where `pixel_mm` is empty also the pixel's width and height) to points on
/// wires, least squares of distances in space from `start`. `at_px` and `wires`
/// go together. Returns the fitted map; empty where it does not settle.
std::optional<Eigen::Affine3d> fit_image_plane(std::span<const Eigen::Vector2d> at_px, std::span<const Wire> wires,
                                               const Eigen::Affine3d& start,
                                               const std::optional<Eigen::Vector2d>& pixel_mm);

/// Distance of a point from the straight line through a wire, mm.
double distance_to_wire_mm(const Wire& wire, const Eigen::Vector3d& x_in_phantom_mm);

}  // namespace fathom
