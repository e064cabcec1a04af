#include "exam/live_results.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "core/text_file.h"
#include "exam/results.h"
#include "tests/exam/held_work.h"
#include "tests/exam/scan.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

Polygon blob(double x, double y, double radius, int points) {
  Polygon polygon;
  for (int i = 0; i < points; ++i) {
    const double t = 2.0 * std::numbers::pi * i / points;
    polygon.emplace_back(x + radius * (1.0 + 0.2 * std::cos(3.0 * t)) * std::cos(t), y + radius * std::sin(t));
  }
  return polygon;
}

class Live : public ::testing::Test {
 protected:
  Live() {
    ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);
    write_recording(box_recording(), folder_ / "box.mha");
    write_text_file(folder_ / "probe.json", calibration_json(box_calibration()));
    DocumentOptions options;
    options.calibration = folder_ / "probe.json";
    document_ = std::make_unique<Document>(folder_ / "box.mha", options);
    Structure structure{"organ", "", {}, {}, {}};
    for (int i = 1; i < 10; ++i) {
      structure.contours.push_back({i, blob(90, 50, 10.0 + 3.0 * std::sin(0.3 * i), 40), true, {}, 0});
    }
    document_->add_structure(structure);
  }

  VolumeMeasurement measured() const {
    const Scan& scan = *document_->scan();
    const auto& division = document_->division();
    const MeasureOptions options{.surfaces = false};
    return (division ? measure_structures(document_->structures(), scan, *division, options)
                     : measure_structures(document_->structures(), *scan.recordings[0], scan.locators[0], options))
        .front()
        .measurement;
  }

  void expect_as_measured(LiveResults& live) const {
    const VolumeMeasurement expected = measured();
    const VolumeMeasurement& now = live.volume(0);
    EXPECT_EQ(now.volumes.linear_ml, expected.volumes.linear_ml);
    EXPECT_EQ(now.volumes.cubic_ml, expected.volumes.cubic_ml);
    EXPECT_EQ(now.volumes.cubic_3d_ml, expected.volumes.cubic_3d_ml);
    EXPECT_EQ(now.volumes.quadric_ml, expected.volumes.quadric_ml);
    EXPECT_EQ(now.sections, expected.sections);
    EXPECT_EQ(now.warnings, expected.warnings);
  }

  static ContourSurfaceOptions coarse() {
    ContourSurfaceOptions options;
    options.spacing_mm = 1.0;
    return options;
  }

  ScratchFolder folder_;
  std::unique_ptr<Document> document_;
  Worker worker_;
};

TEST_F(Live, VolumesFollowEveryEditAndEqualThoseMeasuredAnew) {
  LiveResults live(*document_, worker_);
  expect_as_measured(live);
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    const int frame = static_cast<int>(random.uniform(0.0, 11.0));
    const auto& contours = document_->structures()[0].contours;
    const std::size_t c = static_cast<std::size_t>(random.uniform() * static_cast<double>(contours.size()));
    switch (i % 6) {
      case 0:
        document_->replace_contour(0, c, {contours[c].frame, blob(90, 50, random.uniform(5, 20), 30), true, {}, 0});
        break;
      case 1:
        document_->insert_point(0, c, 1, {95.0 + random.uniform(), 50.0});
        break;
      case 2:
        document_->undo();
        break;
      case 3:
        document_->add_contour(0, {frame, blob(150, 50, 5, 12), true, {}, 0});
        break;
      case 4:
        document_->remove_contour(0, c);
        break;
      default:
        if (contours.front().frame > 0) document_->set_extremity(0, 0, 0, Eigen::Vector2d(90, 50));
        break;
    }
    try {
      measured();
    } catch (const Error& error) {
      // An outline that crosses itself has no volume, and says so.
      EXPECT_FALSE(live.volume(0).volumes.linear_ml);
      EXPECT_EQ(live.volume(0).warnings, std::vector<std::string>{error.what()});
      document_->undo();
    }
    expect_as_measured(live);
  }
  document_->split_sweep(0, 5);
  expect_as_measured(live);
  document_->place_planes();
  expect_as_measured(live);
  for (int i = 0; i < 12; ++i) {
    const std::size_t c = static_cast<std::size_t>(i) % document_->structures()[0].contours.size();
    const int frame = document_->structures()[0].contours[c].frame;
    document_->replace_contour(0, c, {frame, blob(90, 50, random.uniform(5, 20), 30), i % 5 > 0, {}, 0});
    if (i % 4 == 0) document_->remove_contour(0, c);
    expect_as_measured(live);
  }
}

TEST_F(Live, SurfacesEqualThoseMadeFromScratch) {
  LiveResults live(*document_, worker_);
  const auto expect_from_scratch = [&] {
    live.request_surfaces();
    worker_.finish();
    ASSERT_TRUE(live.is_current(0));
    ContourSurface anew(document_->scan()->locators[0], coarse());
    const Mesh& mesh = anew.update(document_->structures()[0]);
    EXPECT_EQ(live.surface(0).mesh->vertices, mesh.vertices);
    EXPECT_EQ(live.surface(0).volume_ml, anew.volume_ml());
  };
  live.set_options(coarse());
  expect_from_scratch();
  document_->replace_contour(0, 3, {4, blob(95, 50, 14, 30), true, {}, 0});
  EXPECT_FALSE(live.is_current(0));
  expect_from_scratch();
  document_->undo();
  expect_from_scratch();
  // Fast edits while one is being made.
  for (int i = 0; i < 30; ++i) {
    document_->replace_contour(0, 3, {4, blob(95, 50, 10.0 + 0.1 * i, 30), true, {}, 0});
    live.request_surfaces();
    worker_.poll();
  }
  expect_from_scratch();
}

TEST_F(Live, CancelledSurfacesNeverArriveUntilAskedForAgain) {
  // Whether it still waits or is done and about to be delivered; what is in between is Jobs' own test.
  for (const bool waits : {true, false}) {
    LiveResults live(*document_, worker_);
    live.set_options(coarse());
    HeldWork held;
    if (waits) worker_.start(held.job("before it"));
    live.request_surfaces();
    if (!waits) wait_until_done(worker_);
    live.cancel_surface(0);
    if (waits) held.go.open();
    live.request_surfaces();
    worker_.finish();
    EXPECT_FALSE(live.surface(0).mesh);
    EXPECT_FALSE(live.surface(0).volume_ml);
    EXPECT_TRUE(live.surface(0).cancelled);
    EXPECT_FALSE(live.is_current(0));
    live.retry_surface(0);
    live.request_surfaces();
    worker_.finish();
    ASSERT_TRUE(live.surface(0).mesh);
    EXPECT_FALSE(live.surface(0).cancelled);
    EXPECT_TRUE(live.is_current(0));
  }
}

TEST_F(Live, AfterACancelAnEditBringsTheSurface) {
  LiveResults live(*document_, worker_);
  live.set_options(coarse());
  live.request_surfaces();
  live.cancel_surface(0);
  document_->replace_contour(0, 3, {4, blob(95, 50, 14, 30), true, {}, 0});
  live.request_surfaces();
  worker_.finish();
  ASSERT_TRUE(live.is_current(0));
  ContourSurface anew(document_->scan()->locators[0], coarse());
  EXPECT_EQ(live.surface(0).mesh->vertices, anew.update(document_->structures()[0]).vertices);
}

TEST_F(Live, ASurfaceThatCannotBeMadeLeavesTheLastOneAndSaysWhy) {
  LiveResults live(*document_, worker_);
  live.request_surfaces();
  worker_.finish();
  const auto mesh = live.surface(0).mesh;
  ASSERT_TRUE(mesh);
  document_->replace_contour(0, 3, {4, {{80, 40}, {120, 60}, {120, 40}, {80, 60}}, true, {}, 0});
  live.request_surfaces();
  worker_.finish();
  EXPECT_EQ(live.surface(0).mesh, mesh);
  EXPECT_NE(live.surface(0).fault.find("crosses itself"), std::string::npos);
  EXPECT_FALSE(live.surface(0).volume_ml) << "no number of another state";
  document_->undo();
  live.request_surfaces();
  worker_.finish();
  EXPECT_TRUE(live.surface(0).fault.empty());
}

TEST_F(Live, WithoutACalibrationNothingIsMeasured) {
  Document document(folder_ / "box.mha");
  document.add_structure(box_structure());
  LiveResults live(document, worker_);
  EXPECT_FALSE(live.volume(0).volumes.linear_ml);
  EXPECT_NE(live.volume(0).warnings.at(0).find("calibration"), std::string::npos);
  live.request_surfaces();
  EXPECT_TRUE(worker_.idle());
  document.set_calibration(folder_ / "probe.json");
  EXPECT_NEAR(live.volume(0).volumes.linear_ml.value(), 8.0, 1e-9);
}

}  // namespace
}  // namespace fathom
