#pragma once

#include <span>
#include <vector>

#include "segmentation/contours.h"

namespace fathom {

/// Tools that change the outlines of one structure on one frame. Outlines combine by even-odd and must not cross
/// (`outline_fault`); what comes out does not cross either. Points lie between pixels.

/// A round brush drawn along a line, or set down on one point.
struct BrushStroke {
  std::vector<Eigen::Vector2d> line_px;
  double radius_px = 5.0;
  bool erase = false;  ///< take away what the brush covers; else add it

  /// Throws Error when the line is empty or not finite, or the radius not from 0.5 to 500 pixels.
  void check() const;
};

/// Outlines that the stroke does not touch stay as they are, and touched ones keep their points away from it. Throws
/// Error as BrushStroke::check, or when outlines are too large.
std::vector<Polygon> brushed(std::span<const Polygon> outlines, const BrushStroke& stroke);

/// What lies within `distance_px` of the structure, or, where it is negative, farther than that from its outside.
/// Throws Error when the distance is not finite or farther than 500 pixels, or outlines are too large.
std::vector<Polygon> grown(std::span<const Polygon> outlines, double distance_px);

/// Morphology with a disc, and by size. Done in this order; 0 leaves a step out.
struct CleanOptions {
  double close_px = 0.0;       ///< radius: gaps that cannot hold the disc are filled
  double open_px = 0.0;        ///< radius: parts that cannot hold the disc are dropped: specks, spikes, thin bridges
  double min_part_px = 0.0;    ///< smaller parts are dropped; area in square pixels
  double fill_holes_px = 0.0;  ///< smaller holes are filled

  /// Throws Error when a value is negative, not finite, or a radius above 500.
  void check() const;
};

/// Throws Error as CleanOptions::check.
std::vector<Polygon> cleaned(std::span<const Polygon> outlines, const CleanOptions& options);

/// Bends shorter than `width_px` along the outlines are evened out (a Gaussian of that standard deviation); each
/// outline keeps its area. Less is done where outlines would cross. Throws Error when the width is not from 0 to 100.
std::vector<Polygon> evened_out(std::span<const Polygon> outlines, double width_px);

}  // namespace fathom
