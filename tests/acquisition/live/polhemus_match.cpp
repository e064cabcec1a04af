#include "tests/acquisition/live/polhemus_match.h"

#include <gtest/gtest.h>

namespace fathom {

namespace {

// What text and floats round away.
constexpr double kRounding_mm = 1e-2;

bool same(const TrackerSample& sample, const PolhemusReading& sent) {
  const Pose pose = polhemus_pose(sent, 255);
  return (sample.pose.matrix - pose.matrix).cwiseAbs().maxCoeff() < kRounding_mm;
}

}  // namespace

std::size_t missing(const std::vector<TrackerSample>& samples, const std::vector<PolhemusReading>& sent) {
  std::size_t next = 0, skipped = 0;
  bool begun = false;
  for (const TrackerSample& sample : samples) {
    if (!sample.pose.valid()) continue;
    std::size_t at = next;
    while (at < sent.size() && !same(sample, sent[at])) ++at;
    if (at == sent.size()) {
      ADD_FAILURE() << "a pose that was never sent";
      return 0;
    }
    if (begun) skipped += at - next;
    begun = true;
    next = at + 1;
  }
  EXPECT_TRUE(begun) << "no valid sample";
  return skipped;
}

}  // namespace fathom
