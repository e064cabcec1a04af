#include "segmentation/frame_list.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

TEST(FrameList, NamesFramesInOrderAndJoinsRuns) {
  EXPECT_EQ(frame_list({3}), "frame 3");
  EXPECT_EQ(frame_list({4, 3}), "frames 3 and 4");
  EXPECT_EQ(frame_list({12, 3, 7, 8, 9, 7}), "frames 3, 7 to 9 and 12");
  EXPECT_EQ(frame_list({0, 1, 2, 3}), "frames 0 to 3");
}

TEST(FrameList, CountsWhatWouldBeTooLong) {
  std::vector<int> odd;
  for (int frame = 1; frame < 41; frame += 2) odd.push_back(frame);
  EXPECT_EQ(frame_list(odd), "frames 1, 3, 5, 7, 9, 11 and 14 more");
}

}  // namespace
}  // namespace fathom
