#include "sim/scene.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "sim/phantom.h"
#include "sim/scene_constants.h"
#include "sim/section.h"
#include "sim/simulate.h"

namespace fathom {
namespace {

/// A plane across the object's middle, turned about the upright, image y downward.
Eigen::Affine3d upright_plane(const Phantom& phantom, double turn_rad, double aside_mm = 0.0) {
  const Eigen::Vector3d right(std::cos(turn_rad), std::sin(turn_rad), 0.0);
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear().col(0) = right * phantom.pixel_mm.x();
  map.linear().col(1) = down * phantom.pixel_mm.y();
  map.linear().col(2) = right.cross(down) * phantom.pixel_mm.mean();
  const Eigen::Vector3d centre_px((phantom.image_size.width - 1) / 2.0, (phantom.image_size.height - 1) / 2.0, 0.0);
  map.translation() = aside_mm * right.cross(down) - map.linear() * centre_px;
  return map;
}

class EveryScene : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Objects, EveryScene,
                         testing::Values("kidney", "bladder", "bladder-prostate", "ducts", "foetus"),
                         [](const auto& instance) {
                           std::string name = instance.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(EveryScene, HidesAFifthOfTheOutlineAndShowsTheRestAtSixDecibels) {
  const Phantom phantom = make_phantom(GetParam());
  constexpr int kSeeds = 5;
  constexpr int kPlanes = 30;
  const double reach = 0.4 * phantom.solid->radius_mm();
  int points = 0;
  int hidden = 0;
  std::vector<double> shown;
  std::vector<Scene> scenes;
  for (int i = 0; i < kPlanes; ++i) {
    // Without shadows and enhancement, whose steps are along the beam.
    std::vector<SceneBody> bodies = phantom.bodies;
    for (SceneBody& body : bodies) body.behind_db_per_mm = 0.0;
    bodies.resize(1);
    if (scenes.size() < kSeeds) scenes.emplace_back(bodies, static_cast<std::uint64_t>(i));
    const Scene& scene = scenes[static_cast<std::size_t>(i % kSeeds)];
    const Eigen::Affine3d map = upright_plane(phantom, 0.7 * i, reach * std::sin(2.3 * i));
    const cv::Mat level = scene.level_db(map, phantom.image_size);
    const double reach_px = 1.6 / phantom.pixel_mm.mean();  // beyond the blur of the resolution
    for (const Polygon& outline : section_outlines(*bodies[0].solid, map)) {
      for (std::size_t k = 0; k < outline.size(); ++k) {
        const Eigen::Vector2d along = outline[(k + 1) % outline.size()] - outline[k];
        const Eigen::Vector2d normal = Eigen::Vector2d(along.y(), -along.x()).normalized();
        const Eigen::Vector2d middle = outline[k] + along / 2.0;
        const auto at = [&](double sign) {
          const Eigen::Vector2d place = middle + sign * reach_px * normal;
          const int row = static_cast<int>(std::lround(place.y()));
          return static_cast<double>(level.at<float>(row, static_cast<int>(std::lround(place.x())))) +
                 0.08 * phantom.pixel_mm.y() * row;
        };
        const double step = std::abs(at(1.0) - at(-1.0));
        const int weight = static_cast<int>(std::lround(along.norm() * 10.0));
        points += weight;
        if (step < 0.5 * scene::kContrast_db) {
          hidden += weight;
        } else {
          shown.push_back(step);
        }
      }
    }
  }
  EXPECT_NEAR(static_cast<double>(hidden) / points, scene::kDropout, 0.06);
  std::nth_element(shown.begin(), shown.begin() + static_cast<std::ptrdiff_t>(shown.size() / 2), shown.end());
  EXPECT_NEAR(shown[shown.size() / 2], scene::kContrast_db, 0.5);
}

TEST_P(EveryScene, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const Phantom phantom = make_phantom(GetParam());
  const Eigen::Affine3d map = upright_plane(phantom, 0.4);
  const cv::Mat image = Scene(phantom.bodies, 3).image(map, phantom.image_size);
  EXPECT_EQ(cv::norm(image, Scene(phantom.bodies, 3).image(map, phantom.image_size), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(image, Scene(phantom.bodies, 4).image(map, phantom.image_size), cv::NORM_INF), 50.0);
}

TEST(Scene, IsBrighterBehindFluidAndDarkerBehindBonesAndInShadows) {
  constexpr std::uint64_t kSeed = 5;
  const auto below = [](const Phantom& phantom, std::vector<SceneBody> bodies) {
    const cv::Mat level = Scene(std::move(bodies), kSeed).level_db(upright_plane(phantom, 0.0), phantom.image_size);
    return level.row(level.rows - 1).clone();
  };
  for (const auto& [name, sign] : {std::pair{"bladder", 1.0}, std::pair{"foetus", -1.0}}) {
    const Phantom phantom = make_phantom(name);
    std::vector<SceneBody> plain = phantom.bodies;
    for (SceneBody& body : plain) body.behind_db_per_mm = 0.0;
    const cv::Mat difference = below(phantom, phantom.bodies) - below(phantom, plain);
    double least = 0.0;
    double most = 0.0;
    cv::minMaxLoc(difference, &least, &most);
    EXPECT_NEAR(difference.at<float>(0, 0), 0.0F, 1e-5F) << name;  // nothing above the corner
    EXPECT_GT(sign > 0.0 ? most : -least, 3.0) << name;
  }
  // Shadows lie above the object; a plane through the middle of one loses all of it.
  const Phantom kidney = make_phantom("kidney");
  const Scene scene(kidney.bodies, kSeed);
  double darkest = 0.0;
  for (double aside = -60.0; aside <= 60.0; aside += 2.0) {
    const cv::Mat level = scene.level_db(upright_plane(kidney, 0.0, aside), kidney.image_size);
    double least = 0.0;
    cv::minMaxLoc(level.row(level.rows - 1), &least);
    darkest = std::min(darkest, least + 0.08 * kidney.pixel_mm.y() * (level.rows - 1));
  }
  EXPECT_NEAR(darkest, scene::kShadow_db, 0.8);
}

TEST(Scene, OfSeveralStructuresOutlinesEachOfThem) {
  SimulateOptions options;
  options.object = "bladder-prostate";
  options.pattern = "linear-y";
  options.frames = 15;
  options.speckle.emplace();
  const SimulatedScan scan = simulate(options);
  ASSERT_EQ(scan.outlines.size(), 2u);
  EXPECT_EQ(scan.outlines[0].name, "bladder");
  EXPECT_EQ(scan.outlines[1].name, "prostate");
  ASSERT_EQ(scan.truth.structures.size(), 2u);
  EXPECT_NEAR(scan.truth.structures[0].volume_ml + scan.truth.structures[1].volume_ml, scan.truth.volume_ml, 1e-9);
  EXPECT_LT(scan.outlines[1].contours.size(), scan.outlines[0].contours.size());  // the smaller one
  EXPECT_EQ(scan.outlines[0].extremities.size(), 2u);  // the sweep goes from end to end of the larger
  EXPECT_TRUE(scan.outlines[1].extremities.empty());
  EXPECT_EQ(scan.recording->image(7).size(), cv::Size(640, 480));
}

}  // namespace
}  // namespace fathom
