#pragma once

#include <optional>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace fathom {

/// How stored pixels differ from MF orientation, in which x runs to the marked side of the probe and y away from it.
struct Orientation {
  bool flip_x = false;  ///< stored x runs to the unmarked side: UF, UN
  bool flip_y = false;  ///< stored y runs towards the probe: MN, UN

  bool is_mf() const { return !flip_x && !flip_y; }
  bool operator==(const Orientation&) const = default;
};

/// Reads PLUS's "MF", "UF", "MN", "UN", also with the third letter A (frames in ascending order) as in "MFA", in
/// capital or small letters. Empty for everything else, such as the transposed "FM" of radio-frequency data.
std::optional<Orientation> parse_orientation(std::string_view text);

/// Brings an image to MF in place. Doing it twice gives the image back.
void flip_to_mf(cv::Mat& image, const Orientation& stored);

}  // namespace fathom
