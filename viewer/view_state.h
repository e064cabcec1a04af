#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

namespace fathom {

/// What the mouse does in the Review pane.
enum class Tool {
  kBrowse,
  kDraw,
  kWire,
  kRegion,
  kThreshold,
  kRefine,
  kPoints,
  kBrush,
  kExtremity,
  kDistance,
  kAngle,
  kArea
};

/// One point of one contour.
struct PointChoice {
  std::size_t contour = 0;
  std::size_t point = 0;
};

/// Settings of Region, Threshold and Refine.
struct AssistOptions {
  float tolerance = 2.5F;    ///< Region: standard deviations of its grey values that still belong to it
  float low = 127.5F;        ///< Threshold: grey values from here on
  float high = 255.0F;       ///< and up to here
  float even_out_px = 2.0F;  ///< both: standard deviation of the Gaussian that evens out speckle first
  float reach_px = 8.0F;     ///< Refine: no point moves farther
  bool operator==(const AssistOptions&) const = default;
};

/// What is looked at, and how: no part of the exam, neither undone nor saved in it.
struct ViewState {
  int recording = 0;
  int frame = 0;
  std::size_t structure = 0;  ///< the one that tools work on
  Tool tool = Tool::kBrowse;
  float brush_px = 30.0F;  ///< radius, in pixels of the image

  AssistOptions assist;
  std::vector<Eigen::Vector2d> seeds_px;                 ///< of Region and Threshold, on the shown frame
  std::vector<std::vector<Eigen::Vector2d>> preview_px;  ///< closed outlines that a tool would draw there

  float grey_low = 0.0F;  ///< what grey values may be: those of 8 bits, else those of the first frame shown
  float grey_high = 255.0F;
  float level = 127.5F;  ///< grey value shown as middle grey
  float window = 255.0F;
  float zoom = 0.0F;                                    ///< window's pixels a pixel; 0: the whole image
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();  ///< image's pixel in the pane's middle, where zoomed

  std::vector<Eigen::Vector2d> line_px;   ///< being drawn, on the shown frame
  std::vector<Eigen::Vector2d> ruler_px;  ///< points of a distance, angle or area, on the shown frame
  std::optional<PointChoice> chosen;      ///< of the active structure

  /// What was begun on a frame and is no part of the exam ends with it.
  void drop_unfinished() {
    line_px.clear();
    ruler_px.clear();
    seeds_px.clear();
    preview_px.clear();
    chosen.reset();
  }

  bool show_outlines = true;
  bool show_hatching = true;
  bool show_surfaces = true;
  bool show_posts = true;
  bool show_planes = true;

  /// For a picture that tells nobody's name: no texts of the exam and names of files, and of B-scans only this part.
  bool hides_names = false;
  std::optional<cv::Rect> nameless_px;  ///< empty: no B-scan at all
};

/// The names of tools, in the order of Tool.
inline constexpr std::size_t kToolCount = 12;

}  // namespace fathom
