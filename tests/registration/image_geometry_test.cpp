#include <numbers>

#include <gtest/gtest.h>

#include "acquisition/recording.h"
#include "core/error.h"
#include "core/random.h"
#include "registration/geometry_watch.h"
#include "registration/image_preset.h"
#include "registration/image_shape.h"
#include "tests/real_recordings.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
const cv::Size kSize(400, 300);

// A curved probe of 60 mm radius and 60 degrees at some depth, as wide as it comes in a picture of kSize.
Fan curved(double depth_mm) {
  const double px_per_mm = (kSize.height - 20) / depth_mm;
  Fan fan;
  fan.origin_px = {199.5, 10 - 60 * px_per_mm * std::cos(30 * kRadPerDeg)};
  fan.min_radius_px = 60 * px_per_mm;
  fan.max_radius_px = fan.min_radius_px + 0.9 * depth_mm * px_per_mm;
  fan.min_angle_rad = -30 * kRadPerDeg;
  fan.max_angle_rad = 30 * kRadPerDeg;
  return fan;
}

struct Scene {
  std::optional<Fan> fan;
  cv::Rect box;             ///< where there is no fan
  double contact = 1.0;     ///< of the face, from the left; the rest shows only the nearest 12 pixels
  double shadow_deg = 0.0;  ///< at both sides of a fan, below the face
  bool dark = false;        ///< nothing at all
};

// A scanner's pictures: speckle that is new in every frame, and what is drawn around it.
class Scanner {
 public:
  explicit Scanner(const Scene& scene) : echoes_(cv::Mat::zeros(kSize, CV_8U)) {
    for (int y = 0; y < kSize.height && !scene.dark; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        if (!(scene.fan ? scene.fan->contains(x, y) : scene.box.contains({x, y}))) continue;
        const double below = scene.fan
                                 ? (Eigen::Vector2d(x, y) - scene.fan->origin_px).norm() - scene.fan->min_radius_px
                                 : y - scene.box.y;
        const double angle = scene.fan ? std::atan2(x - scene.fan->origin_px.x(), y - scene.fan->origin_px.y()) : 0.0;
        const bool shadow = scene.fan && std::abs(angle) > scene.fan->max_angle_rad - scene.shadow_deg * kRadPerDeg;
        if ((x <= scene.contact * kSize.width && !shadow) || below <= 12) echoes_.at<std::uint8_t>(y, x) = 1;
      }
    }
  }

  cv::Mat picture(Random& random) const {
    cv::Mat image = cv::Mat::zeros(kSize, CV_8U);
    for (std::size_t i = 0; i < image.total(); ++i) {
      if (echoes_.data[i] != 0) image.data[i] = static_cast<std::uint8_t>(random.uniform(40, 200));
    }
    image(cv::Rect(2, 2, 40, 10)) = 220;
    for (int y = 0; y < kSize.height; y += 28) image(cv::Rect(390, y, 6, 2)) = 160;
    return image;
  }

 private:
  cv::Mat echoes_;  // 1 where there are
};

cv::Mat picture(const Scene& scene, Random& random) { return Scanner(scene).picture(random); }

std::optional<ImageShape> shape_of(const Scene& scene, int frames = 8) {
  Random random(3);
  const Scanner scanner(scene);
  ImageShapeFinder finder;
  for (int i = 0; i < frames; ++i) finder.add(scanner.picture(random));
  return finder.find();
}

void expect_found(const Fan& truth) {
  const auto shape = shape_of({truth, {}});
  ASSERT_TRUE(shape && shape->fan);
  EXPECT_NEAR(shape->fan->min_angle_rad, truth.min_angle_rad, 0.3 * kRadPerDeg);
  EXPECT_NEAR(shape->fan->max_angle_rad, truth.max_angle_rad, 0.3 * kRadPerDeg);
  // What counts is which pixels are used.
  int wrong = 0, inside = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      inside += truth.contains(x, y);
      wrong += truth.contains(x, y) != shape->fan->contains(x, y);
    }
  }
  EXPECT_LT(wrong, 0.02 * inside);
}

TEST(ImageShape, OfACurvedProbeIsFound) {
  for (const double depth_mm : {80, 120, 200}) expect_found(curved(depth_mm));
}

TEST(ImageShape, OfAPhasedProbeIsFound) {
  Fan fan;
  fan.origin_px = {180, 12};
  fan.min_radius_px = 4;
  fan.max_radius_px = 270;
  fan.min_angle_rad = -38 * kRadPerDeg;
  fan.max_angle_rad = 41 * kRadPerDeg;
  expect_found(fan);
}

TEST(ImageShape, OfALinearProbeIsItsRectangle) {
  const cv::Rect box(60, 20, 250, 260);
  const auto shape = shape_of({std::nullopt, box});
  ASSERT_TRUE(shape);
  EXPECT_FALSE(shape->fan);
  EXPECT_EQ(shape->box, box);
}

TEST(ImageShape, OfARealRecordingIsItsRectangle) {
  FATHOM_NEEDS_REAL_RECORDINGS();
  const auto recording = open_recording(real_recordings() / "SpinePhantomFreehand.igs.mha");
  ImageShapeFinder finder;
  for (int i = 0; i < 8; ++i) finder.add(recording->image(i));
  const auto shape = finder.find();
  ASSERT_TRUE(shape);
  EXPECT_FALSE(shape->fan);
  EXPECT_EQ(shape->box, cv::Rect(187, 12, 445, 590));  // as measured on the picture
}

TEST(ImageShape, IsNotMadeUpOfTooLittle) {
  EXPECT_FALSE(shape_of({curved(120), {}}, 2));
  EXPECT_FALSE(shape_of({curved(120), {}, 1.0, 0.0, true}));
}

ImagePreset sample_preset() { return {"Bladder, 12 cm", kSize, 120.0, {0.4, 0.4}, cv::Rect(50, 10, 300, 250)}; }

TEST(ImagePreset, IsReadBackAsWritten) {
  ScratchFolder folder;
  ImagePreset whole = sample_preset();
  whole.name = "whole";
  whole.crop.reset();
  put(folder / "p.json", image_presets_json({sample_preset(), whole}));
  const auto read = read_image_presets(folder / "p.json");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].name, "Bladder, 12 cm");
  EXPECT_EQ(read[0].image_size, kSize);
  EXPECT_EQ(read[0].depth_mm, 120.0);
  EXPECT_EQ(read[0].pixel_mm, Eigen::Vector2d(0.4, 0.4));
  EXPECT_EQ(read[0].crop, cv::Rect(50, 10, 300, 250));
  EXPECT_FALSE(read[1].crop);
}

TEST(ImagePreset, OfADamagedFileIsRefused) {
  ScratchFolder folder;
  const std::string good = image_presets_json({sample_preset()});
  const auto message = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    put(folder / "p.json", text);
    return message_of<Error>([&] { read_image_presets(folder / "p.json"); });
  };
  EXPECT_NE(message("120.0", "-1").find("the depth must be"), std::string::npos);
  EXPECT_NE(message("0.4", "1e999").find("p.json"), std::string::npos);
  EXPECT_NE(message("50,", "150,").find("the crop must lie within"), std::string::npos);
  EXPECT_NE(message("\"width\"", "\"wide\"").find("width"), std::string::npos);
  EXPECT_NE(message("fathom_image_presets", "fathom_presets").find("p.json"), std::string::npos);
}

TEST(ImagePreset, CropsWithoutACopy) {
  const cv::Mat image(kSize, CV_8UC3, cv::Scalar::all(7));
  const cv::Mat part = cropped(image, sample_preset());
  EXPECT_EQ(part.size(), cv::Size(300, 250));
  EXPECT_EQ(part.data, image.ptr(10) + 3 * 50);
  EXPECT_EQ(part.u, image.u);  // it keeps the frame's memory alive
  EXPECT_THROW(cropped(cv::Mat(300, 401, CV_8UC1), sample_preset()), Error);
}

TEST(ImagePreset, CropMovesTheCalibrationWithIt) {
  Calibration whole;
  whole.probe_from_image.linear() =
      0.4 * Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  whole.probe_from_image.translation() = Eigen::Vector3d(5, 6, 7);
  whole.image_size = kSize;
  whole.depth_mm = 120.0;
  const Calibration part = cropped(whole, sample_preset());
  EXPECT_EQ(part.image_size, cv::Size(300, 250));
  const Eigen::Vector3d in_part(12, 34, 0), in_whole(62, 44, 0);
  EXPECT_LT((part.probe_from_image * in_part - whole.probe_from_image * in_whole).norm(), 1e-12);
  const auto refusal = [&](auto change) {
    Calibration other = whole;
    change(other);
    return message_of<Error>([&] { cropped(other, sample_preset()); });
  };
  EXPECT_NE(refusal([](Calibration& c) { c.depth_mm = 150; }).find("depth"), std::string::npos);
  EXPECT_NE(refusal([](Calibration& c) { c.probe_from_image.linear() *= 1.05; }).find("width"), std::string::npos);
  EXPECT_NE(refusal([](Calibration& c) { c.image_size = cv::Size(640, 480); }).find("640x480"), std::string::npos);
}

LiveFrame frame_of(const cv::Mat& image, std::vector<std::pair<std::string, std::string>> fields = {}) {
  LiveFrame frame;
  frame.image = image;
  frame.fields = std::move(fields);
  return frame;
}

// Shows frames of `before` and then of `after`; returns how many of these came before it was noticed.
std::optional<int> noticed_after(const Scene& before, const Scene& after, int frames = 50) {
  Random random(4);
  GeometryWatch watch({.first_frames = 12, .window_frames = 12});
  const Scanner first(before), second(after);
  for (int i = 0; i < 40; ++i) {
    if (watch.add(frame_of(first.picture(random)))) ADD_FAILURE() << "nothing had changed: " << *watch.fault();
  }
  for (int i = 0; i < frames; ++i) {
    if (watch.add(frame_of(second.picture(random)))) return i + 1;
  }
  return std::nullopt;
}

TEST(GeometryWatch, NoticesAnotherDepth) {
  for (const double depth_mm : {100.0, 108.0, 132.0, 150.0}) {
    const auto frames = noticed_after({curved(120), {}}, {curved(depth_mm), {}});
    ASSERT_TRUE(frames) << depth_mm;
    EXPECT_LE(*frames, 36) << depth_mm;  // two whole windows
  }
  const Scene linear = {std::nullopt, cv::Rect(100, 20, 200, 260)};
  EXPECT_TRUE(noticed_after(linear, {std::nullopt, cv::Rect(120, 20, 160, 260)}));
  EXPECT_TRUE(noticed_after(linear, {std::nullopt, cv::Rect(80, 20, 240, 260)}));
}

TEST(GeometryWatch, LetsLiftedAndDarkProbesPass) {
  const Scene scene = {curved(120), {}};
  EXPECT_FALSE(noticed_after(scene, scene));
  EXPECT_FALSE(noticed_after(scene, {curved(120), {}, 0.4}));
  EXPECT_FALSE(noticed_after(scene, {curved(120), {}, 0.0}));
  for (const double shadow_deg : {3.0, 6.0, 12.0}) {
    EXPECT_FALSE(noticed_after(scene, {curved(120), {}, 1.0, shadow_deg})) << shadow_deg;
  }
  EXPECT_FALSE(noticed_after(scene, {curved(120), {}, 1.0, 0.0, true}));
}

TEST(GeometryWatch, NoticesAnotherSizeAtOnceAndForGood) {
  Random random(5);
  GeometryWatch watch;
  const cv::Mat image = picture({curved(120), {}}, random);
  EXPECT_FALSE(watch.add(frame_of(image)));
  ASSERT_TRUE(watch.add(frame_of(image(cv::Rect(0, 0, 200, 300)))));
  EXPECT_EQ(*watch.fault(), "the images changed from 400x300 to 200x300 pixels");
  EXPECT_TRUE(watch.add(frame_of(image)));
}

TEST(GeometryWatch, NoticesADepthThatTheSourceStates) {
  Random random(6);
  GeometryWatch watch;
  const cv::Mat image = picture({curved(120), {}}, random);
  EXPECT_FALSE(watch.add(frame_of(image, {{"ImagingDepthMm", "120"}})));
  EXPECT_FALSE(watch.add(frame_of(image, {{"ImagingDepthMm", "120.0"}})));
  ASSERT_TRUE(watch.add(frame_of(image, {{"ImagingDepthMm", "150"}})));
  EXPECT_NE(watch.fault()->find("from 120 to 150"), std::string::npos);
}

TEST(GeometryWatch, KeepsStillThroughRealRecordings) {
  FATHOM_NEEDS_REAL_RECORDINGS();
  for (const auto& entry : std::filesystem::directory_iterator(real_recordings())) {
    if (entry.path().extension() != ".mha" && entry.path().extension() != ".nrrd") continue;
    const auto recording = open_recording(entry.path());
    if (!recording->header().has_images()) continue;
    GeometryWatchOptions options;
    options.first_frames = 8;
    options.window_frames = 5;
    GeometryWatch watch(options);
    const int frames = std::min(60, recording->header().frame_count());
    for (int i = 0; i < frames; ++i) watch.add(frame_of(recording->image(i)));
    EXPECT_FALSE(watch.fault()) << entry.path().filename() << ": " << *watch.fault();
  }
}

}  // namespace
}  // namespace fathom
