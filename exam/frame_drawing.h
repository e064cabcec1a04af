#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "segmentation/contours.h"

namespace fathom {

/// What the pictures have in common. Colours are in the order of OpenCV: blue, green, red.
inline const cv::Scalar kPictureBackground(24, 17, 13);
inline const cv::Scalar kPictureLine(92, 80, 70);
inline const cv::Scalar kPictureText(225, 220, 215);

/// Points of a canvas with the bits of sub-pixel precision that `draw_polyline` draws with.
std::vector<cv::Point> fixed_point(std::span<const Eigen::Vector2d> points);
inline constexpr int kFractionBits = 4;

void draw_polyline(cv::Mat& canvas, std::span<const Eigen::Vector2d> points, bool closed, const cv::Scalar& color,
                   int thickness);

/// `scale` 1 is the size of the report's captions. (x, y) is where the first letter stands.
void draw_text(cv::Mat& canvas, const std::string& text, cv::Point at, double scale = 1.0);

/// A B-scan with the contours of one frame of one recording, as large as fits into the middle of `place`, dimmed so
/// that contours stand out on white. Images that are not of 8 bits are shown from their smallest value to their
/// largest.
void draw_frame(cv::Mat& canvas, const cv::Rect& place, const cv::Mat& image, const std::vector<Structure>& structures,
                int frame, int recording, int thickness);

}  // namespace fathom
