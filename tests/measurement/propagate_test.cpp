#include "measurement/propagate.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/random.h"
#include "segmentation/outline_topology.h"

namespace fathom {
namespace {

constexpr int kSize = 160;
constexpr int kLast = 8;  // frames 0 and 8 are drawn

struct Disc {
  double x, y, radius;
};

Polygon circle(const Disc& disc) {
  Polygon polygon;
  for (int i = 0; i < 60; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 60.0;
    polygon.emplace_back(disc.x + disc.radius * std::cos(angle), disc.y + disc.radius * std::sin(angle));
  }
  return polygon;
}

using Scene = std::vector<std::vector<Disc>>;  // discs of every frame

cv::Mat mask_of(const std::vector<Disc>& discs) {
  cv::Mat mask(kSize, kSize, CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      for (const Disc& disc : discs) {
        if (std::hypot(x - disc.x, y - disc.y) <= disc.radius) mask.at<std::uint8_t>(y, x) = 255;
      }
    }
  }
  return mask;
}

cv::Mat mask_of(const Structure& structure, int frame) {
  std::vector<std::vector<cv::Point>> polygons;
  for (const Contour& contour : structure.contours) {
    if (contour.frame != frame) continue;
    polygons.emplace_back();
    for (const auto& point : contour.points_px) {
      polygons.back().emplace_back(static_cast<int>(std::lround(16.0 * point.x())),
                                   static_cast<int>(std::lround(16.0 * point.y())));
    }
  }
  cv::Mat mask(kSize, kSize, CV_8UC1, cv::Scalar(0));
  if (!polygons.empty()) cv::fillPoly(mask, polygons, cv::Scalar(255), cv::LINE_8, 4);
  return mask;
}

double dice(const cv::Mat& a, const cv::Mat& b) {
  return 2.0 * cv::countNonZero(a & b) / (cv::countNonZero(a) + cv::countNonZero(b));
}

/// Noise of the size of the contrast, dark discs.
MemoryRecording recording_of(const Scene& scene, double contrast = 30.0) {
  RecordingHeader header;
  header.width = kSize;
  header.height = kSize;
  header.pixel_type = CV_8UC1;
  header.frames.resize(scene.size());
  std::vector<cv::Mat> images;
  Random random(5);
  for (const auto& discs : scene) {
    const cv::Mat mask = mask_of(discs);
    cv::Mat image(kSize, kSize, CV_8UC1);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const double level = 130.0 - (mask.at<std::uint8_t>(y, x) != 0 ? contrast : 0.0) + 30.0 * random.normal();
        image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(level);
      }
    }
    images.push_back(image);
  }
  return {"scan.mha", header, std::move(images)};
}

/// A disc that swings aside between the drawn frames, which both show it in the middle.
Scene swinging_disc() {
  Scene scene;
  for (int i = 0; i <= kLast; ++i)
    scene.push_back({{80.0 + 14.0 * std::sin(std::numbers::pi * i / kLast), 80.0, 30.0}});
  return scene;
}

Structure drawn(const Scene& scene, const std::vector<int>& frames, const std::string& name = "cyst") {
  Structure structure;
  structure.name = name;
  for (const int frame : frames) {
    const auto& discs = scene[static_cast<std::size_t>(frame)];
    if (discs.empty()) structure.absent.push_back({frame});
    for (const Disc& disc : discs) {
      Contour contour;
      contour.frame = frame;
      contour.points_px = circle(disc);
      structure.contours.push_back(contour);
    }
  }
  return structure;
}

void expect_sound(const Structure& structure, int frames) {
  for (int frame = 0; frame < frames; ++frame) {
    std::vector<const Polygon*> outlines;
    for (const Contour& contour : structure.contours) {
      if (contour.frame == frame) outlines.push_back(&contour.points_px);
    }
    EXPECT_EQ(outline_fault(outlines), std::nullopt) << frame;
  }
}

TEST(Propagate, FollowsThePixelsWhereTheDrawnFramesKnowNothingOfTheMotion) {
  // Between the last two drawn frames the disc hurries ahead of where an even motion would have it.
  const std::vector<double> ahead = {0.0, 0.0, 0.0, 0.0, 0.0, 8.0, 14.0, 15.0, 14.0};
  Scene scene;
  for (const double x : ahead) scene.push_back({{80.0 + x, 80.0, 30.0}});
  const MemoryRecording recording = recording_of(scene);
  const std::vector<Structure> with_hint = {drawn(scene, {0, 4, kLast})};
  const Propagation filled = propagate(recording, with_hint, nullptr, {}, {});
  PropagateOptions blind;
  blind.pixels = false;
  const Propagation interpolated = propagate(recording, with_hint, nullptr, {}, blind);
  ASSERT_EQ(filled.frames.size(), 6u);
  for (const int frame : {5, 6, 7}) {
    const cv::Mat truth = mask_of(scene[static_cast<std::size_t>(frame)]);
    const double with_pixels = dice(truth, mask_of(filled.structures[0], frame));
    EXPECT_GT(with_pixels, dice(truth, mask_of(interpolated.structures[0], frame))) << frame;
  }
  expect_sound(filled.structures[0], kLast + 1);
}

TEST(Propagate, KeepsDrawnContoursToTheLastBitAndMakesEarlierResultsAnew) {
  const Scene scene = swinging_disc();
  const MemoryRecording recording = recording_of(scene);
  Structure input = drawn(scene, {0, kLast});
  Contour earlier;
  earlier.frame = 3;
  earlier.points_px = circle({20.0, 20.0, 10.0});
  earlier.confidence = 0.5;
  input.contours.push_back(earlier);
  const Propagation filled = propagate(recording, {input}, nullptr, {}, {});
  int at_three = 0;
  for (const Contour& contour : filled.structures[0].contours) {
    if (contour.frame == 0 || contour.frame == kLast) {
      EXPECT_EQ(contour.points_px, input.contours[contour.frame == 0 ? 0 : 1].points_px);
      EXPECT_FALSE(contour.confidence);
      continue;
    }
    ASSERT_TRUE(contour.confidence);
    EXPECT_GE(*contour.confidence, 0.0);
    EXPECT_LE(*contour.confidence, 1.0);
    at_three += contour.frame == 3;
    EXPECT_NEAR(contour.points_px.front().y(), 80.0, 40.0);
  }
  EXPECT_EQ(at_three, 1);
}

TEST(Propagate, LetsAStructureSplitAndAppear) {
  Scene scene;
  for (int i = 0; i <= kLast; ++i) {
    const double apart = 3.5 * i;
    scene.push_back({{80.0 - apart, 80.0, 20.0}, {80.0 + apart, 80.0, 20.0}});
  }
  scene[0].pop_back();
  const MemoryRecording recording = recording_of(scene);
  const Propagation split = propagate(recording, {drawn(scene, {0, kLast})}, nullptr, {}, {});
  expect_sound(split.structures[0], kLast + 1);
  EXPECT_EQ(split.frames.front().contours, 1);
  EXPECT_EQ(split.frames.back().contours, 2);

  Scene late;
  for (int i = 0; i <= kLast; ++i) late.push_back(i < 3 ? std::vector<Disc>{} : std::vector<Disc>{{80.0, 80.0, 25.0}});
  const Propagation appears = propagate(recording_of(late), {drawn(late, {0, kLast})}, nullptr, {}, {});
  EXPECT_EQ(appears.frames.front().contours, 0);
  EXPECT_EQ(appears.frames.back().contours, 1);
  EXPECT_GT(dice(mask_of(late[7]), mask_of(appears.structures[0], 7)), 0.9);
}

TEST(Propagate, KeepsStructuresThatTouchFromOverlapping) {
  Scene left;
  Scene right;
  for (int i = 0; i <= kLast; ++i) {
    const double shift = 8.0 * std::sin(std::numbers::pi * i / kLast);
    left.push_back({{52.0 + shift, 80.0, 28.0}});
    right.push_back({{108.0 - shift, 80.0, 28.0}});  // the discs would overlap by up to 16 pixels
  }
  const MemoryRecording recording = recording_of(left);
  const Propagation filled =
      propagate(recording, {drawn(left, {0, 2, 6, kLast}, "left"), drawn(right, {0, kLast}, "right")}, nullptr, {}, {});
  ASSERT_EQ(filled.structures.size(), 2u);
  for (int frame = 1; frame < kLast; ++frame) {
    // Counted on a fine grid between pixels, since filled pictures hold their borders.
    int both = 0;
    const auto inside = [&](const Structure& structure, float x, float y) {
      int crossings = 0;
      for (const Contour& contour : structure.contours) {
        if (contour.frame != frame) continue;
        std::vector<cv::Point2f> points;
        for (const auto& p : contour.points_px)
          points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
        crossings += cv::pointPolygonTest(points, {x, y}, false) > 0.0;
      }
      return crossings % 2 == 1;
    };
    for (float y = 50.3F; y < 110.0F; y += 1.0F) {
      for (float x = 60.3F; x < 100.0F; x += 1.0F) {
        both += inside(filled.structures[0], x, y) && inside(filled.structures[1], x, y);
      }
    }
    EXPECT_EQ(both, 0) << frame;
  }
}

TEST(Propagate, StaysWithThePredictionWhereThePixelsSayNothing) {
  const Scene scene = swinging_disc();
  for (const double grey : {0.0, 255.0}) {
    RecordingHeader header = recording_of(scene).header();
    const std::vector<cv::Mat> images(scene.size(), cv::Mat(kSize, kSize, CV_8UC1, cv::Scalar(grey)));
    const MemoryRecording recording("empty.mha", header, images);
    const Propagation filled = propagate(recording, {drawn(scene, {0, 4, kLast})}, nullptr, {}, {});
    for (const PropagatedFrame& frame : filled.frames) {
      EXPECT_EQ(frame.moved, 0.0);
      EXPECT_TRUE(std::isfinite(frame.confidence));
    }
  }
}

TEST(Propagate, RefusesAGapBetweenSweepsAndSaysWhy) {
  const Scene scene = swinging_disc();
  const MemoryRecording recording = recording_of(scene);
  const std::vector<Sweep> sweeps = {{0, 0, 3}, {0, 4, kLast}};
  try {
    propagate(recording, {drawn(scene, {0, kLast})}, nullptr, sweeps, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("different sweeps"), std::string::npos) << error.what();
  }
  const Propagation partly = propagate(recording, {drawn(scene, {0, 3, 5, kLast})}, nullptr, sweeps, {});
  ASSERT_EQ(partly.refused.size(), 1u);
  EXPECT_NE(partly.refused[0].find("frames 3 to 5"), std::string::npos);
  for (const PropagatedFrame& frame : partly.frames) EXPECT_NE(frame.frame, 4);
}

TEST(Propagate, TakesTrianglesAndEveryOtherFrameAndRefusesWhatLeadsNowhere) {
  const Scene scene = swinging_disc();
  const MemoryRecording recording = recording_of(scene);
  Structure triangle = drawn(scene, {0, kLast});
  for (Contour& contour : triangle.contours) contour.points_px = {{60.0, 60.0}, {100.0, 60.0}, {80.0, 100.0}};
  PropagateOptions options;
  options.every = 2;
  const Propagation filled = propagate(recording, {triangle}, nullptr, {}, options);
  ASSERT_EQ(filled.frames.size(), 3u);
  EXPECT_EQ(filled.frames[0].frame, 2);
  expect_sound(filled.structures[0], kLast + 1);
  EXPECT_THROW(propagate(recording, {drawn(scene, {3})}, nullptr, {}, {}), Error);
  EXPECT_THROW(propagate(recording, {}, nullptr, {}, {}), Error);
  options.structure = "liver";
  EXPECT_THROW(propagate(recording, {triangle}, nullptr, {}, options), Error);
}

}  // namespace
}  // namespace fathom
