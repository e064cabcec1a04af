#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>

namespace fathom {

/// Where the image lies relative to the probe's sensor, and how far the tracker's clock is off.
struct Calibration {
  /// Maps pixels (x right, y down, (0, 0) the centre of the top-left pixel, z = 0) to millimetres in probe
  /// coordinates. Its third column is the plane's normal (x cross y) times the mean pixel size.
  Eigen::Affine3d probe_from_image = Eigen::Affine3d::Identity();
  /// Positive: the tracker's stamps lag the image's. The pose of a frame stamped t is the tracker's at t + latency_s.
  double latency_s = 0.0;
  std::optional<std::string> probe_frame;      ///< name of the probe's coordinates in recordings
  std::optional<std::string> reference_frame;  ///< name of the coordinates that results are given in
  std::optional<double> rms_mm;
  std::vector<std::string> parameters;  ///< those fitted: "tx_mm", ..., "latency_s"
  Eigen::MatrixXd covariance;           ///< of `parameters`, same order; empty where unknown
  std::optional<cv::Size> image_size;   ///< pixels; a recording of another size is refused
  std::optional<double> depth_mm;
  std::string probe;  ///< free text
  std::string date;   ///< free text
};

/// Reads Fathom's JSON or a PLUS XML (the `Image` to `Probe` transform under CoordinateDefinitions or
/// CalibrationResults; `probe_frame` names another target to look for first). The file's first bytes decide.
/// Throws Error when the file is damaged, longer than 8 MB, has no such transform, or the transform is not finite, is
/// singular, or does not look like millimetres per pixel.
Calibration read_calibration(const std::filesystem::path& path, const std::optional<std::string>& probe_frame = {});

/// The text of Fathom's JSON calibration file; reads back as the same calibration.
std::string calibration_json(const Calibration& calibration);

}  // namespace fathom
