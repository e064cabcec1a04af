#include <fstream>
#include <functional>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <sys/stat.h>
#include <zlib.h>

#include "acquisition/recording.h"
#include "core/error.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

const std::string kGoodPose = "1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  return text;
}

TEST(BadRecording, WhatIsNoRecordingIsSaidSo) {
  const TestFolder folder;
  expect_refused(folder / "missing.mha", "does not exist");
  expect_refused(folder.path(), "is a folder");
  expect_refused(folder.write("t.mha", ""), "is empty");
  expect_refused(folder.write("t.mha", std::string("\x7F\x45LF\x02\x01\x00\xFF", 8)), "is not a recording");
  expect_refused(folder.write("t.mha", "{\"fathom_contours\": 1}"), "is not a recording");
  expect_refused(folder.write("t.nrrd", "NRRD0009\n\n"), "versions NRRD0001 to NRRD0005");
  expect_refused(folder.write("t.mha", replaced(tiny_metaimage(2), "= Image", "= Mesh")), "not an image");
  ASSERT_EQ(::mkfifo((folder / "pipe.mha").c_str(), 0600), 0);
  expect_refused(folder / "pipe.mha", "is not a regular file");
}

TEST(BadRecording, MessagesStayOneLineWhateverTheFilesName) {
  const TestFolder folder;
  try {
    open_recording(folder.write("two\nlines.mha", tiny_metaimage(2).substr(0, 100)));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
  }
}

TEST(BadRecording, WrongSizesAreRefusedBeforeMemoryIsTaken) {
  const TestFolder folder;
  for (const char* sizes : {"4 3",
                            "4 3 -2",
                            "-4 3 2",
                            "4 3 2.0",
                            "4 3 two",
                            "4 3 5 2",
                            "4 3 2 1 1",
                            "",
                            "0 3 2",
                            "4 0 2",
                            "4 3 0",
                            "0 0 0",
                            "65536 1 1",
                            "1 65536 1",
                            "65535 65535 1",
                            "4 3 1000001",
                            "4 3 18446744073709551615",
                            "4 3 18446744073709551616",
                            "4 3 1537228672809129302",
                            "0 0 4000000000",
                            "0 0 1000000",
                            "65535 4096 18446744073709551615",
                            "4 3 3"}) {
    expect_refused(folder.write("t.mha", replaced(tiny_metaimage(2), "4 3 2", sizes)), "");
  }
}

TEST(BadRecording, WrongStorageIsRefused) {
  const TestFolder folder;
  const auto with = [&](const std::string& field) { return folder.write("t.mha", tiny_metaimage(2, field + "\n")); };
  expect_refused(with("ElementNumberOfChannels = 2"), "channels");
  expect_refused(with("ElementNumberOfChannels = 0"), "channels");
  expect_refused(with("ElementNumberOfChannels = 99999999999999999999"), "whole number");
  expect_refused(with("BinaryData = False"), "stored as text");
  expect_refused(with("BinaryData = maybe"), "True or False");
  expect_refused(with("BinaryDataByteOrderMSB = 2"), "True or False");
  expect_refused(with("HeaderSize = -1"), "HeaderSize");
  expect_refused(with("DimSize = 4 3 2"), "given twice");
  expect_refused(with("Remark = 1\nRemark = 2"), "given twice");
  expect_refused(with("no separator"), "name = value");
  expect_refused(with(" = nameless"), "no name");
  expect_refused(folder.write("t.mha", replaced(tiny_metaimage(2), "MET_UCHAR", "MET_LONG")), "MET_LONG");
  expect_refused(folder.write("t.mha", replaced(tiny_metaimage(2), "NDims = 3", "NDims = 2")), "NDims");
  expect_refused(folder.write("t.mha", replaced(tiny_metaimage(2), "ElementType = MET_UCHAR\n", "")), "ElementType");
  expect_refused(folder.write("t.mha", replaced(tiny_metaimage(2), "DimSize = 4 3 2\n", "")), "DimSize");
  expect_refused(folder.write("t.mha", replaced(tiny_metaimage(2), "MET_UCHAR", "MET_SHORT")), "1 of its 2 frames");
}

TEST(BadRecording, PixelFilesElsewhereAreNotOpened) {
  const TestFolder folder;
  folder.write("pixels.raw", std::string(24, 'x'));
  const std::string text = replaced(tiny_metaimage(2), "ElementDataFile = LOCAL\n", "ElementDataFile = ");
  const std::string head = text.substr(0, text.size() - 24);
  std::filesystem::create_directory(folder / "sub");
  EXPECT_NO_THROW(open_recording(folder.write("t.mhd", head + "pixels.raw\n")));
  for (const std::string& name :
       {std::string("../pixels.raw"), (folder / "pixels.raw").string(), std::string("sub/../pixels.raw"), std::string(),
        std::string("..\\pixels.raw"), std::string("/etc/passwd")}) {
    expect_refused(folder.write("t.mhd", head + name + "\n"), "a plain name beside this file");
  }
  expect_refused(folder.write("t.mhd", head + "gone.raw\n"), "does not exist");
  expect_refused(folder.write("t.mhd", head + "sub\n"), "is a folder");
  expect_refused(folder.write("t.mhd", head + "LIST\na.raw\nb.raw\n"), "several files");
  expect_refused(folder.write("t.mhd", head + "slice%03d.raw 1 20 1\n"), "several files");
}

TEST(BadRecording, WrongFrameFieldsAreRefused) {
  const TestFolder folder;
  const auto with = [&](const std::string& field) { return folder.write("t.mha", tiny_metaimage(2, field + "\n")); };
  const std::string pose = "Seq_Frame0001_ProbeToTrackerTransform = ";
  EXPECT_NO_THROW(open_recording(with(pose + kGoodPose)));
  for (const std::string& numbers : {std::string(), std::string("1"), kGoodPose + " 1", replaced(kGoodPose, "7", "nan"),
                                     replaced(kGoodPose, "7", "inf"), replaced(kGoodPose, "7", "1e999"),
                                     replaced(kGoodPose, "7", "7,5"), replaced(kGoodPose, "7", "seven")}) {
    expect_refused(with(pose + numbers), "frame 1: ProbeToTrackerTransform");
    expect_refused(with(pose + numbers + "\nSeq_Frame0001_ProbeToTrackerTransformStatus = INVALID"),
                   "16 finite numbers");
  }
  for (const char* numbers : {"1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 2", "1 0 0 5 0 1 0 6 0 0 1 7 1 0 0 1"}) {
    expect_refused(with(pose + numbers), "row 0 0 0 1");
  }
  for (const char* numbers :
       {"1 0 0 5 0 1 0 6 0 0 -1 7 0 0 0 1", "1.001 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1", "1 0.01 0 5 0 1 0 6 0 0 1 7 0 0 0 1",
        "0 0 0 5 0 0 0 6 0 0 0 7 0 0 0 1", "1e200 0 0 5 0 1e200 0 6 0 0 1e200 7 0 0 0 1"}) {
    expect_refused(with(pose + numbers), "not a rotation");
  }
  expect_refused(with(pose + kGoodPose + "\n" + pose + kGoodPose), "given twice");
  expect_refused(with("Seq_Frame0001_Timestamp = 1\nSeq_Frame01_Timestamp = 1"), "given twice");
  expect_refused(with("Seq_Frame0001_ImageStatus = OK\nSeq_Frame0001_ImageStatus = OK"), "given twice");
  expect_refused(with("Seq_Frame0001_Remark = a\nSeq_Frame0001_Remark = b"), "given twice");
  expect_refused(with("Seq_Frame0002_Timestamp = 1"), "only 2 frames");
  expect_refused(with("Seq_Frame99999999999999999999_Timestamp = 1"), "is not a frame's field");
  expect_refused(with("Seq_Frame999999999_Timestamp = 1"), "at most");
  expect_refused(with("Seq_Frame-001_Timestamp = 1"), "is not a frame's field");
  expect_refused(with("Seq_Frame0001Timestamp = 1"), "is not a frame's field");
  expect_refused(with("Seq_Frame0001_ = 1"), "is not a frame's field");
  for (const char* time : {"", "nan", "inf", "noon"})
    expect_refused(with(std::string("Seq_Frame0001_Timestamp = ") + time), "Timestamp");
}

TEST(BadRecording, CutAnywhereIsAnErrorNeverACrash) {
  const TestFolder folder;
  for (const char* name : {"c.mha", "c.nrrd"}) {
    for (const bool compress : {false, true}) {
      write_recording(sample_recording({.frames = 3}), folder / name, {.compress = compress});
      const std::string good = read_bytes(folder / name);
      for (std::size_t length = 0; length < good.size(); length += length < 200 || length + 30 > good.size() ? 1 : 41) {
        folder.write(name, good.substr(0, length));
        expect_refused(folder / name, "");
      }
    }
  }
  const std::string poses =
      "ObjectType = Image\nNDims = 3\nDimSize = 0 0 2\nSeq_Frame0000_Timestamp = 1\n"
      "Seq_Frame0001_Timestamp = 2.5\n";
  for (std::size_t length = 0; length < poses.size(); ++length) {
    expect_refused(folder.write("p.mha", poses.substr(0, length)), "");
  }
}

TEST(BadRecording, CutAndDamagedFilesAreFoundOnOpening) {
  const TestFolder folder;
  for (const char* name : {"c.mha", "c.nrrd"}) {
    for (const bool compress : {false, true}) {
      write_recording(sample_recording(), folder / name, {.compress = compress});
      std::filesystem::resize_file(folder / name, std::filesystem::file_size(folder / name) - 5);
      EXPECT_THROW(open_recording(folder / name), Error) << name << compress;
    }
  }
}

TEST(BadRecording, DamagedCompressedPixelsNameTheLastGoodFrame) {
  const TestFolder folder;
  const MemoryRecording original = sample_recording({.width = 300, .height = 200, .frames = 20});
  write_recording(original, folder / "d.mha", {.compress = true});
  std::string bytes = read_bytes(folder / "d.mha");
  std::fill(bytes.end() - 300'000, bytes.end() - 290'000, '\xFF');
  const auto recording = open_recording(folder.write("d.mha", bytes));
  EXPECT_TRUE(same_pixels(recording->image(3), original.image(3)));
  std::string message;
  int first_bad = 0;
  for (; first_bad < 20 && message.empty(); ++first_bad) {
    try {
      recording->image(first_bad);
    } catch (const Error& e) {
      message = e.what();
    }
  }
  --first_bad;
  EXPECT_GT(first_bad, 5);
  EXPECT_NE(message.find("damaged after frame " + std::to_string(first_bad - 1)), std::string::npos) << message;
  EXPECT_THROW(recording->image(19), Error);
  EXPECT_TRUE(same_pixels(recording->image(4), original.image(4)));
}

TEST(BadRecording, AWrongChecksumIsAnErrorOfTheLastFrame) {
  const TestFolder folder;
  for (const auto& [name, from_end] : {std::pair("c.mha", 1), std::pair("c.nrrd", 5)}) {
    write_recording(sample_recording(), folder / name, {.compress = true});
    std::string bytes = read_bytes(folder / name);
    bytes[bytes.size() - static_cast<std::size_t>(from_end)] ^= 1;
    folder.write(name, bytes);
    expect_refused(folder / name, "checksum");
  }
}

std::uint64_t peak_resident_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6));
  }
  return 0;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

TEST(BadRecording, HeadersThatAskForTooMuchMemoryStayBelowOneGigabyte) {
  const TestFolder folder;
  const std::string head = "ObjectType = Image\nNDims = 3\nDimSize = 0 0 400000\nElementType = MET_UCHAR\n";
  // Many transforms, each in one frame only: one slot for each of them in every frame would be 40 000 million.
  std::string text = head;
  for (int t = 0; t < 100'000; ++t) {
    text += "Seq_Frame" + std::to_string(1000 + 3 * t) + "_T" + std::to_string(t) + "Transform = " + kGoodPose + '\n';
  }
  expect_refused(folder.write("t.mha", text + "ElementDataFile = LOCAL\n"), "memory");
  // Very many short fields.
  text = head;
  while (text.size() < 24'000'000) text += "a=\n";
  expect_refused(folder.write("t.mha", text + "ElementDataFile = LOCAL\n"), "memory");
  if (!kSanitized) {
    EXPECT_LT(peak_resident_kb(), 1'000'000u);
  }
}

TEST(BadRecording, CompressedPixelsCannotClaimMoreThanDeflateCanHold) {
  const TestFolder folder;
  const std::string zeros(1 << 20, '\0');
  std::string packed(10'000, '\0');
  uLongf length = packed.size();
  ASSERT_EQ(::compress2(reinterpret_cast<Bytef*>(packed.data()), &length, reinterpret_cast<const Bytef*>(zeros.data()),
                        zeros.size(), 9),
            Z_OK);
  packed.resize(length);
  const std::string head =
      "ObjectType = Image\nNDims = 3\nElementType = MET_UCHAR\nUltrasoundImageOrientation = MF\n"
      "CompressedData = True\nCompressedDataSize = " +
      std::to_string(length) + "\nDimSize = ";
  EXPECT_NO_THROW(
      open_recording(folder.write("z.mha", head + "1024 1024 1\nElementDataFile = LOCAL\n" + packed))->image(0));
  expect_refused(folder.write("z.mha", head + "1024 1024 1000\nElementDataFile = LOCAL\n" + packed), "not possible");
  expect_refused(folder.write("z.mha", head + "1024 512 1\nElementDataFile = LOCAL\n" + packed),
                 "more than its header");
  expect_refused(folder.write("z.mha", head + "1024 1025 1\nElementDataFile = LOCAL\n" + packed), "from frame 0 on");
}

TEST(BadRecording, WrongNrrdHeadersAreRefused) {
  const TestFolder folder;
  const std::string good = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 2\nencoding: raw\n\nabcd";
  EXPECT_NO_THROW(open_recording(folder.write("n.nrrd", good)));
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"uint8", "block"},
                                                        {"uint8", "uint32"},
                                                        {"uint8", "none"},
                                                        {"type: uint8\n", ""},
                                                        {"dimension: 3\n", ""},
                                                        {"dimension: 3", "dimension: 2"},
                                                        {"dimension: 3", "dimension: x"},
                                                        {"sizes: 2 1 2\n", ""},
                                                        {"sizes: 2 1 2", "sizes: 2 1 -2"},
                                                        {"sizes: 2 1 2", "sizes: 2 1 3"},
                                                        {"sizes: 2 1 2", "sizes: 18446744073709551615 2 2"},
                                                        {"raw", "ascii"},
                                                        {"raw", "bzip2"},
                                                        {"raw", "hex"},
                                                        {"raw", "gzip"},
                                                        {"encoding: raw\n", ""},
                                                        {"raw\n", "raw\nbyte skip: -1\n"},
                                                        {"raw\n", "raw\nline skip: 1\n"},
                                                        {"raw\n", "raw\nkinds: domain list\n"},
                                                        {"raw\n", "raw\nkinds: vector domain domain\n"},
                                                        {"raw\n", "raw\ndata file: LIST\n"},
                                                        {"raw\n", "raw\ndata file: ../x.raw\n"},
                                                        {"raw\n", "raw\nno separator\n"},
                                                        {"raw\n", "raw\n: nameless\n"},
                                                        {"raw\n", "raw\nencoding: gz\n"},
                                                        {"raw\n", "raw\nSeq_Frame0002_Timestamp:=1\n"}}) {
    expect_refused(folder.write("n.nrrd", replaced(good, from, to)), "");
  }
}

}  // namespace
}  // namespace fathom
