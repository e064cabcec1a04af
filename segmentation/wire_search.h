#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core/types.hpp>

namespace fathom {

/// The eight steps from a pixel to its neighbours, clockwise from right (y runs down).
inline constexpr int kWireSteps = 8;
inline constexpr std::array<int, kWireSteps> kWireStepX = {1, 1, 0, -1, -1, -1, 0, 1};
inline constexpr std::array<int, kWireSteps> kWireStepY = {0, 1, 1, 1, 0, -1, -1, -1};

/// What each step from each pixel costs: 1 to 255, pixel by pixel, eight each; 0 where a step leads out of the image.
struct WireCosts {
  cv::Size size;
  std::vector<std::uint8_t> steps;
};

/// Cheapest paths from one pixel to any other (Dijkstra; Mortensen and Barrett 1998, with buckets since costs are
/// whole numbers). The search spreads from the start only as far as it takes to reach what is asked for, and goes on
/// from there the next time; what has been reached is a walk back.
class WireSearch {
 public:
  /// `costs` must outlive the search.
  explicit WireSearch(const WireCosts& costs);

  /// Starts anew. Steps onto `occupied` pixels cost the most there is, save within two pixels of the start.
  void start(cv::Point from, const std::vector<cv::Point>& occupied);

  /// Pixels from the start to `to`, both included. Both must lie in the image.
  std::vector<cv::Point> path_to(cv::Point to);

  /// How many pixels the search has settled since its start.
  int settled() const { return settled_count_; }

 private:
  void settle_until(int target);
  void relax(int pixel);

  const WireCosts& costs_;
  std::array<int, kWireSteps> step_;    ///< in pixels of the image, row after row
  std::vector<std::uint32_t> cost_;     ///< from the start; valid where reached
  std::vector<std::uint8_t> state_;     ///< settled, reached, occupied, and the step that led here
  std::vector<std::vector<int>> ring_;  ///< reached pixels by their cost modulo 256
  std::uint32_t level_ = 0;             ///< the cost that is being settled
  int waiting_ = 0;                     ///< entries in the ring
  int settled_count_ = 0;
  int start_ = 0;
};

}  // namespace fathom
