#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "registration/calibration.h"

namespace fathom {

/// A setting of the scanner under which pictures of one geometry come.
struct ImagePreset {
  std::string name;
  cv::Size image_size;                 ///< of the whole pictures, pixels
  double depth_mm = 0.0;               ///< as the scanner states it
  Eigen::Vector2d pixel_mm{0.0, 0.0};  ///< width and height of a pixel
  std::optional<cv::Rect> crop;        ///< the part to keep; all where empty

  /// Throws Error unless sizes are positive and finite, and the crop lies within the picture.
  void check() const;
};

/// `{"fathom_image_presets": 1, "presets": [{"name", "width", "height", "depth_mm", "pixel_mm": [x, y], "crop": [x, y,
/// width, height]}]}`; the crop may be absent. Throws Error where the file is damaged or two presets have one name.
std::vector<ImagePreset> read_image_presets(const std::filesystem::path& path);
std::string image_presets_json(const std::vector<ImagePreset>& presets);

/// The part to keep, as a view of the same memory: nothing is copied. Throws Error unless `image` has the preset's
/// size.
cv::Mat cropped(const cv::Mat& image, const ImagePreset& preset);

/// The calibration of the part to keep, from that of whole pictures: pixel (0, 0) is the crop's first. The covariance
/// of parameters, which is that of the whole picture's origin, is left out.
/// Throws Error when the calibration is of another size, depth (1 %) or pixel size (2 %) than the preset.
Calibration cropped(const Calibration& calibration, const ImagePreset& preset);

}  // namespace fathom
