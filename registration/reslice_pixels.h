#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

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
        mask(&frames.mask) {}

  Pixel at(std::int64_t x, std::int64_t y) const { return first[y * stride + x]; }
  bool used(std::int64_t x, std::int64_t y) const {
    return mask->at<std::uint8_t>(static_cast<int>(y), static_cast<int>(x)) != 0;
  }
};

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

/// The pixel that holds a place; the nearest one for places that rounding put just outside of the image.
template <typename Pixel>
Pixel nearest_pixel(const FramePixels<Pixel>& image, const ImageWalk& at) {
  const std::int64_t x = std::clamp<std::int64_t>(at.x >> kPixelBits, 0, image.width - 1);
  const std::int64_t y = std::clamp<std::int64_t>(at.y >> kPixelBits, 0, image.height - 1);
  return image.at(x, y);
}

/// Weighted by the distances from the four pixels around, in 2^-kBilinearBits; the outermost pixels go on for the half
/// pixel to the image's edge. Pixels that are not used have no weight.
template <typename Pixel>
std::int64_t bilinear_pixel(const FramePixels<Pixel>& image, const ImageWalk& at) {
  const std::int64_t share_x = (at.x >> (kPixelBits - kShareBits)) & (kShareOne - 1);
  const std::int64_t share_y = (at.y >> (kPixelBits - kShareBits)) & (kShareOne - 1);
  const std::int64_t x = at.x >> kPixelBits;
  const std::int64_t y = at.y >> kPixelBits;
  if (x >= 0 && y >= 0 && x + 1 < image.width && y + 1 < image.height && image.mask->empty()) {
    const Pixel* const pixel = image.first + y * image.stride + x;
    const Pixel* const below = pixel + image.stride;
    const std::int64_t upper = pixel[0] * (kShareOne - share_x) + pixel[1] * share_x;
    const std::int64_t lower = below[0] * (kShareOne - share_x) + below[1] * share_x;
    return upper * (kShareOne - share_y) + lower * share_y;
  }
  std::int64_t sum = 0;
  std::int64_t weights = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const std::int64_t px = std::clamp<std::int64_t>(x + (corner & 1), 0, image.width - 1);
    const std::int64_t py = std::clamp<std::int64_t>(y + (corner >> 1), 0, image.height - 1);
    if (!image.mask->empty() && !image.used(px, py)) continue;
    const std::int64_t weight =
        ((corner & 1) != 0 ? share_x : kShareOne - share_x) * ((corner >> 1) != 0 ? share_y : kShareOne - share_y);
    weights += weight;
    sum += weight * image.at(px, py);
  }
  constexpr std::int64_t kAll = kShareOne * kShareOne;
  if (weights == kAll) return sum;
  return weights == 0 ? 0 : static_cast<std::int64_t>(static_cast<double>(sum) / static_cast<double>(weights) * kAll);
}

/// Nearest pixels of a run's columns: of `a`, or of `b`, the next frame, where that is nearer.
template <typename Pixel>
void nearest_run(const RowFunctions& functions, const ResliceRun& run, const FramePixels<Pixel>& a,
                 const FramePixels<Pixel>* b, Pixel* out) {
  constexpr std::int64_t kHalf = kPixel / 2;
  ImageWalk in_a(functions, run.frame, run.first, kHalf);
  if (b == nullptr) {
    for (int u = run.first; u < run.end; ++u, in_a.next()) *out++ = nearest_pixel(a, in_a);
    return;
  }
  ImageWalk in_b(functions, run.frame + 1, run.first, kHalf);
  for (int u = run.first; u < run.end; ++u, in_a.next(), in_b.next()) {
    const bool first = std::abs(functions.distance(run.frame, u)) <= std::abs(functions.distance(run.frame + 1, u));
    *out++ = first ? nearest_pixel(a, in_a) : nearest_pixel(*b, in_b);
  }
}

/// Interpolated values of a run's columns, in 2^-kFraction grey levels.
template <int kFraction, typename Pixel, typename Value>
void linear_run(const RowFunctions& functions, const ResliceRun& run, const FramePixels<Pixel>& a,
                const FramePixels<Pixel>* b, Value* out) {
  constexpr std::int64_t kHalfShare = kPixel >> (kShareBits + 1);  // so that shares are rounded, not cut
  constexpr int kDrop = kLinearBits - kFraction;
  constexpr std::int64_t kHalf = std::int64_t{1} << (kDrop - 1);
  ImageWalk in_a(functions, run.frame, run.first, kHalfShare);
  if (b == nullptr) {
    for (int u = run.first; u < run.end; ++u, in_a.next()) {
      *out++ = static_cast<Value>((bilinear_pixel(a, in_a) * kDistanceOne + kHalf) >> kDrop);
    }
    return;
  }
  ImageWalk in_b(functions, run.frame + 1, run.first, kHalfShare);
  for (int u = run.first; u < run.end; ++u, in_a.next(), in_b.next()) {
    const double from_a = functions.distance(run.frame, u);
    const double gap = from_a - functions.distance(run.frame + 1, u);
    const double share = gap != 0.0 ? std::clamp(from_a / gap, 0.0, 1.0) : 0.0;
    const auto of_b = static_cast<std::int64_t>(share * static_cast<double>(kDistanceOne) + 0.5);
    const std::int64_t value = bilinear_pixel(a, in_a) * (kDistanceOne - of_b) + bilinear_pixel(*b, in_b) * of_b;
    *out++ = static_cast<Value>((value + kHalf) >> kDrop);
  }
}

}  // namespace fathom
