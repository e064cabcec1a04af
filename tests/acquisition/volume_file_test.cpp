#include "acquisition/volume_file.h"

#include <filesystem>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "acquisition/recording.h"
#include "core/error.h"
#include "tests/acquisition/sample_recording.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

std::filesystem::path written(const ScratchFolder& folder, const std::string& name, const std::string& content) {
  put(folder / name, content);
  return folder / name;
}

// Turned about a slanting axis, with other sides along each axis, and away from the origin.
Eigen::Affine3d slanting_geometry() {
  Eigen::Affine3d reference_from_voxel = Eigen::Affine3d::Identity();
  reference_from_voxel.linear() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix() *
      Eigen::Vector3d(0.3, 0.45, 1.1).asDiagonal();
  reference_from_voxel.translation() = Eigen::Vector3d(-31.7, 12.25, 1.0 / 3.0);
  return reference_from_voxel;
}

Volume sample_volume(int type) {
  const int sizes[] = {5, 4, 3};
  Volume volume = {cv::Mat(3, sizes, type), slanting_geometry()};
  cv::RNG random(7);
  random.fill(volume.voxels, cv::RNG::UNIFORM, -120.0, 250.0);
  return volume;
}

void expect_same_voxels(const cv::Mat& a, const cv::Mat& b) {
  ASSERT_EQ(a.type(), b.type());
  ASSERT_EQ(a.size, b.size);
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0.0);
}

using Case = std::tuple<int, std::string, bool>;  // voxel type, extension, compressed

class VolumeRoundTrip : public testing::TestWithParam<Case> {};

TEST_P(VolumeRoundTrip, KeepsVoxelsAndGeometry) {
  const auto& [type, extension, compress] = GetParam();
  const ScratchFolder folder;
  const Volume original = sample_volume(type);
  const auto path = folder / ("v" + extension);
  write_volume(original, path, {.compress = compress});
  EXPECT_TRUE(is_volume_file(path));
  const Volume read = read_volume(path);
  expect_same_voxels(read.voxels, original.voxels);
  const Eigen::Matrix4d difference = read.reference_from_voxel.matrix() - original.reference_from_voxel.matrix();
  EXPECT_LE(difference.cwiseAbs().maxCoeff(), extension == ".nrrd" ? 0.0 : 1e-15);
  // As a recording, it is its slices.
  const auto recording = open_recording(path);
  ASSERT_EQ(recording->header().frame_count(), 5);
  const cv::Mat slice(4, 3, type, const_cast<uchar*>(original.voxels.ptr(4)));
  expect_same_voxels(recording->image(4), slice);
}

INSTANTIATE_TEST_SUITE_P(All, VolumeRoundTrip,
                         testing::Combine(testing::Values(CV_8UC1, CV_8SC1, CV_16UC1, CV_16SC1, CV_32FC1, CV_64FC1),
                                          testing::Values(".mha", ".mhd", ".nrrd"), testing::Bool()));

/// A MetaImage of 2 x 3 x 4 bytes, with these lines.
std::string metaimage(const std::string& lines) {
  return "ObjectType = Image\nNDims = 3\n" + lines +
         "DimSize = 2 3 4\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + std::string(24, '\x05');
}

std::string nrrd(const std::string& lines) {
  return "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 3 4\nencoding: raw\n" + lines + "\n" + std::string(24, '\x05');
}

Eigen::Vector3d place(const ScratchFolder& folder, const std::string& text, double column, double row, double slice) {
  return read_volume(written(folder, "v.mha", text)).reference_from_voxel * Eigen::Vector3d(column, row, slice);
}

TEST(VolumeGeometry, EveryThreeNumbersOfTransformMatrixAreTheDirectionOfOneAxis) {
  const ScratchFolder folder;
  // A quarter turn about z: columns run along y, rows along -x.
  const std::string text =
      metaimage("TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 2 3 5\n");
  EXPECT_EQ(place(folder, text, 1, 0, 0), Eigen::Vector3d(10, 22, 30));
  EXPECT_EQ(place(folder, text, 0, 1, 0), Eigen::Vector3d(7, 20, 30));
  EXPECT_EQ(place(folder, text, 0, 0, 1), Eigen::Vector3d(10, 20, 35));
}

TEST(VolumeGeometry, OtherNamesOfMetaImageFieldsAreRead) {
  const ScratchFolder folder;
  const std::string text = metaimage("Position = 1 2 3\nRotation = 0 1 0 -1 0 0 0 0 1\nElementSize = 2 3 5\n");
  EXPECT_EQ(place(folder, text, 1, 1, 1), Eigen::Vector3d(1 - 3, 2 + 2, 3 + 5));
  EXPECT_EQ(place(folder, metaimage(""), 1, 2, 3), Eigen::Vector3d(1, 2, 3));
}

TEST(VolumeGeometry, NrrdSpacesAreBroughtToLps) {
  const ScratchFolder folder;
  const std::string vectors = "space directions: (0,2,0) (-3,0,0) (0,0,5)\nspace origin: (10,20,30)\n";
  const Eigen::Vector3d stated(10 - 3, 20 + 2, 30 + 5);
  for (const auto& [space, signs] : {std::pair("space: left-posterior-superior\n", Eigen::Vector3d(1, 1, 1)),
                                     std::pair("space: LPS\n", Eigen::Vector3d(1, 1, 1)),
                                     std::pair("space: right-anterior-superior\n", Eigen::Vector3d(-1, -1, 1)),
                                     std::pair("space: RAS\n", Eigen::Vector3d(-1, -1, 1)),
                                     std::pair("space: left-anterior-superior\n", Eigen::Vector3d(1, -1, 1)),
                                     std::pair("space dimension: 3\n", Eigen::Vector3d(1, 1, 1))}) {
    const Eigen::Vector3d expected = signs.cwiseProduct(stated);
    EXPECT_EQ(place(folder, nrrd(space + vectors), 1, 1, 1), expected) << space;
  }
  EXPECT_EQ(place(folder, nrrd("spacings: 2 3 5\n"), 1, 1, 1), Eigen::Vector3d(2, 3, 5));
}

TEST(VolumeGeometry, WhatIsNoGeometryIsRefused) {
  const ScratchFolder folder;
  for (const std::string lines :
       {"ElementSpacing = 1 0 1\n", "ElementSpacing = 1 -1 1\n", "ElementSpacing = 1 nan 1\n", "ElementSpacing = 1 1\n",
        "ElementSpacing = 1e9 1 1\n", "Offset = 0 0 inf\n", "Offset = 0 0 0 0\n", "Offset = 1e300 0 0\n",
        "TransformMatrix = 1 0 0 0 1 0 0 1 0\n", "TransformMatrix = 0 0 0 0 0 0 0 0 0\n",
        "TransformMatrix = 1 0 0 0 1 0 0 0\n", "TransformMatrix = 1e200 0 0 0 1 0 0 0 1\n", "DistanceUnits = um\n"}) {
    EXPECT_TRUE(message_of<Error>([&] { place(folder, metaimage(lines), 0, 0, 0); }).find("v.mha: ") !=
                std::string::npos)
        << lines;
  }
  for (const std::string lines :
       {"space: LPS\nspace directions: (1,0,0) (0,1,0)\n", "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,1,0)\n",
        "space: LPS\nspace directions: (1,0,0) (0,nan,0) (0,0,1)\n",
        "space: LPS\nspace directions: (1,0) (0,1) (1,1)\n", "space: LPS\nspace origin: (0,0)\n",
        "space: LPS\nspace origin: 0 0 0\n", "space: up-and-away\n", "spacings: 1 1 nan\n", "spacings: 1 1 0\n",
        "space units: \"um\" \"um\" \"um\"\nspace dimension: 3\n"}) {
    EXPECT_THROW(place(folder, nrrd(lines), 0, 0, 0), Error) << lines;
  }
}

TEST(VolumeFile, RecordingsAreRefusedWithAReason) {
  const ScratchFolder folder;
  const std::pair<std::string, std::string> cases[] = {
      {metaimage("Seq_Frame0001_Timestamp = 2\n"), "is a recording, with fields of its frames"},
      {metaimage("Kinds = domain domain list\n"), "is a recording, as its last axis is a list of frames"},
      {metaimage("UltrasoundImageOrientation = MF\n"), "is a recording, as it says how its ultrasound images lie"},
      {nrrd("kinds: domain domain time\n"), "is a recording, as its last axis is a list of frames"},
      {nrrd("space dimension: 2\nspace directions: (1,0) (0,1) none\n"),
       "is a recording, as its last axis is a list of frames"},
      {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 2 1\nkinds: vector domain domain\nencoding: raw\n\nabcdef",
       "has 3 channels"},
      {"NRRD0004\ntype: uchar\ndimension: 2\nsizes: 3 2\nencoding: raw\n\nabcdef", "has 2 axes"}};
  for (const auto& [text, reason] : cases) {
    const auto path = written(folder, "v.mha", text);
    EXPECT_FALSE(is_volume_file(path)) << reason;
    const std::string message = message_of<Error>([&] { read_volume(path); });
    EXPECT_NE(message.find("v.mha: " + reason), std::string::npos) << message;
    EXPECT_NO_THROW(open_recording(path)) << reason;
  }
  write_recording(sample_recording({}), folder / "r.mha");
  EXPECT_THROW(read_volume(folder / "r.mha"), Error);
}

TEST(VolumeFile, DamageIsFoundWhereverItIs) {
  const ScratchFolder folder;
  for (const std::string extension : {".mha", ".nrrd"}) {
    for (const bool compress : {false, true}) {
      const auto path = folder / ("v" + extension);
      write_volume(sample_volume(CV_16UC1), path, {.compress = compress});
      const std::string good = content_of(path);
      for (std::size_t length = 0; length < good.size(); length += length + 3 < good.size() ? 3 : 1) {
        const auto cut = written(folder, "cut" + extension, good.substr(0, length));
        EXPECT_THROW(read_volume(cut), Error) << extension << compress << " cut at " << length;
      }
      if (!compress) continue;
      std::string wrong = good;
      wrong[wrong.size() - 7] ^= 0x20;
      EXPECT_THROW(read_volume(written(folder, "wrong" + extension, wrong)), Error);
    }
  }
}

TEST(VolumeFile, MoreVoxelsThanTheLimitAreRefusedBeforeMemoryIsTaken) {
  const ScratchFolder folder;
  const auto path = written(folder, "v.mha",
                            "ObjectType = Image\nNDims = 3\nDimSize = 1024 1024 1025\nElementType = MET_UCHAR\n"
                            "ElementDataFile = LOCAL\n");
  std::filesystem::resize_file(path, (1ull << 30) + (2ull << 20));  // a hole: takes no room on the disk
  const std::string message = message_of<Error>([&] { read_volume(path); });
  EXPECT_NE(message.find("has 1024 x 1024 x 1025 voxels; a volume may have 2^30"), std::string::npos) << message;
}

TEST(VolumeFile, WhatCouldNotBeReadBackIsNotWritten) {
  const ScratchFolder folder;
  const auto refuses = [&](const Volume& volume, const std::string& name = "v.mha") {
    const std::string message = message_of<Error>([&] { write_volume(volume, folder / name); });
    return message.find(name + ": ") != std::string::npos && folder.names().empty();
  };
  const int sizes[] = {2, 2, 2};
  EXPECT_TRUE(refuses({}));
  EXPECT_TRUE(refuses({cv::Mat(2, 2, CV_8U, cv::Scalar(0)), Eigen::Affine3d::Identity()}));
  EXPECT_TRUE(refuses({cv::Mat(3, sizes, CV_8UC3, cv::Scalar(0)), Eigen::Affine3d::Identity()}));
  EXPECT_TRUE(refuses({cv::Mat(3, sizes, CV_32S, cv::Scalar(0)), Eigen::Affine3d::Identity()}));
  const Volume good = sample_volume(CV_8UC1);
  EXPECT_TRUE(refuses(good, "v.png"));
  Volume bad = good;
  bad.reference_from_voxel(1, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses(bad));
  bad = good;
  bad.reference_from_voxel.linear().col(2) = good.reference_from_voxel.linear().col(0);
  EXPECT_TRUE(refuses(bad));
}

TEST(VolumeFile, CanBeCancelled) {
  const ScratchFolder folder;
  const Volume volume = sample_volume(CV_8UC1);
  EXPECT_THROW(write_volume(volume, folder / "v.mhd", {}, [](double done) { return done < 0.5; }), Cancelled);
  EXPECT_TRUE(folder.names().empty());
  write_volume(volume, folder / "v.mha");
  EXPECT_THROW(read_volume(folder / "v.mha", [](double done) { return done < 0.5; }), Cancelled);
}

TEST(VolumeFile, PartOfALargerArrayIsWrittenAlone) {
  const ScratchFolder folder;
  const Volume whole = sample_volume(CV_16SC1);
  const cv::Range part[] = {{1, 4}, {1, 3}, {1, 3}};
  write_volume({whole.voxels(part), whole.reference_from_voxel}, folder / "v.nrrd");
  expect_same_voxels(read_volume(folder / "v.nrrd").voxels, whole.voxels(part).clone());
}

}  // namespace
}  // namespace fathom
