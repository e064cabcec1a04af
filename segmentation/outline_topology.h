#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "segmentation/contours.h"

namespace fathom {

/// How an outline lies among the other outlines of its frame.
enum class Nesting {
  kPart,       ///< inside of none of the others, or of an even number: what it encloses belongs to the structure
  kHole,       ///< inside of an odd number of the others
  kCoincident  ///< drawn on top of others all along, so that it is neither
};

/// The nesting of each of the outlines of one structure on one frame, which must not cross each other. They may touch.
std::vector<Nesting> nesting(std::span<const Polygon* const> outlines);

/// What keeps the outlines of one structure on one frame from enclosing a definite area, for the user: "crosses
/// itself near (12.3, 45.6)", "crosses another outline near ...", "is drawn twice", "is too tangled to check". Empty
/// where all is well. Points that repeat, corners that touch a line and lines that run along each other are well.
///
/// An outline that can be seen whole from its middle takes about 2 ns a point, any other about 20 ns.
std::optional<std::string> outline_fault(std::span<const Polygon* const> outlines);

/// Both for outlines that stand one after the other.
std::vector<Nesting> nesting(std::span<const Polygon> outlines);
std::optional<std::string> outline_fault(std::span<const Polygon> outlines);

/// Throws Error, naming `file`, structure and frame, when closed contours on one frame have an `outline_fault`.
void require_simple_outlines(const std::vector<Structure>& structures, const std::string& file);

/// The same, and when a closed contour encloses no area at all, as points on one line do: nothing can be made of it.
void require_enclosing_outlines(const std::vector<Structure>& structures, const std::string& file);

}  // namespace fathom
