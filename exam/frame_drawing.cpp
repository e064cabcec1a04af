#include "exam/frame_drawing.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "exam/scene_view.h"

namespace fathom {

namespace {

// The largest grey value becomes white, the smallest black, if the image is not of 8 bits already.
cv::Mat display_image(const cv::Mat& image) {
  cv::Mat grey = image;
  if (image.depth() != CV_8U) cv::normalize(image, grey, 0, 255, cv::NORM_MINMAX, CV_8U);
  cv::Mat color;
  cv::cvtColor(grey, color, grey.channels() == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_GRAY2BGR);
  return color;
}

}  // namespace

std::vector<cv::Point> fixed_point(std::span<const Eigen::Vector2d> points) {
  std::vector<cv::Point> fixed;
  fixed.reserve(points.size());
  for (const Eigen::Vector2d& point : points) {
    fixed.emplace_back(cvRound(std::ldexp(point.x(), kFractionBits)), cvRound(std::ldexp(point.y(), kFractionBits)));
  }
  return fixed;
}

void draw_polyline(cv::Mat& canvas, std::span<const Eigen::Vector2d> points, bool closed, const cv::Scalar& color,
                   int thickness) {
  cv::polylines(canvas, std::vector{fixed_point(points)}, closed, color, thickness, cv::LINE_AA, kFractionBits);
}

void draw_text(cv::Mat& canvas, const std::string& text, cv::Point at, double scale) {
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.62 * scale, kPictureText, 1, cv::LINE_AA);
}

void draw_frame(cv::Mat& canvas, const cv::Rect& place, const cv::Mat& image, const std::vector<Structure>& structures,
                int frame, int recording, int thickness) {
  cv::Mat pane = canvas(place);
  const double scale =
      std::min(static_cast<double>(pane.cols) / image.cols, static_cast<double>(pane.rows) / image.rows);
  const cv::Size size(std::clamp(cvRound(scale * image.cols), 1, pane.cols),
                      std::clamp(cvRound(scale * image.rows), 1, pane.rows));
  const Eigen::Vector2d origin(0.5 * (pane.cols - scale * image.cols), 0.5 * (pane.rows - scale * image.rows));
  cv::Mat resized;
  cv::resize(display_image(image), resized, size, 0.0, 0.0, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  const cv::Point corner(std::min(cvRound(origin.x()), pane.cols - size.width),
                         std::min(cvRound(origin.y()), pane.rows - size.height));
  const cv::Rect inner(corner, size);
  resized.convertTo(pane(inner), -1, 0.75);
  cv::rectangle(pane, inner, kPictureLine, 1);
  for (const Structure& structure : structures) {
    for (const Contour& contour : structure.contours) {
      if (contour.frame != frame || contour.recording != recording) continue;
      Polygon drawn;
      for (const Eigen::Vector2d& point : contour.points_px) {
        drawn.push_back(origin + scale * (point + Eigen::Vector2d(0.5, 0.5)));
      }
      draw_polyline(pane, drawn, contour.closed, color_of(structure), thickness);
    }
  }
}

}  // namespace fathom
