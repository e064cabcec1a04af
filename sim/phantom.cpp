#include "sim/phantom.h"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "sim/choice.h"

namespace fathom {

namespace {

constexpr double kRadian = std::numbers::pi / 180.0;
const Eigen::Vector2d kSmallPixel(0.12, 0.12);   // Treece 2000, section 2.3.2
const Eigen::Vector2d kOrganPixel(0.36, 0.345);  // 119 x 145 mm; real scanners' pixels are not quite square either

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

struct Entry {
  const char* name;
  Eigen::Vector2d pixel_mm;
  std::function<std::unique_ptr<Solid>()> make;
};

const std::array<Entry, 10>& entries() {
  static const std::array<Entry, 10> table = {{
      {"sphere", kSmallPixel,
       [] {
         return make_ellipsoid({10.0, 10.0, 10.0});
       }},
      {"ellipsoid", kSmallPixel,
       [] {
         return make_ellipsoid({10.0, 6.5, 8.0});
       }},
      {"cone", kSmallPixel, [] { return make_cone(10.0, 20.0); }},
      {"cube", kSmallPixel,
       [] {
         return make_box({10.0, 10.0, 10.0});
       }},
      {"glove", kSmallPixel, make_glove},
      {"hat", kSmallPixel, make_hat},
      {"box", kSmallPixel,
       [] {
         return make_box({10.0, 8.0, 6.5});
       }},
      {"concave", kSmallPixel, make_bean},
      {"branching", kSmallPixel, make_branching},
      {"kidney", kOrganPixel, make_kidney},
  }};
  return table;
}

}  // namespace

std::vector<std::string> object_names() {
  std::vector<std::string> names;
  for (const Entry& entry : entries()) names.emplace_back(entry.name);
  return names;
}

Phantom make_phantom(const std::string& name) {
  for (const Entry& entry : entries()) {
    if (name == entry.name) return {name, entry.make(), entry.pixel_mm};
  }
  refuse_choice("object", name, object_names());
}

}  // namespace fathom
