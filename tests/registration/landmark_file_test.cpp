#include "registration/landmark_file.h"

#include <fstream>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

std::vector<Landmark> read(const std::string& text) {
  const ScratchFolder folder;
  const auto path = folder / "landmarks.csv";
  std::ofstream(path, std::ios::binary) << text;
  return read_landmarks(path);
}

TEST(LandmarkFile, ReadsNamesHeadingsAndOtherSeparators) {
  for (const char* text :
       {"name,x,y,z\nA,1,2.5,-3\nB,4,5,6e1\n", "\xEF\xBB\xBFname;x_mm;y_mm;z_mm\r\n\"A\";1;2.5;-3\r\n\r\nB;4;5;60",
        "# points\nA\t1\t2.5\t-3\n  B\t 4\t5\t60\n"}) {
    const auto landmarks = read(text);
    ASSERT_EQ(landmarks.size(), 2u) << text;
    EXPECT_EQ(landmarks[0].name, "A");
    EXPECT_EQ(landmarks[0].position_mm, Eigen::Vector3d(1, 2.5, -3));
    EXPECT_EQ(landmarks[1].name, "B");
    EXPECT_EQ(landmarks[1].position_mm, Eigen::Vector3d(4, 5, 60));
  }
  const auto nameless = read("x,y,z\n1,2,3\n");
  ASSERT_EQ(nameless.size(), 1u);
  EXPECT_TRUE(nameless[0].name.empty());
}

TEST(LandmarkFile, RefusesWhatIsNoListOfLandmarks) {
  for (const std::string text :
       {"", "# nothing\n", "name,x,y,z\n", "1,2\n", "A,1,2,3,4\n", "A,1,2,nan\n", "A,1,2,inf\n", "A,1,2,1e7\n",
        "A,1,2,x\n", "A,1,2,3\nA,4,5,6\n", "A,1,2,3\n4,5,6\n", ",1,2,3\n", "1,2,3\nx,y,z\n", "A,1,2,\n", "\x01,1,2,3\n",
        "12,5;0;0\n", "1;2\t3;4\n"}) {
    EXPECT_THROW(read(text), Error) << text;
  }
  std::string many;
  for (int i = 0; i < 1001; ++i) many += "1,2,3\n";
  EXPECT_THROW(read(many), Error);
  EXPECT_THROW(read(std::string(1'000'001, '#')), Error);
  EXPECT_THROW(read_landmarks("no/such/file.csv"), Error);
}

}  // namespace
}  // namespace fathom
