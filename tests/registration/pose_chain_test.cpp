#include "registration/pose_chain.h"

#include <gtest/gtest.h>

#include "tests/registration/poses.h"

namespace fathom {
namespace {

TEST(TransformName, IsSplitAtTheToThatJoinsTwoNames) {
  using Names = std::pair<std::string, std::string>;
  EXPECT_EQ(split_transform_name("ProbeToTracker"), Names("Probe", "Tracker"));
  EXPECT_EQ(split_transform_name("ToolToTracker"), Names("Tool", "Tracker"));
  EXPECT_EQ(split_transform_name("StylusTipToStylus"), Names("StylusTip", "Stylus"));
  EXPECT_EQ(split_transform_name("MotorToTorso2"), Names("Motor", "Torso2"));
  EXPECT_FALSE(split_transform_name("Tomato"));
  EXPECT_FALSE(split_transform_name(""));
}

TEST(PoseChain, ComposesWhatTheTrackerSawWithTheInverseOfTheReference) {
  Random random(7);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Isometry3d tracker_from_probe = random_pose(random);
    const Eigen::Isometry3d tracker_from_reference = random_pose(random);
    const auto recording =
        recording_of_poses({"ProbeToTracker", "ReferenceToTracker"}, {{tracker_from_probe, tracker_from_reference}});
    const PoseChain chain = find_pose_chain(*recording, {});
    EXPECT_EQ(chain.reference, "Reference");
    const auto pose = reference_from_probe(*recording, chain, 0);
    ASSERT_TRUE(pose);
    EXPECT_TRUE(pose->isApprox(tracker_from_reference.inverse() * tracker_from_probe, 1e-9));
  }
}

TEST(PoseChain, EndsAtTheTrackerWhereThereIsNoReference) {
  const auto recording = recording_of_poses({"ProbeToTracker"}, {{Eigen::Isometry3d::Identity()}});
  EXPECT_EQ(find_pose_chain(*recording, {}).reference, "Tracker");
}

TEST(PoseChain, NeverLeadsThroughTheImage) {
  const auto recording =
      recording_of_poses({"ImageToProbe", "ImageToReference", "ProbeToTracker", "ReferenceToTracker"},
                         {std::vector(4, Eigen::Isometry3d::Identity())});
  const PoseChain chain = find_pose_chain(*recording, {});
  ASSERT_EQ(chain.steps.size(), 2u);
  EXPECT_EQ(chain.steps[0].transform, 2u);
  EXPECT_FALSE(chain.steps[0].inverted);
  EXPECT_EQ(chain.steps[1].transform, 3u);
  EXPECT_TRUE(chain.steps[1].inverted);
}

TEST(PoseChain, IsFoundAmongVeryManyTransformsAndSaidBriefly) {
  // Every search step used to look at every transform: this many took a quarter of an hour.
  std::vector<std::string> names;
  for (int i = 0; i < 50'000; ++i) names.push_back("A" + std::to_string(i) + "ToA" + std::to_string(i + 1));
  const auto recording = recording_of_poses(names, {std::vector(names.size(), Eigen::Isometry3d::Identity())});
  EXPECT_EQ(find_pose_chain(*recording, {.probe = "A0", .reference = "A50000"}).steps.size(), 50'000u);
  try {
    find_pose_chain(*recording, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_LT(std::string(error.what()).size(), 600u);
  }
}

TEST(PoseChain, NeverGuessesWhichToolIsTheProbe) {
  const auto recording = recording_of_poses({"ToolToTracker"}, {{Eigen::Isometry3d::Identity()}});
  try {
    find_pose_chain(*recording, {});
    FAIL() << "a chain was guessed";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("ToolToTracker"), std::string::npos) << error.what();
  }
  EXPECT_EQ(find_pose_chain(*recording, {.probe = "Tool", .reference = {}}).steps.size(), 1u);
  EXPECT_FALSE(default_pose_chain(*recording, {}));
}

TEST(PoseChain, DefaultFollowsWhatTheRecordingDeclares) {
  const auto recording = recording_of_poses({"ToolToTracker"}, {{Eigen::Isometry3d::Identity()}},
                                            {{"DefaultFrameTransformName", "ToolToTrackerTransform"}});
  const auto chain = default_pose_chain(*recording, {});
  ASSERT_TRUE(chain);
  EXPECT_EQ(chain->probe, "Tool");
}

TEST(PoseChain, LostOrMissingPosesGiveNone) {
  auto recording = recording_of_poses({"ProbeToTracker"}, std::vector(3, std::vector{Eigen::Isometry3d::Identity()}));
  recording->edit().frames[1].poses[0]->status = "INVALID";
  recording->edit().frames[2].poses[0].reset();
  const PoseChain chain = find_pose_chain(*recording, {});
  EXPECT_TRUE(reference_from_probe(*recording, chain, 0));
  EXPECT_FALSE(reference_from_probe(*recording, chain, 1));
  EXPECT_FALSE(reference_from_probe(*recording, chain, 2));
}

TEST(PoseChain, RefusesWhatIsNotRigidAndMendsRounding) {
  Random random(3);
  const Eigen::Isometry3d pose = random_pose(random);
  auto recording = recording_of_poses({"ProbeToTracker"}, {{pose}});
  const PoseChain chain = find_pose_chain(*recording, {});

  recording->edit().frames[0].poses[0]->matrix(0, 0) += 2e-4;
  const auto mended = reference_from_probe(*recording, chain, 0);
  ASSERT_TRUE(mended);
  EXPECT_TRUE((mended->linear().transpose() * mended->linear()).isIdentity(1e-14));

  recording->edit().frames[0].poses[0]->matrix(0, 0) += 0.01;
  EXPECT_THROW(reference_from_probe(*recording, chain, 0), Error);

  // The bound is 1e-3 in R^T R - I, as where recordings are read.
  recording->edit().frames[0].poses[0]->matrix.topLeftCorner<3, 3>() = (1.0 + 4e-4) * pose.linear();
  EXPECT_NO_THROW(reference_from_probe(*recording, chain, 0));
  recording->edit().frames[0].poses[0]->matrix.topLeftCorner<3, 3>() = (1.0 + 7e-4) * pose.linear();
  EXPECT_THROW(reference_from_probe(*recording, chain, 0), Error);

  recording->edit().frames[0].poses[0]->matrix = pose.matrix();
  recording->edit().frames[0].poses[0]->matrix.col(2) *= -1.0;  // mirrored
  EXPECT_THROW(reference_from_probe(*recording, chain, 0), Error);
}

}  // namespace
}  // namespace fathom
