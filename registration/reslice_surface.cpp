#include "registration/reslice_surface.h"

#include <cmath>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

namespace {

constexpr double kMaxSkew = 0.01;  // sine of it: axes that were typed with two digits are taken

struct OnWay {
  std::size_t leg = 0;  // from knot `leg` to the next
  double share = 0.0;   // of that leg
};

OnWay walk(const std::vector<double>& at_mm, double along_mm) {
  OnWay on;
  while (on.leg + 2 < at_mm.size() && at_mm[on.leg + 1] <= along_mm) ++on.leg;
  on.share = (along_mm - at_mm[on.leg]) / (at_mm[on.leg + 1] - at_mm[on.leg]);
  return on;
}

Eigen::Vector3d between(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double share) {
  return (1.0 - share) * a + share * b;
}

void require_spacing(double spacing_mm) {
  if (!(spacing_mm > 0.0) || !std::isfinite(spacing_mm)) throw Error("the pixels' spacing must be positive, in mm");
}

}  // namespace

void ResliceSurface::check() const {
  require_spacing(spacing_mm);
  if (columns < 1 || rows.empty()) throw Error("the picture has no pixels; give it a size in mm");
  if (static_cast<double>(columns) * static_cast<double>(rows.size()) > kMaxPixels) {
    throw Error("a picture of " + std::to_string(picture_size().width) + " x " + std::to_string(picture_size().height) +
                " pixels is too large; choose a larger spacing or a smaller size");
  }
  for (const ResliceRow& row : rows) {
    const Eigen::Vector3d end_mm = row.start_mm + columns * row.step_mm;
    if (!(row.start_mm.norm() < kFarthest_mm) || !(end_mm.norm() < kFarthest_mm) || !row.normal.allFinite()) {
      throw Error("the picture lies more than 10 km from the origin; give its place in mm");
    }
  }
}

cv::Size ResliceSurface::picture_size() const {
  const auto lines = static_cast<int>(rows.size());
  return turned ? cv::Size(lines, columns) : cv::Size(columns, lines);
}

int pixels_along(double length_mm, double spacing_mm) {
  require_spacing(spacing_mm);
  const double pixels = std::round(length_mm / spacing_mm);
  if (!(pixels <= ResliceSurface::kMaxPixels)) {
    throw Error("a spacing of " + format_real(spacing_mm) + " mm is too fine for a picture of " +
                format_real(length_mm) + " mm; choose a larger spacing or a smaller size");
  }
  return std::max(1, static_cast<int>(pixels));
}

ResliceSurface plane_surface(const ReslicePlane& plane) {
  require_spacing(plane.spacing_mm);
  const double lengths = plane.x_axis.norm() * plane.y_axis.norm();
  if (!(lengths > 0.0) || !std::isfinite(lengths)) throw Error("an axis of the picture has no direction; give x,y,z");
  const Eigen::Vector3d x = plane.x_axis.normalized();
  const double skew = x.dot(plane.y_axis.normalized());
  if (std::abs(skew) > kMaxSkew) {
    throw Error("the picture's axes are not perpendicular; turn one of them by " +
                format_real(std::round(std::asin(skew) * 1800.0 / M_PI) / 10.0) + " degrees");
  }
  const Eigen::Vector3d y = (plane.y_axis.normalized() - skew * x).normalized();
  if (static_cast<double>(plane.size.width) * plane.size.height > ResliceSurface::kMaxPixels) {
    throw Error("a picture of " + std::to_string(plane.size.width) + " x " + std::to_string(plane.size.height) +
                " pixels is too large; choose a larger spacing or a smaller size");
  }
  ResliceSurface surface;
  surface.columns = plane.size.width;
  surface.spacing_mm = plane.spacing_mm;
  for (int v = 0; v < plane.size.height; ++v) {
    surface.rows.push_back({plane.origin_mm + v * plane.spacing_mm * y, plane.spacing_mm * x, x.cross(y)});
  }
  surface.check();
  return surface;
}

ReslicePlane plane_through(const PlacedFrame& frame, double turn_rad, const std::vector<PlacedFrame>& frames,
                           cv::Size image_size, double spacing_mm, const cv::Size* size) {
  require_spacing(spacing_mm);
  const Eigen::Affine3d& map = frame.reference_from_image;
  const Eigen::Vector2d middle_px(0.5 * (image_size.width - 1), 0.5 * (image_size.height - 1));
  const Eigen::Vector3d middle_mm = map * Eigen::Vector3d(middle_px.x(), middle_px.y(), 0.0);
  const Eigen::Vector3d down = map.linear().col(1).normalized();
  const Eigen::Vector3d normal = frame_normal(map);
  const Eigen::Vector3d across = down.cross(normal);
  ReslicePlane plane;
  plane.spacing_mm = spacing_mm;
  plane.x_axis = std::cos(turn_rad) * across + std::sin(turn_rad) * normal;
  plane.y_axis = down;
  const Eigen::Vector3d axes[2] = {plane.x_axis, plane.y_axis};
  const int sizes[2] = {size != nullptr ? size->width : 0, size != nullptr ? size->height : 0};
  int* const found[2] = {&plane.size.width, &plane.size.height};
  plane.origin_mm = middle_mm;
  for (int k = 0; k < 2; ++k) {
    // Pixels before and after the middle. The middle lies on a pixel or between two as it does in the frame, so that
    // with the frame's own plane and spacing its pixels come back as they are.
    double before = 0.5 * (sizes[k] - 1);
    *found[k] = sizes[k];
    if (size == nullptr) {
      double low = 0.0, high = 0.0;
      for (const PlacedFrame& other : frames) {
        for (int corner = 0; corner < 4; ++corner) {
          const Eigen::Vector3d px(corner % 2 * (image_size.width - 1), corner / 2 * (image_size.height - 1), 0.0);
          const double mm = axes[k].dot(other.reference_from_image * px - middle_mm);
          low = std::min(low, mm);
          high = std::max(high, mm);
        }
      }
      constexpr double kRounding = 1e-6;  // of a pixel: an edge that lies on a pixel's centre needs no further pixel
      const double half = middle_px[k] - std::floor(middle_px[k]);
      before = std::ceil(-low / spacing_mm - half - kRounding) + half;
      const double after = std::ceil(high / spacing_mm - half - kRounding) + half;
      *found[k] = pixels_along((before + after + 1.0) * spacing_mm, spacing_mm);
    }
    plane.origin_mm -= before * spacing_mm * axes[k];
  }
  return plane;
}

ResliceSurface curved_surface(const std::vector<Eigen::Vector3d>& points_mm, const Eigen::Vector3d& direction,
                              double height_mm, double spacing_mm) {
  const double length = direction.norm();
  if (!(length > 0.0) || !std::isfinite(length)) {
    throw Error("the direction in which the curve is swept has no length; give x,y,z");
  }
  const Eigen::Vector3d down = direction / length;
  std::vector<Eigen::Vector3d> knots;
  std::vector<double> at_mm;
  for (const Eigen::Vector3d& point : points_mm) {
    const Eigen::Vector3d level = point - down.dot(point - points_mm.front()) * down;
    const double step_mm = knots.empty() ? 0.0 : (level - knots.back()).norm();
    if (!knots.empty() && !(step_mm > 0.0)) {
      throw Error("two points of the curve that follow each other lie in one line with its direction; leave one out");
    }
    at_mm.push_back(knots.empty() ? 0.0 : at_mm.back() + step_mm);
    knots.push_back(level);
  }
  if (knots.size() < 2) throw Error("a curve needs two points or more; give them in order");
  ResliceSurface surface;
  surface.turned = true;
  surface.spacing_mm = spacing_mm;
  surface.columns = pixels_along(height_mm, spacing_mm);
  const int lines = pixels_along(at_mm.back(), spacing_mm);
  for (int v = 0; v < lines; ++v) {
    const OnWay on = walk(at_mm, v * spacing_mm);
    const Eigen::Vector3d along = (knots[on.leg + 1] - knots[on.leg]).normalized();
    surface.rows.push_back({between(knots[on.leg], knots[on.leg + 1], on.share), spacing_mm * down, along.cross(down)});
  }
  surface.check();
  return surface;
}

ResliceSurface panorama_surface(const std::vector<PlacedFrame>& frames, cv::Size image_size, double column_px,
                                double spacing_mm, double knot_mm) {
  require_spacing(spacing_mm);
  const double bottom_px = image_size.height - 1.0;
  struct Knot {
    Eigen::Vector3d top, bottom;
  };
  std::vector<Knot> knots;
  std::vector<double> at_mm;
  double height_mm = 0.0;
  for (const PlacedFrame& frame : frames) {
    const Eigen::Affine3d& map = frame.reference_from_image;
    const Knot knot{map * Eigen::Vector3d(column_px, 0.0, 0.0), map * Eigen::Vector3d(column_px, bottom_px, 0.0)};
    const double step_mm =
        knots.empty() ? 0.0 : 0.5 * (knot.top + knot.bottom - knots.back().top - knots.back().bottom).norm();
    if (!knots.empty() && step_mm < knot_mm) continue;
    at_mm.push_back(knots.empty() ? 0.0 : at_mm.back() + step_mm);
    height_mm = (knot.bottom - knot.top).norm();
    knots.push_back(knot);
  }
  if (knots.size() < 2) throw Error("the probe stays within 1 mm, so that there is no way to follow; choose a plane");
  ResliceSurface surface;
  surface.turned = true;
  surface.spacing_mm = spacing_mm;
  surface.columns = pixels_along(height_mm + spacing_mm, spacing_mm);
  const int lines = pixels_along(at_mm.back() + spacing_mm, spacing_mm);
  for (int v = 0; v < lines; ++v) {
    const OnWay on = walk(at_mm, v * spacing_mm);
    const Knot& a = knots[on.leg];
    const Knot& b = knots[on.leg + 1];
    const Eigen::Vector3d top = between(a.top, b.top, on.share);
    const Eigen::Vector3d down = (between(a.bottom, b.bottom, on.share) - top).normalized();
    const Eigen::Vector3d along = (b.top + b.bottom - a.top - a.bottom).normalized();
    surface.rows.push_back({top, spacing_mm * down, along.cross(down).normalized()});
  }
  surface.check();
  return surface;
}

}  // namespace fathom
