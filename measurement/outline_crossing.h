#pragma once

#include <optional>
#include <span>
#include <vector>

#include "measurement/predicted_outline.h"
#include "segmentation/pixel_grid.h"

namespace fathom {

/// A drawn section as OutlineCrossing takes it.
struct CrossedSection {
  CarriedPlane place;
  std::shared_ptr<const SectionShape> shape;
};

/// A frame's pixels on the blocks of a grid: mean grey, and 1 where the image shows something; CV_32FC1.
struct CrossedFrame {
  cv::Mat grey;
  cv::Mat seen;
  CarriedPlane place;
};

/// How a structure leads from one drawn section to the next: along maximal discs, or where one of them has no area to
/// its end.
class OutlineCrossing {
 public:
  /// `before` and `after` lie beyond them, the nearest first. At least one of both has an area. Without `tapered` ends
  /// all leads along maximal discs.
  OutlineCrossing(const CrossedSection& first, const CrossedSection& second, std::span<const CrossedSection> before,
                  std::span<const CrossedSection> after, bool tapered);
  OutlineCrossing(const OutlineCrossing&) = delete;
  OutlineCrossing& operator=(const OutlineCrossing&) = delete;

  /// Lets parts whose ends the sections do not tell end where the pixels do: inside and outside of each differ as they
  /// do on its drawn frame up to its tip, and no more beyond. `frames` from the first drawn one to the second.
  void find_tips(std::span<const CrossedFrame> frames, const PixelGrid& grid);

  PredictedOutline predict(const CarriedPlane& place, const PixelGrid& grid) const;

 private:
  SectionGap gap_;
  std::optional<SectionGap> gap_before_;
  std::optional<SectionGap> gap_after_;
  std::optional<CurvedGap> curved_;
  std::optional<TaperedEnd> first_ends_;   ///< the first section ends before the second
  std::optional<TaperedEnd> second_ends_;  ///< the second begins after the first
};

}  // namespace fathom
