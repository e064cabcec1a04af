#include "sim/phantom.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"

namespace fathom {
namespace {

Eigen::Matrix3d random_rotation(Random& random) {
  Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
  return turn.normalized().toRotationMatrix();
}

/// What a straight line sees of a solid.
struct LineSight {
  double length_mm = 0.0;  ///< inside
  int crossings = 0;
};

/// Walks along a line by the distance bound and finds every crossing by bisection.
LineSight look_through(const Solid& solid, const Eigen::Vector3d& start, const Eigen::Vector3d& direction,
                       double length_mm) {
  constexpr double kSmallestStep_mm = 1e-3;  // a line that only grazes the solid may be taken to miss it
  LineSight sight;
  double at = 0.0;
  double value = solid.distance_bound_mm(start);
  double entered = 0.0;
  while (at < length_mm) {
    double next = at + std::max(std::abs(value), kSmallestStep_mm);
    const double next_value = solid.distance_bound_mm(start + next * direction);
    if ((next_value <= 0.0) != (value <= 0.0)) {
      double before = at;
      double after = next;
      while (after - before > 1e-9) {
        const double middle = (before + after) / 2.0;
        const bool same = (solid.distance_bound_mm(start + middle * direction) <= 0.0) == (value <= 0.0);
        (same ? before : after) = middle;
      }
      ++sight.crossings;
      if (value > 0.0) {
        entered = after;
      } else {
        sight.length_mm += after - entered;
      }
    }
    at = next;
    value = next_value;
  }
  return sight;
}

/// A regular grid of parallel lines around the solid.
template <typename Use>
void for_lines(const Solid& solid, const Eigen::Matrix3d& frame, int lines_across, Use use) {
  const double radius = solid.radius_mm() * 1.01;
  const double spacing = 2.0 * radius / lines_across;
  for (int i = 0; i < lines_across; ++i) {
    for (int j = 0; j < lines_across; ++j) {
      const Eigen::Vector3d start =
          frame * Eigen::Vector3d((i + 0.5) * spacing - radius, (j + 0.5) * spacing - radius, -radius);
      use(look_through(solid, start, frame.col(2), 2.0 * radius), spacing * spacing);
    }
  }
}

class EveryPhantom : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Phantoms, EveryPhantom, testing::ValuesIn(object_names()), [](const auto& instance) {
  std::string name = instance.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(EveryPhantom, HasTheStatedVolumeByIndependentIntegration) {
  const Phantom phantom = make_phantom(GetParam());
  Random random(11);
  double volume = 0.0;
  for_lines(*phantom.solid, random_rotation(random), 300,
            [&](const LineSight& sight, double area) { volume += sight.length_mm * area; });
  EXPECT_NEAR(volume / phantom.solid->volume_mm3(), 1.0, 4e-5);  // the grid's own error is up to 3e-5
}

TEST_P(EveryPhantom, HasTheStatedSurfaceAreaByCountingLineCrossings) {
  // Crofton: the area is twice the mean, over directions, of the number of crossings per unit of cross-section.
  const Phantom phantom = make_phantom(GetParam());
  Random random(5);
  constexpr int kDirections = 60;
  double crossings = 0.0;
  for (int i = 0; i < kDirections; ++i) {
    // Directions spread evenly over the sphere, so that few are enough.
    const double z = 1.0 - (2.0 * i + 1.0) / kDirections;
    const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double ring = std::sqrt(1.0 - z * z);
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(
        Eigen::Vector3d::UnitZ(), Eigen::Vector3d(ring * std::cos(angle), ring * std::sin(angle), z));
    const Eigen::AngleAxisd spin(random.uniform(0.0, 1.0), Eigen::Vector3d::UnitZ());
    for_lines(*phantom.solid, (turn * spin).toRotationMatrix(), 50,
              [&](const LineSight& sight, double area) { crossings += sight.crossings * area; });
  }
  EXPECT_NEAR(2.0 * crossings / kDirections / phantom.solid->area_mm2(), 1.0, 0.01);
}

TEST_P(EveryPhantom, LiesBehindItsPlanesOfContactAndTouchesThem) {
  const Phantom phantom = make_phantom(GetParam());
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d direction = random_rotation(random).col(0);
    const Contact contact = phantom.solid->contact(direction);
    EXPECT_NEAR(phantom.solid->distance_bound_mm(contact.point_mm), 0.0, 1e-9);
    const Eigen::Matrix3d frame =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction).toRotationMatrix();
    for (int sample = 0; sample < 2000; ++sample) {
      const double reach = phantom.solid->radius_mm();
      const Eigen::Vector3d beside(random.uniform(-reach, reach), random.uniform(-reach, reach), 0.0);
      ASSERT_GT(phantom.solid->distance_bound_mm(contact.point_mm + 1e-6 * direction + frame * beside), 0.0);
    }
  }
}

TEST_P(EveryPhantom, NeverOverstatesTheDistanceToItsSurface) {
  const Phantom phantom = make_phantom(GetParam());
  Random random(9);
  const double reach = 1.5 * phantom.solid->radius_mm();
  const auto point = [&] {
    return Eigen::Vector3d(random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach));
  };
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d a = point();
    const Eigen::Vector3d b = a + point() * std::pow(random.uniform(), 4);
    const double difference = phantom.solid->distance_bound_mm(a) - phantom.solid->distance_bound_mm(b);
    ASSERT_LE(std::abs(difference), (a - b).norm() + 1e-12);
  }
}

TEST_P(EveryPhantom, FitsItsBall) {
  const Phantom phantom = make_phantom(GetParam());
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d direction = random_rotation(random).col(0);
    ASSERT_GE(phantom.solid->distance_bound_mm(phantom.solid->radius_mm() * direction), -1e-9);
  }
}

TEST(Phantoms, OfTheSourceDocumentJustFitACubeOfTwentyMillimetres) {
  for (const char* name : {"sphere", "ellipsoid", "cone", "cube", "glove", "hat", "box", "concave", "branching"}) {
    const Phantom phantom = make_phantom(name);
    Eigen::Vector3d extent;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
      extent[axis] = phantom.solid->contact(along).point_mm[axis] - phantom.solid->contact(-along).point_mm[axis];
    }
    EXPECT_LE(extent.maxCoeff(), 20.0 + 1e-9) << name;
    EXPECT_GE(extent.maxCoeff(), 19.9) << name;
  }
}

TEST(Phantoms, KidneyIsOfAnAdultsSize) {
  const Phantom kidney = make_phantom("kidney");
  EXPECT_NEAR(kidney.solid->volume_mm3() / 1000.0, 150.0, 5.0);
}

TEST(Phantoms, KidneyGloveAndConcaveAreHollowOnOneSide) {
  // A line between two points of the surface that leaves the solid: it is not convex there.
  for (const char* name : {"kidney", "glove", "concave"}) {
    const Phantom phantom = make_phantom(name);
    const auto top = [&](double x) {
      double inside = -200.0;
      for (double z = -200.0; z < 200.0; z += 0.05) {
        if (phantom.solid->distance_bound_mm({x, 0.0, z}) <= 0.0) inside = z;
      }
      return inside;
    };
    const double half = phantom.solid->contact(Eigen::Vector3d::UnitX()).point_mm.x() * 0.6;
    EXPECT_LT(top(0.0), (top(-half) + top(half)) / 2.0 - 0.2) << name;
  }
}

TEST(Phantoms, UnknownNamesAreRefusedWithTheChoice) {
  try {
    make_phantom("bal\nloon");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "simulate: there is no object \"bal?loon\"; choose one of sphere, ellipsoid, cone, cube, glove, hat, "
                 "box, concave, branching, kidney, bladder, bladder-prostate, ducts, foetus");
  }
}

}  // namespace
}  // namespace fathom
