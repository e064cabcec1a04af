#include "sim/phantom.h"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "sim/choice.h"
#include "sim/scene_constants.h"

namespace fathom {

namespace {

constexpr double kRadian = std::numbers::pi / 180.0;
const Eigen::Vector2d kSmallPixel(0.12, 0.12);   // Treece 2000, section 2.3.2
const Eigen::Vector2d kOrganPixel(0.36, 0.345);  // 119 x 145 mm; real scanners' pixels are not quite square either
const Eigen::Vector2d kScenePixel(0.18, 0.18);   // 115 x 86 mm
const cv::Size kSceneSize(640, 480);
const Eigen::Vector3d kBladder_mm(36.0, 30.0, 24.0);
constexpr double kBladderBendX = 0.27;  // how far its ends along x are bent up, of its half height
constexpr double kBladderBendY = 0.1125;

/// A cupped hand: an ellipsoid bent along both axes and more on one side, convex on the back, concave in the palm.
std::unique_ptr<Solid> make_glove() {
  return make_bent_ellipsoid({10.0, 8.5, 5.0}, {.x2 = 0.06, .x3 = 0.0016, .y2 = 0.03, .y3 = 0.0, .shift_mm = -2.5});
}

/// A jester's hat: a ball and three horns bent apart, so that many sections have several parts.
std::unique_ptr<Solid> make_hat() {
  constexpr double kTilt = 49.0 * kRadian;  // of a horn against the upright
  std::vector<Spike> horns;
  for (const double azimuth : {0.0, 120.0 * kRadian, 240.0 * kRadian}) {
    horns.push_back(
        {.direction = {std::sin(kTilt) * std::cos(azimuth), std::sin(kTilt) * std::sin(azimuth), std::cos(kTilt)},
         .length_mm = 15.29,
         .half_angle_rad = 16.0 * kRadian});
  }
  return make_spiked_ball({0.0, 0.0, -2.49}, 5.05, std::move(horns));
}

/// A bean: bent so far that it is hollow on one side; it reaches from -6 to 8.7 mm before the shift.
std::unique_ptr<Solid> make_bean() {
  return make_bent_ellipsoid({10.0, 9.0, 6.0}, {.x2 = 0.075, .x3 = 0.0, .y2 = 0.0, .y3 = 0.0, .shift_mm = -1.35});
}

/// A vessel that divides, wide where it does: one limb downward, two upward, all in one plane.
std::unique_ptr<Solid> make_branching() {
  constexpr double kTilt = 52.0 * kRadian;  // of the upper limbs against the upright
  std::vector<Limb> limbs = {{.direction = -Eigen::Vector3d::UnitZ(), .length_mm = 8.53, .radius_mm = 3.0}};
  for (const double side : {-1.0, 1.0}) {
    limbs.push_back(
        {.direction = {side * std::sin(kTilt), 0.0, std::cos(kTilt)}, .length_mm = 8.883, .radius_mm = 3.0});
  }
  return make_limbed_ball({0.0, 0.0, 1.531}, 6.0, std::move(limbs));
}

/// An adult's kidney, 114 x 60 x 47 mm, lying along x, its hilum towards +z.
std::unique_ptr<Solid> make_kidney() {
  return make_bent_ellipsoid({57.0, 29.9, 21.0},
                             {.x2 = 0.0056, .x3 = 1.0e-5, .y2 = 0.002, .y3 = 0.0, .shift_mm = -2.0});
}

/// A pelvis: a bladder, and a prostate below it that all but touches it.
std::vector<PlacedSolid> make_pelvis() {
  constexpr double kBladderHalf_mm = 20.0;
  constexpr double kProstateHalf_mm = 15.0;
  constexpr double kWall_mm = 0.4;
  return centred({{make_ellipsoid({33.0, 28.0, kBladderHalf_mm}), {0.0, 0.0, kBladderHalf_mm + kWall_mm}},
                  {make_ellipsoid({23.0, 18.0, kProstateHalf_mm}), {0.0, 0.0, -kProstateHalf_mm}}});
}

Eigen::Vector3d towards(double azimuth_deg, double elevation_deg) {
  const double azimuth = azimuth_deg * kRadian;
  const double elevation = elevation_deg * kRadian;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

/// A vessel that divides into six.
std::unique_ptr<Solid> make_ducts() {
  return make_limbed_ball(Eigen::Vector3d::Zero(), 8.0,
                          {{.direction = towards(180.0, 5.0), .length_mm = 30.0, .radius_mm = 4.0},
                           {.direction = towards(115.0, -25.0), .length_mm = 26.0, .radius_mm = 3.0},
                           {.direction = towards(25.0, 25.0), .length_mm = 30.0, .radius_mm = 3.5},
                           {.direction = towards(-35.0, -15.0), .length_mm = 32.0, .radius_mm = 3.0},
                           {.direction = towards(-110.0, 30.0), .length_mm = 26.0, .radius_mm = 3.0},
                           {.direction = towards(50.0, -50.0), .length_mm = 24.0, .radius_mm = 3.0}});
}

/// Head, trunk, arms and legs.
std::unique_ptr<Solid> make_foetus() {
  return make_limbed_ball(Eigen::Vector3d::Zero(), 19.0,
                          {{.direction = towards(70.0, 25.0), .length_mm = 28.0, .radius_mm = 4.0},
                           {.direction = towards(-70.0, 25.0), .length_mm = 28.0, .radius_mm = 4.0},
                           {.direction = towards(150.0, 20.0), .length_mm = 33.0, .radius_mm = 5.0},
                           {.direction = towards(-150.0, 20.0), .length_mm = 33.0, .radius_mm = 5.0}},
                          {{.direction = towards(0.0, 20.0), .distance_mm = 28.0, .radius_mm = 15.0}});
}

/// A test object: one structure of the object's name.
Phantom plain(std::string name, std::unique_ptr<Solid> made) {
  const std::shared_ptr<const Solid> solid = std::move(made);
  return {name, solid, kSmallPixel, kImageSize, {{name, solid}}, {}};
}

/// The structure of a scene, or one of them.
SceneBody darker(std::shared_ptr<const Solid> solid, double behind_db_per_mm) {
  return {std::move(solid), -scene::kContrast_db, behind_db_per_mm};
}

SceneBody brighter(std::shared_ptr<const Solid> solid, double behind_db_per_mm) {
  return {std::move(solid), scene::kContrast_db, behind_db_per_mm};
}

Phantom kidney_scene() {
  const std::shared_ptr<const Solid> kidney = make_kidney();
  const std::shared_ptr<const Solid> sinus =
      make_bent_ellipsoid({32.0, 12.0, 7.0}, {.x2 = 0.0056, .x3 = 1.0e-5, .y2 = 0.002, .y3 = 0.0, .shift_mm = -2.0});
  const SceneBody echoes{sinus, 0.5 * scene::kContrast_db, 0.0, false};
  return {"kidney", kidney, kOrganPixel, kImageSize, {{"kidney", kidney}}, {darker(kidney, 0.0), echoes}};
}

Phantom bladder_scene() { return make_bladder(kBladder_mm, kScenePixel.x()); }

Phantom pelvis_scene() {
  const std::vector<PlacedSolid> organs = make_pelvis();
  const auto bladder = make_group({organs[0]});
  const auto prostate = make_group({organs[1]});
  return {"bladder-prostate",
          make_group(organs),
          kScenePixel,
          kSceneSize,
          {{"bladder", bladder}, {"prostate", prostate}},
          {darker(bladder, scene::kEnhancement_db_per_mm), brighter(prostate, 0.0)}};
}

Phantom ducts_scene() {
  const auto ducts = make_group(centred({{make_ducts(), Eigen::Vector3d::Zero()}}));
  return {"ducts", ducts, kScenePixel, kSceneSize, {{"ducts", ducts}}, {darker(ducts, scene::kEnhancement_db_per_mm)}};
}

Phantom foetus_scene() {
  const auto foetus = make_group(centred({{make_foetus(), Eigen::Vector3d::Zero()}}));
  return {"foetus", foetus, kScenePixel, kSceneSize, {{"foetus", foetus}}, {brighter(foetus, scene::kBone_db_per_mm)}};
}

struct Entry {
  const char* name;
  std::function<Phantom()> make;
};

const std::array<Entry, 14>& entries() {
  static const std::array<Entry, 14> table = {{
      {"sphere",
       [] {
         return plain("sphere", make_ellipsoid({10.0, 10.0, 10.0}));
       }},
      {"ellipsoid",
       [] {
         return plain("ellipsoid", make_ellipsoid({10.0, 6.5, 8.0}));
       }},
      {"cone", [] { return plain("cone", make_cone(10.0, 20.0)); }},
      {"cube",
       [] {
         return plain("cube", make_box({10.0, 10.0, 10.0}));
       }},
      {"glove", [] { return plain("glove", make_glove()); }},
      {"hat", [] { return plain("hat", make_hat()); }},
      {"box",
       [] {
         return plain("box", make_box({10.0, 8.0, 6.5}));
       }},
      {"concave", [] { return plain("concave", make_bean()); }},
      {"branching", [] { return plain("branching", make_branching()); }},
      {"kidney", kidney_scene},
      {"bladder", bladder_scene},
      {"bladder-prostate", pelvis_scene},
      {"ducts", ducts_scene},
      {"foetus", foetus_scene},
  }};
  return table;
}

}  // namespace

std::vector<std::string> object_names() {
  std::vector<std::string> names;
  for (const Entry& entry : entries()) names.emplace_back(entry.name);
  return names;
}

Phantom make_bladder(const Eigen::Vector3d& semi_axes_mm, double pixel_mm) {
  const double height_mm = semi_axes_mm.z();
  const Bend bend{.x2 = kBladderBendX * height_mm / (semi_axes_mm.x() * semi_axes_mm.x()),
                  .y2 = kBladderBendY * height_mm / (semi_axes_mm.y() * semi_axes_mm.y())};
  const std::shared_ptr<const Solid> bladder =
      make_group(centred({{make_bent_ellipsoid(semi_axes_mm, bend), Eigen::Vector3d::Zero()}}));
  return {"bladder",
          bladder,
          Eigen::Vector2d::Constant(pixel_mm),
          kSceneSize,
          {{"bladder", bladder}},
          {darker(bladder, scene::kEnhancement_db_per_mm)}};
}

Phantom make_phantom(const std::string& name) {
  for (const Entry& entry : entries()) {
    if (name == entry.name) return entry.make();
  }
  refuse_choice("object", name, object_names());
}

}  // namespace fathom
