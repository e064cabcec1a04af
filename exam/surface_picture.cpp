#include "exam/surface_picture.h"

#include <cassert>

#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "exam/scene_view.h"
#include "surface/shaded_picture.h"

namespace fathom {

namespace {

constexpr int kWidth = 1200;  // pixels
constexpr int kHeight = 900;
constexpr int kMargin = 40;
constexpr int kLine = 30;     // height of a caption
constexpr int kFraction = 4;  // bits of sub-pixel precision of OpenCV's drawing
constexpr double kLineShade = 0.35;
const cv::Scalar kText(225, 220, 215);

// The part of a contour that faces the viewer: where the surface's normal at the nearest place, which is across the
// contour and within its plane, points towards the viewer.
void draw_contour(cv::Mat& picture, const ShadedPicture& shaded, const Eigen::Affine3d& reference_from_image,
                  const Contour& contour, const Eigen::Vector3d& towards_viewer, const cv::Scalar& color) {
  const std::size_t count = contour.points_px.size();
  double twice_area = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d& a = contour.points_px[i];
    const Eigen::Vector2d& b = contour.points_px[(i + 1) % count];
    twice_area += a.x() * b.y() - a.y() * b.x();
  }
  const double way = twice_area > 0.0 ? 1.0 : -1.0;
  const auto in_picture = [&](const Eigen::Vector2d& px) {
    const Eigen::Vector3d mm = reference_from_image * Eigen::Vector3d(px.x(), px.y(), 0.0);
    const Eigen::Vector2d at = shaded.px_from_mm * mm.homogeneous();
    return cv::Point(cvRound(std::ldexp(at.x(), kFraction)), cvRound(std::ldexp(at.y(), kFraction)));
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d& a = contour.points_px[i];
    const Eigen::Vector2d& b = contour.points_px[(i + 1) % count];
    const Eigen::Vector3d out =
        reference_from_image.linear() * Eigen::Vector3d(way * (b.y() - a.y()), way * (a.x() - b.x()), 0.0);
    if (out.dot(towards_viewer) <= 0.0) continue;
    cv::line(picture, in_picture(a), in_picture(b), color, 1, cv::LINE_AA, kFraction);
  }
}

}  // namespace

cv::Mat surface_picture(const std::vector<Mesh>& meshes, const FrameLocator& locator,
                        const std::vector<Structure>& structures, const std::vector<std::string>& captions) {
  assert(meshes.size() == structures.size());
  std::vector<ColoredMesh> colored;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    colored.push_back({&meshes[i], color_of(structures[i])});
    points.insert(points.end(), meshes[i].vertices.begin(), meshes[i].vertices.end());
  }
  if (points.empty()) throw Error("there is no surface to picture; outline a structure first");
  const Eigen::Matrix3d view = scene_view(points, mean_depth(locator, structures));
  OrthographicView camera;
  camera.direction = view.row(2).transpose();
  camera.up = -view.row(1).transpose();
  camera.width_px = kWidth;
  camera.height_px = kHeight;
  Shading shading;
  shading.samples_per_px = 2;
  const ShadedPicture shaded = shaded_picture(colored, camera, shading);

  const int caption_height = kMargin + kLine * static_cast<int>(captions.size());
  cv::Mat canvas(kHeight + caption_height, kWidth, CV_8UC3, shading.background);
  shaded.picture.copyTo(canvas(cv::Rect(0, 0, kWidth, kHeight)));
  // Where several structures hide each other, lines would shine through.
  if (structures.size() == 1) {
    for (const Contour& contour : structures.front().contours) {
      const auto reference_from_image = locator.reference_from_image(contour.frame);
      if (!reference_from_image) continue;
      draw_contour(canvas, shaded, *reference_from_image, contour, -camera.direction,
                   kLineShade * color_of(structures.front()));
    }
  }
  for (std::size_t i = 0; i < captions.size(); ++i) {
    cv::putText(canvas, captions[i], {kMargin, kHeight + kLine * static_cast<int>(i + 1)}, cv::FONT_HERSHEY_SIMPLEX,
                0.62, kText, 1, cv::LINE_AA);
  }
  return canvas;
}

}  // namespace fathom
