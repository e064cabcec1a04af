#include "sim/studies/truth_study.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "sim/phantom.h"

namespace fathom {
namespace {

// Agreement that is asked for; counting errs by a third of it, as a standard deviation, for the thinnest object.
constexpr double kAgreement = 0.0005;
constexpr int kCells = 160;

class TrueVolume : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Objects, TrueVolume, testing::ValuesIn(object_names()), [](const auto& instance) {
  std::string name = instance.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(TrueVolume, IsThatOfItsPointsCountedOneByOne) {
  const Phantom phantom = make_phantom(GetParam());
  EXPECT_NEAR(counted_volume_mm3(*phantom.solid, kCells, 1) / phantom.solid->volume_mm3(), 1.0, kAgreement);
}

TEST(CountedVolume, ErrsAsMuchAsAVolumeThatIsWrong) {
  const auto ball = make_ellipsoid({10.0, 10.0, 10.0});
  const auto larger = make_ellipsoid({10.0, 10.0, 10.01});
  EXPECT_GT(counted_volume_mm3(*larger, kCells, 1) / ball->volume_mm3(), 1.0 + kAgreement);
}

}  // namespace
}  // namespace fathom
