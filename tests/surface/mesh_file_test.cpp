#include "surface/mesh_file.h"

#include <bit>
#include <cstring>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "surface/mesh_check.h"
#include "surface/mesh_measure.h"
#include "surface/vertex_normals.h"
#include "tests/scratch_folder.h"
#include "tests/surface/shapes.h"

namespace fathom {
namespace {

const char* const kExact[] = {"m.ply", "m.obj", "m.off", "m.wrl"};
const char* const kAll[] = {"m.ply", "m.stl", "m.obj", "m.off", "m.wrl"};

/// Everything non-trivial at once: numbers of many digits, far from the origin, a vertex that no triangle names.
Mesh awkward_mesh() {
  Mesh mesh = shapes::icosphere(37.0, 2);
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex = vertex / 3.0 + Eigen::Vector3d(1e4, -0.1, 1e-7);
  mesh.vertices.insert(mesh.vertices.begin() + 5, Eigen::Vector3d(-0.0, 1e-300, 5e-324));
  for (auto& triangle : mesh.triangles) {
    for (std::int32_t& vertex : triangle) vertex += vertex >= 5 ? 1 : 0;
  }
  return mesh;
}

bool same_bits(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
}

Mesh read_text(const ScratchFolder& folder, const std::string& name, const std::string& text) {
  put(folder / name, text);
  return read_mesh(folder / name);
}

void expect_refused(const ScratchFolder& folder, const std::string& name, const std::string& text,
                    const std::string& what) {
  put(folder / name, text);
  const std::string message = message_of<Error>([&] { read_mesh(folder / name); });
  EXPECT_NE(message.find(what), std::string::npos) << "message: " << message << "\nof: " << text.substr(0, 300);
  EXPECT_TRUE(message.starts_with((folder / name).string())) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

template <typename T>
std::string bytes(std::initializer_list<T> values, bool big_endian) {
  std::string all;
  for (const T value : values) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
    all.append(raw.data(), raw.size());
  }
  return all;
}

TEST(MeshFile, TextAndPlyGiveEveryBitBack) {
  const ScratchFolder folder;
  for (const bool with_normals : {false, true}) {
    Mesh mesh = awkward_mesh();
    if (with_normals) mesh.normals = vertex_normals(mesh);
    for (const char* name : kExact) {
      write_mesh(mesh, folder / name);
      const Mesh read = read_mesh(folder / name);
      EXPECT_TRUE(same_bits(read.vertices, mesh.vertices)) << name;
      EXPECT_TRUE(same_bits(read.normals, mesh.normals)) << name << " with normals: " << with_normals;
      EXPECT_EQ(read.triangles, mesh.triangles) << name;
      EXPECT_TRUE(read.sweep_signs.empty()) << name;
    }
  }
}

TEST(MeshFile, PlyKeepsSweepSigns) {
  const ScratchFolder folder;
  Mesh mesh = shapes::box({0, 0, 0}, {1, 2, 3});
  mesh.sweep_signs.assign(mesh.triangles.size(), 1);
  mesh.sweep_signs[3] = mesh.sweep_signs[7] = -1;
  write_mesh(mesh, folder / "m.ply");
  EXPECT_EQ(read_mesh(folder / "m.ply").sweep_signs, mesh.sweep_signs);
  for (const char* name : kAll) {
    write_mesh(mesh, folder / name);
    EXPECT_EQ(read_mesh(folder / name).sweep_signs.empty(), !keeps_sweep_signs(name)) << name;
  }
}

TEST(MeshFile, StlKeepsTheSurfaceClosedAndItsVolumeToSinglePrecision) {
  const ScratchFolder folder;
  const Mesh mesh = shapes::icosphere(50.0, 4);
  write_mesh(mesh, folder / "m.stl");
  EXPECT_EQ(std::filesystem::file_size(folder / "m.stl"), 84 + 50 * mesh.triangles.size());
  const Mesh read = read_mesh(folder / "m.stl");
  EXPECT_EQ(read.vertices.size(), mesh.vertices.size());
  EXPECT_EQ(read.triangles.size(), mesh.triangles.size());
  EXPECT_TRUE(mesh_topology(read).closed());
  EXPECT_EQ(mesh_topology(read).genus(), 0);
  EXPECT_NEAR(volume_mm3(read) / volume_mm3(mesh), 1.0, 1e-6);
}

TEST(MeshFile, StlOfWhatItHoldsIsWrittenAgainByteForByte) {
  const ScratchFolder folder;
  write_mesh(awkward_mesh(), folder / "1.stl");
  write_mesh(read_mesh(folder / "1.stl"), folder / "2.stl");
  EXPECT_TRUE(content_of(folder / "1.stl") == content_of(folder / "2.stl"));
}

TEST(MeshFile, AnEmptyMeshIsReadBackEmpty) {
  const ScratchFolder folder;
  for (const char* name : kAll) {
    write_mesh(Mesh(), folder / name);
    EXPECT_TRUE(read_mesh(folder / name).vertices.empty()) << name;
    EXPECT_TRUE(read_mesh(folder / name).triangles.empty()) << name;
  }
}

TEST(MeshFile, ExtensionsAreKnownInCapitalsToo) {
  const ScratchFolder folder;
  for (const char* name : {"a.ply", "a.STL", "a.Obj", "a.off", "a.WRL"}) EXPECT_TRUE(is_mesh_file(name)) << name;
  for (const char* name : {"a.mha", "a", "ply", "a.ply.gz", ".ply"}) EXPECT_FALSE(is_mesh_file(name)) << name;
  write_mesh(shapes::tetrahedron(), folder / "M.OFF");
  EXPECT_TRUE(content_of(folder / "M.OFF").starts_with("OFF\n"));
  EXPECT_THROW(write_mesh(shapes::tetrahedron(), folder / "m.mha"), Error);
  EXPECT_THROW(read_mesh(folder / "m.mha"), Error);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"M.OFF"});
}

TEST(MeshFile, SeveralMeshesAppearTogetherOrNotAtAll) {
  const ScratchFolder folder;
  {
    AtomicFile a(folder / "a.ply");
    AtomicFile b(folder / "b.stl");
    write_mesh(shapes::tetrahedron(), a);
    write_mesh(shapes::tetrahedron(), b);
  }
  EXPECT_TRUE(folder.names().empty());
  AtomicFile a(folder / "a.ply");
  AtomicFile b(folder / "b.stl");
  write_mesh(shapes::tetrahedron(), a);
  write_mesh(shapes::tetrahedron(), b);
  AtomicFile::commit_all({&a, &b});
  EXPECT_EQ(read_mesh(folder / "a.ply").triangles, read_mesh(folder / "b.stl").triangles.size() == 4
                                                       ? shapes::tetrahedron().triangles
                                                       : std::vector<Mesh::Triangle>());
}

TEST(MeshFile, CancellingLeavesTheOldFile) {
  const ScratchFolder folder;
  for (const char* name : kAll) {
    write_mesh(shapes::tetrahedron(), folder / name);
    const std::string before = content_of(folder / name);
    EXPECT_THROW(write_mesh(shapes::icosphere(1.0, 3), folder / name, {}, [](double) { return false; }), Cancelled);
    EXPECT_EQ(content_of(folder / name), before);
  }
  EXPECT_EQ(folder.names().size(), std::size(kAll));
}

TEST(MeshFile, WhatIsNoMeshIsNotWritten) {
  const ScratchFolder folder;
  Mesh out_of_range = shapes::tetrahedron();
  out_of_range.triangles[1][2] = 4;
  Mesh not_finite = shapes::tetrahedron();
  not_finite.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  Mesh too_large = shapes::tetrahedron();
  too_large.vertices[0].x() = 1e39;
  for (const char* name : kAll) {
    EXPECT_THROW(write_mesh(out_of_range, folder / name), Error) << name;
    EXPECT_THROW(write_mesh(not_finite, folder / name), Error) << name;
  }
  EXPECT_THROW(write_mesh(too_large, folder / "m.stl"), Error);
  EXPECT_TRUE(folder.names().empty());
}

TEST(MeshFile, EveryFileThatIsCutShortIsRefused) {
  const ScratchFolder folder;
  Mesh mesh = shapes::icosphere(12.3, 1);
  mesh.normals = vertex_normals(mesh);
  for (const char* name : kAll) {
    write_mesh(mesh, folder / name);
    const std::string whole = content_of(folder / name);
    // The last line end may be missing: nothing is lost.
    for (std::size_t length = 0; length + 1 < whole.size(); length += length < 100 ? 1 : 293) {
      expect_refused(folder, name, whole.substr(0, length), "");
    }
    expect_refused(folder, name, whole.substr(0, whole.size() - 2), "");
  }
}

TEST(MeshFile, DamagedBytesGiveAnErrorOrAValidMesh) {
  const ScratchFolder folder;
  Mesh mesh = shapes::icosphere(12.3, 1);
  mesh.normals = vertex_normals(mesh);
  Random random(7);
  for (const char* name : kAll) {
    write_mesh(mesh, folder / name);
    const std::string whole = content_of(folder / name);
    for (int round = 0; round < 60; ++round) {
      std::string damaged = whole;
      for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(random.uniform(0.0, 1.0) * static_cast<double>(whole.size() - 1));
        damaged[at] = static_cast<char>(static_cast<int>(random.uniform(0.0, 256.0)));
      }
      put(folder / name, damaged);
      try {
        require_valid(read_mesh(folder / name), "read");
      } catch (const Error& e) {
        EXPECT_TRUE(std::string(e.what()).starts_with((folder / name).string())) << e.what();
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      }
    }
  }
}

TEST(MeshFile, RubbishIsNamedAsSuch) {
  const ScratchFolder folder;
  for (const char* name : kAll) {
    expect_refused(folder, name, "", "is empty");
    expect_refused(folder, name, "\x89PNG\r\n\x1a\n" + std::string(500, '\0'), "");
    expect_refused(folder, name, "Dear colleague,\nhere is the mesh.\n", "");
    expect_refused(folder, name, std::string(3 << 20, '7'), "");
    EXPECT_NE(message_of<Error>([&] { read_mesh(folder / ("no_" + std::string(name))); }).find("does not exist"),
              std::string::npos);
    std::filesystem::create_directory(folder / ("dir_" + std::string(name)));
    EXPECT_NE(message_of<Error>([&] { read_mesh(folder / ("dir_" + std::string(name))); }).find("is a folder"),
              std::string::npos);
  }
}

// PLY

const std::string kPlyText =
    "ply\nformat ascii 1.0\ncomment a square\nobj_info by hand\nelement camera 1\nproperty float f\n"
    "element vertex 4\nproperty float y\nproperty uchar red\nproperty float x\nproperty list uchar int marks\n"
    "property float z\nelement face 1\nproperty float quality\nproperty list uchar int vertex_index\n"
    "element edge 1\nproperty int a\nproperty int b\nend_header\n"
    "50\n0 255 0 2 7 7 1\n0 255 2 0 1\n1 0 2 0 1\n1 0 0 1 9 1\n0.5 4 0 1 2 3\n0 1\n";

TEST(MeshPly, OtherElementsPropertiesAndListsArePassedOverAndPolygonsBecomeFans) {
  const ScratchFolder folder;
  const Mesh mesh = read_text(folder, "m.ply", kPlyText);
  EXPECT_EQ(mesh.triangles, (std::vector<Mesh::Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.vertices, (std::vector<Eigen::Vector3d>{{0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {0, 1, 1}}));
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_DOUBLE_EQ(area_mm2(mesh), 2.0);
}

TEST(MeshPly, BothByteOrdersAndEveryTypeOfNumberAreRead) {
  const ScratchFolder folder;
  for (const bool big : {false, true}) {
    const std::string header =
        std::string("ply\r\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
        " 1.0\r\nelement vertex 3\r\nproperty float x\r\nproperty short y\r\nproperty double z\r\n"
        "property uchar alpha\r\nelement face 1\r\nproperty list ushort uint vertex_indices\r\n"
        "property int8 sweep_sign\r\nproperty list int32 float64 more\r\nend_header\r\n";
    std::string body;
    for (int v = 0; v < 3; ++v) {
      body += bytes<float>({v == 1 ? 1.5f : 0.0f}, big) +
              bytes<std::int16_t>({static_cast<std::int16_t>(v == 2 ? -300 : 0)}, big) + bytes<double>({0.1}, big) +
              '\x80';
    }
    body += bytes<std::uint16_t>({3}, big) + bytes<std::uint32_t>({2, 0, 1}, big) + '\xff' +
            bytes<std::int32_t>({2}, big) + bytes<double>({1.0, 2.0}, big);
    const Mesh mesh = read_text(folder, "m.ply", header + body);
    EXPECT_EQ(mesh.vertices, (std::vector<Eigen::Vector3d>{{0, 0, 0.1}, {1.5, 0, 0.1}, {0, -300, 0.1}}));
    EXPECT_EQ(mesh.triangles, (std::vector<Mesh::Triangle>{{2, 0, 1}}));
    EXPECT_EQ(mesh.sweep_signs, std::vector<std::int8_t>{-1});
    expect_refused(folder, "m.ply", header + body + "x", "goes on behind the last");
    expect_refused(folder, "m.ply", header + body.substr(0, body.size() - 1), "cut short");
  }
}

TEST(MeshPly, FaultsAreNamed) {
  const ScratchFolder folder;
  const auto with = [](const char* from, const char* to) { return replaced(kPlyText, from, to); };
  expect_refused(folder, "m.ply", with("vertex 4", "vertex 2147483647"), "claims 2147483647 vertices");
  expect_refused(folder, "m.ply", with("vertex 4", "vertex 4294967296"), "as the number of vertex");
  expect_refused(folder, "m.ply", with("vertex 4", "vertex -1"), "as the number of vertex");
  expect_refused(folder, "m.ply", with("face 1", "face 2000000000"), "claims 2000000000 faces");
  expect_refused(folder, "m.ply", with("4 0 1 2 3", "4 0 1 2 4"), "a face names vertex 4");
  expect_refused(folder, "m.ply", with("4 0 1 2 3", "4 0 1 2 -1"), "a face names vertex -1");
  expect_refused(folder, "m.ply", with("4 0 1 2 3", "4 0 1 2 1e300"), "which cannot be");
  expect_refused(folder, "m.ply", with("4 0 1 2 3", "4 0 1 2 1.5"), "in place of a whole number");
  expect_refused(folder, "m.ply", with("4 0 1 2 3", "1e300 0 1 2 3"), "at most 1000000");
  expect_refused(folder, "m.ply", with("4 0 1 2 3", "5 0 1 2 3"), "too few numbers");
  expect_refused(folder, "m.ply", with("4 0 1 2 3", "3 0 1 2 3"), "too many numbers");
  expect_refused(folder, "m.ply", with("4 0 1 2 3", "2 0 1"), "fewer than three corners");
  expect_refused(folder, "m.ply", with("0 255 2 0 1", "nan 255 2 0 1"), "in place of a finite number");
  expect_refused(folder, "m.ply", with("ascii", "binary_middle_endian"), "only ascii");
  expect_refused(folder, "m.ply", with("1.0", "2.0"), "only 1.0");
  expect_refused(folder, "m.ply", with("format ascii 1.0\n", ""), "does not say its format");
  expect_refused(folder, "m.ply", with("float y", "half y"), "which PLY does not have");
  expect_refused(folder, "m.ply", with("float y", "float u"), "no vertices with x, y and z");
  expect_refused(folder, "m.ply", with("vertex_index", "strips"), "no faces with vertex_indices");
  expect_refused(folder, "m.ply", with("uchar int vertex_index", "float int vertex_index"), "no whole number");
  expect_refused(folder, "m.ply", with("element edge 1", "element face 1"), "a second time");
  expect_refused(folder, "m.ply", with("float z", "float x"), "a second time");
  expect_refused(folder, "m.ply", with("end_header\n", ""), "which no PLY header has");
  expect_refused(folder, "m.ply", with("float quality", "char sweep_sign"), "in place of a whole number");
  expect_refused(folder, "m.ply", replaced(with("float quality", "char sweep_sign"), "0.5 4", "2 4"),
                 "must be 1 or -1");
}

// STL

const std::string kStlText =
    "solid two  triangles\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0.1\n"
    "  endloop\n endfacet\n FACET NORMAL nan nan nan\n OUTER LOOP\n VERTEX 1 -0.0 0\n VERTEX 1 1 1e-1\n vertex 0 1 "
    "0.1\n"
    "  endloop\n endfacet\nendsolid two triangles\n";

TEST(MeshStl, TextIsReadAndEqualCornersAreOneVertex) {
  const ScratchFolder folder;
  const Mesh mesh = read_text(folder, "m.stl", kStlText);
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles, (std::vector<Mesh::Triangle>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(mesh.vertices[2].z(), 0.1);
  EXPECT_EQ(read_text(folder, "m.stl", kStlText + kStlText).vertices.size(), 4u);
}

TEST(MeshStl, ABinaryFileMayCallItselfSolid) {
  const ScratchFolder folder;
  write_mesh(shapes::tetrahedron(), folder / "m.stl");
  std::string content = content_of(folder / "m.stl");
  content.replace(0, 6, "solid ");
  EXPECT_EQ(read_text(folder, "m.stl", content).triangles.size(), 4u);
}

TEST(MeshStl, FaultsAreNamed) {
  const ScratchFolder folder;
  write_mesh(shapes::tetrahedron(), folder / "m.stl");
  const std::string binary = content_of(folder / "m.stl");
  expect_refused(folder, "m.stl", binary + "x", "claims 4 triangles");
  std::string huge = binary;
  huge.replace(80, 4, "\xff\xff\xff\xff");
  expect_refused(folder, "m.stl", huge, "claims 4294967295 triangles");
  std::string infinite = binary;
  infinite.replace(84 + 12, 4, std::string("\0\0\x80\x7f", 4));
  expect_refused(folder, "m.stl", infinite, "not finite");
  expect_refused(folder, "m.stl", replaced(kStlText, "vertex 0 1 0.1", "vertex 0 1 inf"),
                 "in place of a finite number");
  expect_refused(folder, "m.stl", replaced(kStlText, "vertex 0 1 0.1", "vertex 0 1"), "in place of a finite number");
  expect_refused(folder, "m.stl", replaced(kStlText, "endloop", "vertex 3 3 3 endloop"), "in place of \"endloop\"");
  expect_refused(folder, "m.stl", replaced(kStlText, "endsolid", "more"), "in place of a facet");
}

// OBJ

const std::string kObjText =
    "# a square\nmtllib a.mtl\no thing\nv 0 0 0 0.5 0.5 0.5\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nvn 0 1 0\n"
    "vn 0 0 1\ng part\nusemtl red\ns off\nf 1/1/1 2/1/1 3/1/1 4/1/3 # four corners\nv 5 5 5\nvn 1 0 0\nf -1//-1 -3//1 "
    "-2//1\n";

TEST(MeshObj, AllFormsOfCornersAreRead) {
  const ScratchFolder folder;
  const Mesh mesh = read_text(folder, "m.obj", kObjText);
  EXPECT_EQ(mesh.triangles, (std::vector<Mesh::Triangle>{{0, 1, 2}, {0, 2, 3}, {4, 2, 3}}));
  EXPECT_EQ(mesh.vertices[4], Eigen::Vector3d(5, 5, 5));
  ASSERT_EQ(mesh.normals.size(), 5u);
  EXPECT_EQ(mesh.normals[3], Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(mesh.normals[4], Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(read_text(folder, "m.obj", "v 0 0 0\nv 1 0 0\r\nv 0 1 0\nf 1 2/7 3").triangles.size(), 1u);
}

TEST(MeshObj, NormalsThatDifferBetweenFacesAreNotThoseOfVertices) {
  const ScratchFolder folder;
  EXPECT_TRUE(read_text(folder, "m.obj", replaced(kObjText, "-3//1", "-3//2")).normals.empty());
  EXPECT_TRUE(read_text(folder, "m.obj", replaced(kObjText, "-1//-1", "-1")).normals.empty());
}

TEST(MeshObj, FaultsAreNamed) {
  const ScratchFolder folder;
  const auto with = [](const char* from, const char* to) { return replaced(kObjText, from, to); };
  expect_refused(folder, "m.obj", with("-3//1", "0//1"), "must count from 1");
  expect_refused(folder, "m.obj", with("-3//1", "-6//1"), "must count from 1");
  expect_refused(folder, "m.obj", with("-3//1", "6"), "a face names vertex 5, counting from 0");
  expect_refused(folder, "m.obj", with("-3//1", "6//1"), "has not come yet");
  expect_refused(folder, "m.obj", with("-3//1", "1//9"), "has not come yet");
  expect_refused(folder, "m.obj", with("-3//1", "4294967297"), "must count from 1");
  expect_refused(folder, "m.obj", with("-3//1 -2//1", "2"), "fewer than three");
  expect_refused(folder, "m.obj", with("v 1 0 0", "v 1 0"), "line 5 has too few numbers");
  expect_refused(folder, "m.obj", with("v 1 0 0", "v 1 0 nan"), "in place of a finite number");
  expect_refused(folder, "m.obj", with("g part", "solid"), "which no OBJ file has");
  expect_refused(folder, "m.obj", "# nothing\n", "has no vertices");
}

// OFF

TEST(MeshOff, CommentsColoursPolygonsAndNormalsAreRead) {
  const ScratchFolder folder;
  const std::string text =
      "# first\nNOFF # kind\n\n4 2 # counts\n0 0 0 0 0 1\n1 0 0 0 0 1 # one\n1 1 0  0 0 1\n\n0 1 0 0 0 1\n4 0 1 2 3 "
      "255 0 0\n2 0 1\n";
  const Mesh mesh = read_text(folder, "m.off", text);
  EXPECT_EQ(mesh.triangles, (std::vector<Mesh::Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.normals, std::vector<Eigen::Vector3d>(4, {0, 0, 1}));
  EXPECT_EQ(
      read_text(folder, "m.off", "COFF 3 1 0\n0 0 0 9 9 9 1\n1 0 0 9 9 9 1\n0 1 0 9 9 9 1\n3 0 1 2").triangles.size(),
      1u);
}

TEST(MeshOff, FaultsAreNamed) {
  const ScratchFolder folder;
  const std::string text = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const auto with = [&](const char* from, const char* to) { return replaced(text, from, to); };
  expect_refused(folder, "m.off", with("3 1 0", "2147483647 1 0"), "claims 2147483647 vertices");
  expect_refused(folder, "m.off", with("3 1 0", "3 2147483647 0"), "claims 2147483647 faces");
  expect_refused(folder, "m.off", with("3 1 0", "99999999999 1 0"), "as the number of vertices");
  expect_refused(folder, "m.off", with("3 1 0", "-3 1 0"), "as the number of vertices");
  expect_refused(folder, "m.off", with("3 1 0", "3"), "as the number of faces");
  expect_refused(folder, "m.off", with("3 1 0", "2 1 0"), "behind the last face");
  expect_refused(folder, "m.off", with("3 1 0", "3 2 0"), "cut short");
  expect_refused(folder, "m.off", with("3 1 0", "3 0 0"), "behind the last face");
  expect_refused(folder, "m.off", with("0 1 2", "0 1 3"), "from 0 to 2");
  expect_refused(folder, "m.off", with("0 1 2", "0 1 -1"), "from 0 to 2");
  expect_refused(folder, "m.off", with("3 0 1 2", "2000000000 0 1 2"), "as a corner of a face");
  expect_refused(folder, "m.off", with("1 0 0", "1 0 inf"), "in place of a finite number");
  expect_refused(folder, "m.off", with("OFF\n", "OFF BINARY\n"), "binary OFF");
  expect_refused(folder, "m.off", with("OFF\n", "STOFF\n"), "only OFF, NOFF");
}

// VRML

const std::string kVrml =
    "#VRML V2.0 utf8\n# two shapes\nWorldInfo { title \"a } in a text\" }\nDEF all Transform { translation 0 0 0 "
    "rotation 0 1 0 0 "
    "children [\n Shape { appearance DEF red Appearance { material Material { diffuseColor 1 0 0 } }\n"
    "  geometry IndexedFaceSet { creaseAngle 0.5 coord DEF points Coordinate { point [0 0 0,1 0 0,1 1 0,0 1 0] }\n"
    "   color Color { color [ 1 0 0 ] } colorIndex [ 0 ] coordIndex [ 0 1 2 3 -1 ] } }\n"
    " Shape { appearance USE red geometry IndexedFaceSet { coord USE points ccw FALSE\n   coordIndex [0,1,2] } } ] }\n";

TEST(MeshVrml, FaceSetsOfSeveralShapesAreOneMesh) {
  const ScratchFolder folder;
  const Mesh mesh = read_text(folder, "m.wrl", kVrml);
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles, (std::vector<Mesh::Triangle>{{0, 1, 2}, {0, 2, 3}, {2, 1, 0}}));
  EXPECT_TRUE(mesh.normals.empty());
}

TEST(MeshVrml, TheColourIsThatOfTheMaterial) {
  const ScratchFolder folder;
  write_mesh(shapes::tetrahedron(), folder / "m.wrl", {.color = {255, 0, 51}});
  const std::string content = content_of(folder / "m.wrl");
  EXPECT_TRUE(content.starts_with("#VRML V2.0 utf8\n"));
  EXPECT_NE(content.find("diffuseColor 1 0 0.2 "), std::string::npos) << content.substr(0, 200);
}

TEST(MeshVrml, WhatWouldNotBeTheMeshAsShownIsRefused) {
  const ScratchFolder folder;
  const auto with = [](const char* from, const char* to) { return replaced(kVrml, from, to); };
  expect_refused(folder, "m.wrl", with("translation 0 0 0", "translation 0 0 1"), "by a Transform");
  expect_refused(folder, "m.wrl", with("rotation 0 1 0 0", "scale 2 2 2"), "by a Transform");
  expect_refused(folder, "m.wrl", with("rotation 0 1 0 0", "rotation 0 1 0 3.1"), "by a Transform");
  expect_refused(folder, "m.wrl", kVrml + "USE all\n", "a second time");
  expect_refused(folder, "m.wrl", kVrml + "Inline { url \"other.wrl\" }\n", "another file");
}

TEST(MeshVrml, FaultsAreNamed) {
  const ScratchFolder folder;
  const auto with = [](const char* from, const char* to) { return replaced(kVrml, from, to); };
  expect_refused(folder, "m.wrl", with("V2.0", "V1.0"), "is not VRML 2.0");
  expect_refused(folder, "m.wrl", with("0 1 2 3 -1", "0 1 2 4 -1"), "only 4");
  expect_refused(folder, "m.wrl", with("0 1 2 3 -1", "0 1 2 -2"), "as an index");
  expect_refused(folder, "m.wrl", with("0 1 2 3 -1", "0 1 2 4294967296"), "as an index");
  expect_refused(folder, "m.wrl", with("0 1 2 3 -1", "0 1 2 ]"), "");
  expect_refused(folder, "m.wrl", with("1 1 0,", "1 1 nan,"), "in place of a finite number");
  expect_refused(folder, "m.wrl", with("1 1 0,", "1 1,"), "not a multiple of three");
  expect_refused(folder, "m.wrl", with("USE points", "USE dots"), "not defined");
  expect_refused(folder, "m.wrl", with("ccw FALSE", "ccw no"), "TRUE or FALSE");
  expect_refused(folder, "m.wrl", with("coordIndex [0,1,2]", ""), "without a coordIndex");
  expect_refused(folder, "m.wrl", kVrml + "}", "what was not opened");
  expect_refused(folder, "m.wrl", "#VRML V2.0 utf8\nShape { geometry Sphere { radius 2 } }\n", "no IndexedFaceSet");
  std::string deep = "#VRML V2.0 utf8\n";
  for (int i = 0; i < 2000; ++i) deep += "Group { children [ ";
  expect_refused(folder, "m.wrl", deep, "deeper than 1000");
}

}  // namespace
}  // namespace fathom
