#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "registration/reslice_frames.h"

namespace fathom {

// Pixels of a run of a picture's columns from one or two frames. Places in images are stepped along as integers, so
// that a value depends on its run alone.

constexpr int kPixelBits = 32;                              // places are counted in 2^-32 pixels
constexpr int kShareBits = 12;                              // of a weight between two neighbouring pixels
constexpr int kBilinearBits = 2 * kShareBits;               // of a value weighted along both axes
constexpr int kDistanceBits = 16;                           // of a weight between two frames
constexpr int kLinearBits = kBilinearBits + kDistanceBits;  // 16 bits of a pixel fit above
constexpr std::int64_t kPixel = std::int64_t{1} << kPixelBits;
constexpr std::int64_t kShareOne = std::int64_t{1} << kShareBits;
constexpr std::int64_t kDistanceOne = std::int64_t{1} << kDistanceBits;

/// A place in an image that is stepped along a row of the picture.
struct ImageWalk {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t step_x = 0;
  std::int64_t step_y = 0;

  /// At column `column`; `shift` is added to both coordinates.
  ImageWalk(const RowFunctions& functions, int frame, int column, std::int64_t shift)
      : x(place(functions.image_at(0, frame) + column * functions.image_step(0, frame)) + shift),
        y(place(functions.image_at(1, frame) + column * functions.image_step(1, frame)) + shift),
        step_x(place(functions.image_step(0, frame))),
        step_y(place(functions.image_step(1, frame))) {}

  void next() {
    x += step_x;
    y += step_y;
  }

 private:
  static std::int64_t place(double pixels) {
    constexpr double kFar = 1 << 29;  // beyond any image: a run with such a step has one column
    return static_cast<std::int64_t>(std::clamp(pixels, -kFar, kFar) * static_cast<double>(kPixel));
  }
};

/// The used part of a frame's image.
template <typename Pixel>
struct FramePixels {
  const Pixel* first = nullptr;
  std::ptrdiff_t stride = 0;  ///< pixels from row to row
  int width = 0;
  int height = 0;
  const cv::Mat* mask = nullptr;  ///< empty where all pixels are used

  FramePixels(const cv::Mat& image, const ResliceFrames& frames)
      : first(image.ptr<Pixel>(frames.used.y) + frames.used.x),
        stride(static_cast<std::ptrdiff_t>(image.step / sizeof(Pixel))),
        width(frames.used.width),
        height(frames.used.height),
        mask(frames.mask.empty() ? nullptr : &frames.mask) {}

  /// The pixel that holds a place; the nearest one for places that rounding put just outside of the image.
  const Pixel* nearest(const ImageWalk& at) const {
    const std::int64_t x = std::clamp<std::int64_t>(at.x >> kPixelBits, 0, width - 1);
    const std::int64_t y = std::clamp<std::int64_t>(at.y >> kPixelBits, 0, height - 1);
    return first + y * stride + x;
  }

  /// Four pixels with their weights, or what they give together.
  struct Bilinear {
    const Pixel* pixel = nullptr;      ///< the upper left one; none where the value is known already
    std::int64_t shares_or_value = 0;  ///< of the right ones, and << 32 of the lower ones; or the value

    /// In 2^-kBilinearBits.
    std::int64_t value(std::ptrdiff_t stride) const {
      if (pixel == nullptr) return shares_or_value;
      const std::int64_t right = shares_or_value & 0xffffffff;
      const std::int64_t lower = shares_or_value >> 32;
      const Pixel* const below = pixel + stride;
      const std::int64_t up = (std::int64_t{pixel[0]} << kShareBits) + (pixel[1] - pixel[0]) * right;
      const std::int64_t down = (std::int64_t{below[0]} << kShareBits) + (below[1] - below[0]) * right;
      return (up << kShareBits) + (down - up) * lower;
    }
  };

  /// The pixels around a place. The outermost pixels go on for the half pixel to the image's edge; pixels that are not
  /// used have no weight.
  Bilinear bilinear(const ImageWalk& at) const {
    const std::int64_t right = (at.x >> (kPixelBits - kShareBits)) & (kShareOne - 1);
    const std::int64_t lower = (at.y >> (kPixelBits - kShareBits)) & (kShareOne - 1);
    const std::int64_t x = at.x >> kPixelBits;
    const std::int64_t y = at.y >> kPixelBits;
    if (x >= 0 && y >= 0 && x + 1 < width && y + 1 < height && mask == nullptr) {
      return {first + y * stride + x, right | lower << 32};
    }
    return {nullptr, at_edge(x, y, right, lower)};
  }

 private:
  std::int64_t at_edge(std::int64_t x, std::int64_t y, std::int64_t right, std::int64_t lower) const {
    std::int64_t sum = 0;
    std::int64_t weights = 0;
    for (int corner = 0; corner < 4; ++corner) {
      const std::int64_t px = std::clamp<std::int64_t>(x + (corner & 1), 0, width - 1);
      const std::int64_t py = std::clamp<std::int64_t>(y + (corner >> 1), 0, height - 1);
      if (mask != nullptr && mask->at<std::uint8_t>(static_cast<int>(py), static_cast<int>(px)) == 0) continue;
      const std::int64_t weight =
          ((corner & 1) != 0 ? right : kShareOne - right) * ((corner >> 1) != 0 ? lower : kShareOne - lower);
      weights += weight;
      sum += weight * first[py * stride + px];
    }
    constexpr std::int64_t kAll = kShareOne * kShareOne;
    if (weights == kAll || weights == 0) return sum;
    return static_cast<std::int64_t>(static_cast<double>(sum) / static_cast<double>(weights) * kAll);
  }
};

/// What a row of the picture shows, column by column, in two steps: first where its pixels are, then their values. The
/// processor so waits for many far pixels at a time instead of for one after another.
template <typename Pixel>
class RowPixels {
 public:
  using Images = std::vector<std::optional<FramePixels<Pixel>>>;  ///< of the frames that are held, as in NearFrames

  explicit RowPixels(int columns)
      : nearest_(static_cast<std::size_t>(columns)),
        linear_(static_cast<std::size_t>(columns)),
        of_next_(static_cast<std::size_t>(columns)) {}

  /// Looks up the nearest pixels of a run: of its frame, or of the next one where that is nearer.
  void find_nearest(const RowFunctions& functions, const ResliceRun& run, const Images& images) {
    const auto frame = static_cast<std::size_t>(run.frame);
    int from_next = run.end;  // columns nearer to the next frame: those from here on, or those before
    bool next_first = false;
    if (run.pair) {
      const auto nearer = [&](int u) {
        return std::abs(functions.distance(run.frame, u)) > std::abs(functions.distance(run.frame + 1, u));
      };
      next_first = nearer(run.first);
      from_next = run.first;
      while (from_next < run.end && nearer(from_next) == next_first) ++from_next;
    }
    const auto look_up = [&](std::size_t k, int first, int end) {
      if (first >= end) return;
      const FramePixels<Pixel>& image = *images[k];
      ImageWalk at(functions, static_cast<int>(k), first, kPixel / 2);
      for (int u = first; u < end; ++u, at.next()) {
        const Pixel* const found = image.nearest(at);
        __builtin_prefetch(found);
        nearest_[static_cast<std::size_t>(u)] = found;
      }
    };
    look_up(next_first ? frame + 1 : frame, run.first, from_next);
    look_up(next_first ? frame : frame + 1, from_next, run.end);
  }

  template <typename Value>
  void nearest(const ResliceRun& run, Value* out) const {
    for (int u = run.first; u < run.end; ++u) *out++ = *nearest_[static_cast<std::size_t>(u)];
  }

  /// Looks up the pixels around a run in its frame and, for a pair, in the next.
  void find_linear(const RowFunctions& functions, const ResliceRun& run, const Images& images) {
    constexpr std::int64_t kHalfShare = kPixel >> (kShareBits + 1);  // so that shares are rounded, not cut
    for (int k = 0; k < (run.pair ? 2 : 1); ++k) {
      const FramePixels<Pixel>& image = *images[static_cast<std::size_t>(run.frame + k)];
      ImageWalk at(functions, run.frame + k, run.first, kHalfShare);
      for (int u = run.first; u < run.end; ++u, at.next()) {
        const Bilinear found = image.bilinear(at);
        if (found.pixel != nullptr) {
          __builtin_prefetch(found.pixel);
          __builtin_prefetch(found.pixel + image.stride);
        }
        linear_[static_cast<std::size_t>(u)][static_cast<std::size_t>(k)] = found;
      }
    }
    for (int u = run.first; u < run.end; ++u) {
      std::int64_t& of_next = of_next_[static_cast<std::size_t>(u)];
      of_next = 0;
      if (!run.pair) continue;
      const double from_first = functions.distance(run.frame, u);
      const double gap = from_first - functions.distance(run.frame + 1, u);
      const double share = gap != 0.0 ? std::clamp(from_first / gap, 0.0, 1.0) : 0.0;
      of_next = static_cast<std::int64_t>(share * static_cast<double>(kDistanceOne) + 0.5);
    }
  }

  /// Interpolated values, in 2^-kFraction grey levels; `stride` is that of the images.
  template <int kFraction, typename Value>
  void linear(const ResliceRun& run, std::ptrdiff_t stride, Value* out) const {
    constexpr int kDrop = kLinearBits - kFraction;
    constexpr std::int64_t kHalf = std::int64_t{1} << (kDrop - 1);
    for (int u = run.first; u < run.end; ++u) {
      const auto i = static_cast<std::size_t>(u);
      std::int64_t value = linear_[i][0].value(stride) * (kDistanceOne - of_next_[i]);
      if (run.pair) value += linear_[i][1].value(stride) * of_next_[i];
      *out++ = static_cast<Value>((value + kHalf) >> kDrop);
    }
  }

 private:
  using Bilinear = typename FramePixels<Pixel>::Bilinear;

  std::vector<const Pixel*> nearest_;
  std::vector<std::array<Bilinear, 2>> linear_;
  std::vector<std::int64_t> of_next_;
};

}  // namespace fathom
