#include "registration/image_preset.h"

#include <cmath>
#include <set>

#include "core/error.h"
#include "core/json.h"
#include "core/numbers.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr int kLargest_px = 65'535;
constexpr double kDepthTolerance = 0.01;
// Calibrations find pixel sizes with some error.
constexpr double kPixelTolerance = 0.02;

std::string text_of(const cv::Size& size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

ImagePreset read_preset(const JsonValue& value) {
  ImagePreset preset;
  preset.name = value.at("name").string();
  preset.image_size = {value.at("width").integer(1, kLargest_px), value.at("height").integer(1, kLargest_px)};
  preset.depth_mm = value.at("depth_mm").number();
  const JsonValue pixel = value.at("pixel_mm");
  if (pixel.size() != 2) pixel.fail("must be two numbers: width and height of a pixel in mm");
  preset.pixel_mm = {pixel[0].number(), pixel[1].number()};
  if (value.has("crop")) {
    const JsonValue crop = value.at("crop");
    if (crop.size() != 4) crop.fail("must be four numbers: x, y, width, height");
    preset.crop = cv::Rect(crop[0].integer(0, kLargest_px), crop[1].integer(0, kLargest_px),
                           crop[2].integer(1, kLargest_px), crop[3].integer(1, kLargest_px));
  }
  try {
    preset.check();
  } catch (const Error& error) {
    value.fail(error.what());
  }
  return preset;
}

void require_near(double value, double expected, double tolerance, const std::string& what) {
  if (std::abs(value - expected) <= tolerance * expected) return;
  throw Error("the calibration is of " + what + " " + format_rounded(value, 4) + " mm, the preset of " +
              format_rounded(expected, 4) + " mm; use the calibration of this setting");
}

}  // namespace

void ImagePreset::check() const {
  const std::string where = "preset '" + printable(name) + "': ";
  if (name.empty()) throw Error("a preset needs a name");
  if (image_size.width <= 0 || image_size.height <= 0) throw Error(where + "the picture's size must be positive");
  if (!(depth_mm > 0.0 && depth_mm < 1000.0)) throw Error(where + "the depth must be above 0 and below 1000 mm");
  if (!(pixel_mm.minCoeff() > 0.0 && pixel_mm.maxCoeff() < 10.0)) {
    throw Error(where + "pixels must be larger than 0 and smaller than 10 mm");
  }
  if (crop && (crop->empty() || (*crop & cv::Rect({0, 0}, image_size)) != *crop)) {
    throw Error(where + "the crop must lie within the picture of " + text_of(image_size));
  }
}

std::vector<ImagePreset> read_image_presets(const std::filesystem::path& path) {
  const nlohmann::json document = JsonValue::read_file(path);
  const JsonValue root(document, path);
  require_version(root, "fathom_image_presets", 1);
  const JsonValue list = root.at("presets");
  std::vector<ImagePreset> presets;
  std::set<std::string> names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    presets.push_back(read_preset(list[i]));
    if (!names.insert(presets.back().name).second) list[i].at("name").fail("is the name of another preset; change one");
  }
  return presets;
}

std::string image_presets_json(const std::vector<ImagePreset>& presets) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ImagePreset& preset : presets) {
    preset.check();
    nlohmann::ordered_json each = {{"name", preset.name},
                                   {"width", preset.image_size.width},
                                   {"height", preset.image_size.height},
                                   {"depth_mm", preset.depth_mm},
                                   {"pixel_mm", {preset.pixel_mm.x(), preset.pixel_mm.y()}}};
    if (preset.crop) each["crop"] = {preset.crop->x, preset.crop->y, preset.crop->width, preset.crop->height};
    list.push_back(each);
  }
  return nlohmann::ordered_json{{"fathom_image_presets", 1}, {"presets", list}}.dump(2) + "\n";
}

cv::Mat cropped(const cv::Mat& image, const ImagePreset& preset) {
  if (image.size() != preset.image_size) {
    throw Error("the picture is " + text_of(image.size()) + ", the preset '" + printable(preset.name) + "' is for " +
                text_of(preset.image_size) + "; choose another preset");
  }
  return preset.crop ? image(*preset.crop) : image;
}

Calibration cropped(const Calibration& calibration, const ImagePreset& preset) {
  if (calibration.image_size && *calibration.image_size != preset.image_size) {
    throw Error("the calibration is for pictures of " + text_of(*calibration.image_size) + ", the preset '" +
                printable(preset.name) + "' for " + text_of(preset.image_size) + "; use one of this size");
  }
  if (calibration.depth_mm) require_near(*calibration.depth_mm, preset.depth_mm, kDepthTolerance, "a depth of");
  const Eigen::Matrix3d& mm_from_px = calibration.probe_from_image.linear();
  require_near(mm_from_px.col(0).norm(), preset.pixel_mm.x(), kPixelTolerance, "a pixel's width of");
  require_near(mm_from_px.col(1).norm(), preset.pixel_mm.y(), kPixelTolerance, "a pixel's height of");
  Calibration part = calibration;
  part.depth_mm = preset.depth_mm;
  part.image_size = preset.image_size;
  if (!preset.crop) return part;
  part.probe_from_image.translate(Eigen::Vector3d(preset.crop->x, preset.crop->y, 0.0));
  part.image_size = preset.crop->size();
  part.parameters.clear();
  part.covariance.resize(0, 0);
  return part;
}

}  // namespace fathom
