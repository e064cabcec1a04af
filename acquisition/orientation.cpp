#include "acquisition/orientation.h"

#include <opencv2/core.hpp>

#include "acquisition/header_text.h"

namespace fathom {

std::optional<Orientation> parse_orientation(std::string_view text) {
  if (text.size() == 3 && equal_ignoring_case(text.substr(2), "A")) text.remove_suffix(1);
  if (equal_ignoring_case(text, "MF")) return Orientation{};
  if (equal_ignoring_case(text, "UF")) return Orientation{.flip_x = true};
  if (equal_ignoring_case(text, "MN")) return Orientation{.flip_y = true};
  if (equal_ignoring_case(text, "UN")) return Orientation{.flip_x = true, .flip_y = true};
  return std::nullopt;
}

void flip_to_mf(cv::Mat& image, const Orientation& stored) {
  if (stored.is_mf()) return;
  cv::flip(image, image, stored.flip_x && stored.flip_y ? -1 : stored.flip_x ? 1 : 0);
}

}  // namespace fathom
