#include "registration/calibration.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/json.h"
#include "core/numbers.h"
#include "core/text_file.h"
#include "registration/plus_xml.h"

namespace fathom {

namespace {

constexpr std::uintmax_t kMaxBytes = 8u << 20;  // results of PLUS have 1 MB; parsed, XML takes 50 times its length
constexpr double kMinPixelMm = 0.002;  // a quarter of the finest ophthalmic scanner's: smaller means metres or worse
constexpr double kMaxPixelMm = 5.0;    // a B-scan of 500 pixels would be 2.5 m wide
constexpr double kMaxSkewCosine = 0.5;
constexpr int kMaxImageSide = 65535;

// Checks a matrix from a file and brings its third column to the convention of the header.
Eigen::Affine3d checked_probe_from_image(Eigen::Matrix4d matrix, const std::string& file) {
  const std::string what = file + ": the image-to-probe transform ";
  if (!matrix.allFinite()) throw Error(what + "is not finite; calibrate again");
  if (!matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-9)) {
    throw Error(what + "does not end in the row 0 0 0 1; check that its numbers are in row order");
  }
  const Eigen::Vector3d x = matrix.block<3, 1>(0, 0);
  const Eigen::Vector3d y = matrix.block<3, 1>(0, 1);
  for (const double size : {x.norm(), y.norm()}) {
    if (size < kMinPixelMm || size > kMaxPixelMm) {
      throw Error(what + "gives pixels of " + format_real(size) + " mm, which no scanner makes; it must be in " +
                  "millimetres per pixel");
    }
  }
  if (std::abs(x.normalized().dot(y.normalized())) > kMaxSkewCosine) {
    throw Error(what + "is singular or skewed beyond 30 degrees; calibrate again");
  }
  matrix.block<3, 1>(0, 2) = x.cross(y).normalized() * 0.5 * (x.norm() + y.norm());
  return Eigen::Affine3d(matrix);
}

Eigen::MatrixXd read_covariance(const JsonValue& rows, std::size_t parameters) {
  const auto n = static_cast<Eigen::Index>(parameters);
  if (rows.size() != parameters) rows.fail("must be a square matrix, a row for each of \"parameters\"");
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const JsonValue row = rows[static_cast<std::size_t>(i)];
    if (row.size() != parameters) row.fail("must have a number for each of \"parameters\"");
    for (Eigen::Index j = 0; j < n; ++j) covariance(i, j) = row[static_cast<std::size_t>(j)].number();
  }
  if (!covariance.isApprox(covariance.transpose(), 1e-6) || (covariance.diagonal().array() < 0.0).any()) {
    rows.fail("is not the covariance of anything: it must be symmetric, with no negative variance");
  }
  return covariance;
}

Calibration from_json(const std::filesystem::path& path) {
  const nlohmann::json document = JsonValue::read_file(path);
  const JsonValue root(document, path);
  require_version(root, "fathom_calibration", 1);

  Calibration calibration;
  const JsonValue numbers = root.at("image_to_probe");
  if (numbers.size() != 16) numbers.fail("must have 16 numbers, a 4x4 matrix row by row");
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = numbers[static_cast<std::size_t>(i)].number();
  calibration.probe_from_image = checked_probe_from_image(matrix, path.string());

  const auto optional = [&root](const char* key) { return root.has(key) && !root.at(key).is_null(); };
  if (optional("latency_s")) calibration.latency_s = root.at("latency_s").number();
  if (optional("probe_frame")) calibration.probe_frame = root.at("probe_frame").string();
  if (optional("reference_frame")) calibration.reference_frame = root.at("reference_frame").string();
  if (optional("rms_mm")) calibration.rms_mm = root.at("rms_mm").number();
  if (optional("depth_mm")) calibration.depth_mm = root.at("depth_mm").number();
  if (optional("probe")) calibration.probe = root.at("probe").string();
  if (optional("date")) calibration.date = root.at("date").string();
  if (optional("parameters")) {
    const JsonValue names = root.at("parameters");
    for (std::size_t i = 0; i < names.size(); ++i) calibration.parameters.push_back(names[i].string());
  }
  if (optional("covariance")) {
    calibration.covariance = read_covariance(root.at("covariance"), calibration.parameters.size());
  }
  if (optional("width") != optional("height")) root.fail("\"width\" and \"height\" must be given together");
  if (optional("width")) {
    calibration.image_size =
        cv::Size(root.at("width").integer(1, kMaxImageSide), root.at("height").integer(1, kMaxImageSide));
  }
  return calibration;
}

Calibration from_plus_xml(const std::filesystem::path& path, const std::string& text,
                          const std::optional<std::string>& probe_frame) {
  // The recording may call the probe otherwise than the calibration does: "Tool", say.
  auto matrix = plus_transform(text, "Image", probe_frame.value_or("Probe"), path.string());
  if (!matrix && probe_frame) matrix = plus_transform(text, "Image", "Probe", path.string());
  if (!matrix) {
    throw Error(
        path.string() +
        ": has no transform from Image to Probe; calibrate the probe, or name its coordinates with --probe-frame");
  }
  Calibration calibration;
  calibration.probe_from_image = checked_probe_from_image(*matrix, path.string());
  if (probe_frame) calibration.probe_frame = *probe_frame;
  return calibration;
}

}  // namespace

Calibration read_calibration(const std::filesystem::path& path, const std::optional<std::string>& probe_frame) {
  const std::string text = read_text_file(path, kMaxBytes);
  const std::size_t start = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (start == std::string::npos) throw Error(path.string() + ": is empty; give a calibration file");
  return text[start] == '<' ? from_plus_xml(path, text, probe_frame) : from_json(path);
}

std::string calibration_json(const Calibration& calibration) {
  nlohmann::ordered_json json;
  json["fathom_calibration"] = 1;
  auto& numbers = json["image_to_probe"] = nlohmann::ordered_json::array();
  for (int i = 0; i < 16; ++i) numbers.push_back(calibration.probe_from_image.matrix()(i / 4, i % 4));
  json["latency_s"] = calibration.latency_s;
  if (calibration.probe_frame) json["probe_frame"] = *calibration.probe_frame;
  if (calibration.reference_frame) json["reference_frame"] = *calibration.reference_frame;
  if (calibration.rms_mm) json["rms_mm"] = *calibration.rms_mm;
  if (!calibration.parameters.empty()) json["parameters"] = calibration.parameters;
  if (calibration.covariance.size() > 0) {
    auto& rows = json["covariance"] = nlohmann::ordered_json::array();
    for (const auto row : calibration.covariance.rowwise()) rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  if (calibration.image_size) {
    json["width"] = calibration.image_size->width;
    json["height"] = calibration.image_size->height;
  }
  if (calibration.depth_mm) json["depth_mm"] = *calibration.depth_mm;
  if (!calibration.probe.empty()) json["probe"] = calibration.probe;
  if (!calibration.date.empty()) json["date"] = calibration.date;
  return json.dump(1, ' ') + "\n";
}

}  // namespace fathom
