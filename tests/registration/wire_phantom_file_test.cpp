#include "registration/wire_phantom_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/real_recordings.h"
#include "tests/registration/poses.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

NPattern example_pattern(const std::string& prefix, double z) {
  return {Wire{prefix + "a", {30, 0, z}, {30, 40, z}}, Wire{prefix + "b", {55, 0, z}, {35, 40, z}},
          Wire{prefix + "c", {60, 0, z}, {60, 40, z}}};
}

class WirePhantomFile : public testing::Test {
 protected:
  WirePhantom example() {
    Random random(3);
    return {"two Ns", {example_pattern("1", 20), example_pattern("2", 5)}, random_pose(random)};
  }
  WirePhantom written_and_read(const WirePhantom& phantom) {
    put(folder_ / "phantom.json", wire_phantom_json(phantom));
    return read_wire_phantom(folder_ / "phantom.json");
  }
  std::string complaint(const std::string& text) {
    put(folder_ / "phantom", text);
    return message_of<Error>([&] { read_wire_phantom(folder_ / "phantom"); });
  }
  std::string complaint(const WirePhantom& phantom) { return complaint(wire_phantom_json(phantom)); }

  ScratchFolder folder_;
};

TEST_F(WirePhantomFile, ReadsBackAllThatWasWritten) {
  const WirePhantom phantom = example();
  const WirePhantom read = written_and_read(phantom);
  EXPECT_EQ(read.name, phantom.name);
  ASSERT_EQ(read.patterns.size(), 2u);
  EXPECT_EQ(read.patterns[1][1].name, "2b");
  EXPECT_EQ(read.patterns[1][1].front, phantom.patterns[1][1].front);
  EXPECT_EQ(read.patterns[1][1].back, phantom.patterns[1][1].back);
  ASSERT_TRUE(read.reference_from_phantom);
  EXPECT_TRUE(read.reference_from_phantom->isApprox(*phantom.reference_from_phantom, 1e-12));
}

TEST_F(WirePhantomFile, RealPlusPhantomIsReadAsItsTextSays) {
  const std::filesystem::path data = real_recordings();
  FATHOM_NEEDS_REAL_RECORDINGS();
  const WirePhantom read = read_wire_phantom(data / "PlusDeviceSet_fCal_Sim_SpatialCalibration_2.0.xml");
  ASSERT_EQ(read.patterns.size(), 3u);
  EXPECT_EQ(read.name, "fCAL");
  EXPECT_EQ(read.patterns[2][1].name, "2:L5_i5");
  EXPECT_EQ(read.patterns[2][1].back, Eigen::Vector3d(40, 40, 0));
  ASSERT_TRUE(read.reference_from_phantom);
  EXPECT_EQ(read.reference_from_phantom->translation(), Eigen::Vector3d(15.6642, -25.3628, -40.7799));
  EXPECT_NEAR(read.reference_from_phantom->linear()(1, 0), -0.999834, 1e-4);
}

TEST_F(WirePhantomFile, FaultsAreNamed) {
  EXPECT_NE(complaint("  ").find("empty"), std::string::npos);
  EXPECT_NE(complaint(R"({"fathom_contours": 1})").find("fathom_phantom"), std::string::npos);
  EXPECT_NE(complaint("<Plus><CoordinateDefinitions/></Plus>").find("PhantomDefinition"), std::string::npos);
  EXPECT_NE(complaint("<Plus><PhantomDefinition/></Plus>").find("no N-shaped"), std::string::npos);
  EXPECT_NE(complaint("<Plus><PhantomDefinition><Geometry><Pattern Type='CirsPhantomWires'/></Geometry>"
                      "</PhantomDefinition></Plus>")
                .find("CirsPhantomWires"),
            std::string::npos);
  EXPECT_NE(complaint("<Plus><PhantomDefinition><Geometry><Pattern Type='NWire'><Wire Name='a' EndPointFront='0 0 0' "
                      "EndPointBack='0 40 0'/></Pattern></Geometry></PhantomDefinition></Plus>")
                .find("has 1 wires"),
            std::string::npos);
  EXPECT_EQ(complaint(example()), "");
  WirePhantom none = example();
  none.patterns.clear();
  EXPECT_NE(complaint(none).find("no N-shaped"), std::string::npos);
  WirePhantom metres = example();
  for (NPattern& pattern : metres.patterns) {
    for (Wire& wire : pattern) {
      wire.front *= 1e-3;
      wire.back *= 1e-3;
    }
  }
  EXPECT_NE(complaint(metres).find("millimetres"), std::string::npos);
  WirePhantom order = example();
  std::swap(order.patterns[0][1], order.patterns[0][2]);
  EXPECT_NE(complaint(order).find("not parallel"), std::string::npos);
  WirePhantom crossing = example();
  crossing.patterns[1][1].back.x() = 20;
  EXPECT_NE(complaint(crossing).find("crosses"), std::string::npos);
  WirePhantom straight = example();
  straight.patterns[1][1].back.x() = 55;
  EXPECT_NE(complaint(straight).find("middle wire is parallel"), std::string::npos);
  WirePhantom raised = example();
  raised.patterns[0][1].back.z() += 3;
  EXPECT_NE(complaint(raised).find("one plane"), std::string::npos);
  WirePhantom twice = example();
  twice.patterns[1] = example_pattern("2", 20);
  EXPECT_NE(complaint(twice).find("same line"), std::string::npos);
  WirePhantom named = example();
  named.patterns[1][0].name = "1a";
  EXPECT_NE(complaint(named).find("1a"), std::string::npos);
  WirePhantom mirrored = example();
  mirrored.reference_from_phantom->linear().col(0) *= -1.0;
  EXPECT_NE(complaint(mirrored).find("rigid"), std::string::npos);
}

}  // namespace
}  // namespace fathom
