#include "registration/landmark_registration.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "tests/registration/poses.h"

namespace fathom {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Eigen::Vector3d normal3(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

Points scattered(std::size_t count, Random& random) {
  Points points;
  for (std::size_t i = 0; i < count; ++i) points.emplace_back(60.0 * normal3(random));
  return points;
}

Points moved(const Points& points, const Eigen::Isometry3d& motion, double noise_mm, Random& random) {
  Points result;
  for (const Eigen::Vector3d& point : points) result.emplace_back(motion * point + noise_mm * normal3(random));
  return result;
}

template <typename Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LandmarkRegistration, IsExactOnExactLandmarks) {
  Random random(1);
  for (std::size_t count = 3; count < 9; ++count) {
    const Points from = scattered(count, random);
    const Eigen::Isometry3d motion = random_pose(random);
    const auto result = register_landmarks(from, moved(from, motion, 0.0, random));
    EXPECT_LT((result.to_from_from.matrix() - motion.matrix()).norm(), 1e-9);
    EXPECT_LT(result.rms_mm, 1e-9);
    EXPECT_GT(result.to_from_from.linear().determinant(), 0.0);
  }
}

// Sum of squares over sigma^2 is chi-squared with 3 n - 6 degrees of freedom.
TEST(LandmarkRegistration, TellsTheErrorOfALandmark) {
  Random random(2);
  double squares = 0.0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const Points from = scattered(5, random);
    const auto result = register_landmarks(from, moved(from, random_pose(random), 0.4, random));
    squares += result.error_mm * result.error_mm / kRuns;
    EXPECT_EQ(result.pairs.size(), 5u);
  }
  EXPECT_NEAR(std::sqrt(squares), 0.4, 0.02);
}

TEST(LandmarkRegistration, RefusesLinesMirrorImagesAndStrangers) {
  Random random(3);
  Points line;
  for (int i = 0; i < 5; ++i) line.emplace_back(10.0 * i, 20.0 * i, 0.3 * random.normal());
  const Points image = moved(line, random_pose(random), 0.0, random);
  EXPECT_NE(refusal([&] { register_landmarks(line, image); }).find("on a line"), std::string::npos);
  EXPECT_NE(refusal([&] { match_landmarks(line, image); }).find("on a line"), std::string::npos);

  const Points from = scattered(6, random);
  Points mirrored = from;
  for (Eigen::Vector3d& point : mirrored) point.y() = -point.y();
  EXPECT_NE(refusal([&] { register_landmarks(from, mirrored); }).find("mirror"), std::string::npos);
  EXPECT_NE(refusal([&] { match_landmarks(from, mirrored); }).find("mirror"), std::string::npos);
  const Points strangers = scattered(6, random);
  EXPECT_NE(refusal([&] { register_landmarks(from, strangers); }).find("do not fit"), std::string::npos);
  EXPECT_NE(refusal([&] { match_landmarks(from, strangers); }).find("no order"), std::string::npos);
  const Points two = scattered(2, random);
  EXPECT_NE(refusal([&] { register_landmarks(two, two); }).find("needs three"), std::string::npos);
}

TEST(LandmarkMatching, FindsTheOrderOfTwelve) {
  Random random(4);
  for (int run = 0; run < 20; ++run) {
    const Points from = scattered(12, random);
    const Eigen::Isometry3d motion = random_pose(random);
    const Points in_order = moved(from, motion, 0.3, random);
    Points shuffled(12);
    for (std::size_t i = 0; i < 12; ++i) shuffled[(7 * i + 5) % 12] = in_order[i];
    const auto result = match_landmarks(from, shuffled);
    ASSERT_EQ(result.pairs.size(), 12u);
    for (const auto& pair : result.pairs) EXPECT_EQ(pair.to, (7 * pair.from + 5) % 12);
    EXPECT_LT((result.to_from_from * from[0] - motion * from[0]).norm(), 2.0);
  }
}

TEST(LandmarkMatching, EitherListMayLackSome) {
  Random random(5);
  for (int run = 0; run < 20; ++run) {
    const Points all = scattered(8, random);
    const Points image = moved(all, random_pose(random), 0.3, random);
    const Points from(all.begin(), all.begin() + 7);                                           // lacks 7
    const Points to = {image[5], image[7], image[1], image[0], image[6], image[3], image[4]};  // lacks 2
    const auto result = match_landmarks(from, to);
    ASSERT_EQ(result.pairs.size(), 6u);
    for (const auto& pair : result.pairs) {
      EXPECT_NE(pair.from, 2u);
      EXPECT_LT((to[pair.to] - image[pair.from]).norm(), 1e-12);
    }
  }
}

TEST(LandmarkMatching, RefusesASymmetricLayout) {
  Random random(6);
  const Points square = {{0, 0, 0}, {50, 0, 0}, {50, 50, 0}, {0, 50, 0}};
  const Points image = moved(square, random_pose(random), 0.2, random);
  EXPECT_NE(refusal([&] { match_landmarks(square, image); }).find("symmetric"), std::string::npos);
  EXPECT_NO_THROW(register_landmarks(square, image));
  // One more landmark beside it tells the corners apart.
  Points broken = square;
  broken.emplace_back(20, 5, 30);
  const auto result = match_landmarks(broken, moved(broken, random_pose(random), 0.2, random));
  for (const auto& pair : result.pairs) EXPECT_EQ(pair.from, pair.to);
}

TEST(LandmarkMatching, EqualDistancesDoNotTakeForever) {
  Points sphere;  // an icosahedron's corners: many orders agree
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-golden, golden}) {
      sphere.emplace_back(0.0, a, b);
      sphere.emplace_back(a, b, 0.0);
      sphere.emplace_back(b, 0.0, a);
    }
  }
  for (Eigen::Vector3d& point : sphere) point *= 2.0;  // all distances within the tolerance of each other
  const std::string message = refusal([&] { match_landmarks(sphere, sphere); });
  EXPECT_TRUE(message.find("too many orders") != std::string::npos || message.find("symmetric") != std::string::npos)
      << message;
}

}  // namespace
}  // namespace fathom
