#include "sim/studies/scan_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "measurement/contour_surface.h"
#include "surface/shaded_picture.h"

namespace fathom {

namespace {

const cv::Size kPicture{420, 360};
constexpr double kBeside = 0.12;   // of the outlines' extent: the rectangles leave so much around them
constexpr double kFilled = 0.94;   // of the picture
constexpr double kSurface = 0.75;  // how much the surface hides what is behind it
const cv::Scalar kWhite(255, 255, 255);
const cv::Scalar kFrameColor(170, 120, 60);
const cv::Scalar kOutlineColor(30, 30, 200);
const cv::Scalar kSurfaceColor(205, 215, 220);

using Line = std::vector<Eigen::Vector3d>;

/// The rectangle about all of a structure's points, in pixels, with some room around them.
Eigen::AlignedBox2d extent_of(const Structure& structure) {
  Eigen::AlignedBox2d box;
  for (const Contour& contour : structure.contours) {
    for (const Eigen::Vector2d& point : contour.points_px) box.extend(point);
  }
  for (const Extremity& extremity : structure.extremities) box.extend(extremity.point_px);
  const Eigen::Vector2d room = kBeside * box.sizes();
  return {(box.min() - room).eval(), (box.max() + room).eval()};
}

Line in_space(const Polygon& points_px, const Eigen::Affine3d& reference_from_image) {
  Line line;
  for (const Eigen::Vector2d& point : points_px) {
    line.push_back(reference_from_image * Eigen::Vector3d(point.x(), point.y(), 0.0));
  }
  return line;
}

/// The frames that somebody outlined or marked.
std::set<int> looked_at(const Structure& structure) {
  std::set<int> frames;
  for (const Contour& contour : structure.contours) frames.insert(contour.frame);
  for (const Extremity& extremity : structure.extremities) frames.insert(extremity.frame);
  for (const AbsentMark& absent : structure.absent) frames.insert(absent.frame);
  return frames;
}

/// Looks along the sweep, from the side and from above, whichever way the images lie, and shows all of the frames.
OrthographicView view_of(const FrameLocator& locator, const std::vector<Line>& frames) {
  const auto middle = locator.reference_from_image(locator.frame_count() / 2);
  const Eigen::Vector3d x = middle->linear().col(0).normalized();
  const Eigen::Vector3d y = middle->linear().col(1).normalized();
  OrthographicView view;
  view.direction = (0.75 * x.cross(y) + 0.75 * x + 0.45 * y).normalized();
  view.up = -y;
  view.width_px = kPicture.width;
  view.height_px = kPicture.height;
  Eigen::Matrix3d picture_from_mm;
  picture_from_mm.row(0) = view.direction.cross(view.up).normalized();
  picture_from_mm.row(1) = picture_from_mm.row(0).transpose().cross(view.direction);
  picture_from_mm.row(2) = view.direction;
  Eigen::AlignedBox3d box;
  for (const Line& frame : frames) {
    for (const Eigen::Vector3d& corner : frame) box.extend(picture_from_mm * corner);
  }
  view.centre_mm = picture_from_mm.transpose() * box.center();
  view.px_per_mm = kFilled * std::min(kPicture.width / box.sizes().x(), kPicture.height / box.sizes().y());
  return view;
}

void draw(cv::Mat& picture, const std::vector<Line>& lines, const Eigen::Matrix<double, 2, 4>& px_from_mm,
          const cv::Scalar& color) {
  constexpr int kShift = 4;  // sixteenths of a pixel
  for (const Line& line : lines) {
    std::vector<cv::Point> points;
    for (const Eigen::Vector3d& x : line) {
      const Eigen::Vector2d at = px_from_mm * x.homogeneous() * (1 << kShift);
      points.emplace_back(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    }
    cv::polylines(picture, points, true, color, 1, cv::LINE_AA, kShift);
  }
}

/// The surface over what is drawn already.
void lay_over(cv::Mat& picture, const ShadedPicture& surface) {
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const double share = kSurface * surface.covered.at<std::uint8_t>(y, x) / 255.0;
      auto& below = picture.at<cv::Vec3b>(y, x);
      const auto& above = surface.picture.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c)
        below[c] = cv::saturate_cast<std::uint8_t>((1.0 - share) * below[c] + share * above[c]);
    }
  }
}

}  // namespace

cv::Mat scan_picture(const SimulateOptions& options) { return scan_picture(simulate(options)); }

cv::Mat scan_picture(const SimulatedScan& scan) { return scan_picture(scan, scan.outlines.front()); }

cv::Mat scan_picture(const SimulatedScan& scan, const Structure& structure) {
  const FrameLocator locator(*scan.recording, scan.calibration);
  const Eigen::AlignedBox2d box = extent_of(structure);
  const Polygon corners = {box.corner(Eigen::AlignedBox2d::BottomLeft), box.corner(Eigen::AlignedBox2d::BottomRight),
                           box.corner(Eigen::AlignedBox2d::TopRight), box.corner(Eigen::AlignedBox2d::TopLeft)};
  std::vector<Line> frames;
  for (const int frame : looked_at(structure)) {
    frames.push_back(in_space(corners, *locator.reference_from_image(frame)));
  }
  std::vector<Line> outlines;
  for (const Contour& contour : structure.contours) {
    outlines.push_back(in_space(contour.points_px, *locator.reference_from_image(contour.frame)));
  }

  ContourSurface surface(locator, {});
  ColoredMesh mesh{nullptr, kSurfaceColor};
  try {
    mesh.mesh = &surface.update(structure);
  } catch (const Error&) {
    static const Mesh none;
    mesh.mesh = &none;
  }
  Shading shading;
  shading.background = kWhite;
  const ShadedPicture shaded = shaded_picture({&mesh, 1}, view_of(locator, frames), shading);
  cv::Mat picture(kPicture, CV_8UC3, kWhite);
  draw(picture, frames, shaded.px_from_mm, kFrameColor);
  lay_over(picture, shaded);
  draw(picture, outlines, shaded.px_from_mm, kOutlineColor);
  return picture;
}

}  // namespace fathom
