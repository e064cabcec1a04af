#include "registration/fan_mask.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace fathom {

void Fan::check() const {
  const bool finite = origin_px.allFinite() && std::isfinite(max_radius_px) && std::isfinite(pixel_aspect);
  if (!finite || !(min_radius_px >= 0.0 && min_radius_px < max_radius_px)) {
    throw Error("the fan's radii must be finite, not negative, and the second larger than the first; give them anew");
  }
  if (!(min_angle_rad > -std::numbers::pi && min_angle_rad < max_angle_rad && max_angle_rad < std::numbers::pi)) {
    throw Error("the fan's angles must lie between -180 and 180 degrees, the second larger than the first");
  }
  if (!(pixel_aspect > 0.0)) throw Error("the fan's pixel aspect must be positive");
}

bool Fan::contains(double x_px, double y_px) const {
  const double across = (x_px - origin_px.x()) * pixel_aspect;
  const double down = y_px - origin_px.y();
  const double radius = std::hypot(across, down);
  if (radius < min_radius_px || radius > max_radius_px) return false;
  const double angle = std::atan2(across, down);
  return radius == 0.0 || (angle >= min_angle_rad && angle <= max_angle_rad);
}

bool PixelArea::contains(int x, int y) const {
  if (y < 0 || y >= static_cast<int>(rows.size())) return false;
  const auto& spans = rows[static_cast<std::size_t>(y)];
  return std::any_of(spans.begin(), spans.end(), [x](const PixelSpan& s) { return x >= s.first && x < s.end; });
}

PixelArea pixel_area(cv::Size image_size, const cv::Rect& clip, const std::optional<Fan>& fan) {
  PixelArea area;
  area.rows.resize(static_cast<std::size_t>(image_size.height));
  if (fan) fan->check();
  for (int y = clip.y; y < clip.y + clip.height; ++y) {
    auto& spans = area.rows[static_cast<std::size_t>(y)];
    if (!fan) {
      spans.push_back({clip.x, clip.x + clip.width});
      continue;
    }
    bool inside = false;
    for (int x = clip.x; x < clip.x + clip.width; ++x) {
      const bool now = fan->contains(x, y);
      if (now && !inside) spans.push_back({x, x});
      if (now) spans.back().end = x + 1;
      inside = now;
    }
  }
  return area;
}

}  // namespace fathom
