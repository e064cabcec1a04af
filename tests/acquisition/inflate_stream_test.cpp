#include "acquisition/inflate_stream.h"

#include <algorithm>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <zlib.h>

#include "acquisition/file_recording.h"
#include "core/error.h"
#include "core/random.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

constexpr std::size_t kBytes = 3'000'000;
constexpr InflateOptions kCloseTogether = {.restart_spacing_bytes = 100'000};

/// Bytes that compress about 3 : 1 and refer back, so that a wrong window would show.
std::string sample_bytes() {
  Random random(7);
  std::string bytes;
  while (bytes.size() < kBytes) {
    const auto length = static_cast<std::size_t>(random.uniform(4, 200));
    if (bytes.size() > 40'000 && random.uniform() < 0.7) {
      bytes += bytes.substr(bytes.size() - static_cast<std::size_t>(random.uniform(300, 32'000)), length);
    } else {
      for (std::size_t i = 0; i < length; ++i) bytes += static_cast<char>(random.uniform(0, 256));
    }
  }
  bytes.resize(kBytes);
  return bytes;
}

std::string deflated(const std::string& bytes, int header) {
  z_stream stream = {};
  deflateInit2(&stream, 6, Z_DEFLATED, header, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

class InflateStreamOf : public testing::TestWithParam<int> {
 protected:
  TestFolder folder_;
  std::string bytes_ = sample_bytes();
  std::string deflated_ = deflated(bytes_, GetParam());
  InputFile file_{folder_.write("stream", "head" + deflated_ + "tail")};

  void expect_bytes(InflateStream& stream, std::size_t position, std::size_t count) {
    std::string out(count, '\0');
    ASSERT_EQ(stream.read(position, std::as_writable_bytes(std::span(out))), InflateStream::Fault::none);
    ASSERT_TRUE(out == bytes_.substr(position, count)) << position << " " << count;
  }
};

TEST_P(InflateStreamOf, ReadingOnNeverInflatesAnythingTwice) {
  InflateStream stream(file_, 4, deflated_.size(), kBytes, kCloseTogether);
  for (std::size_t at = 0; at < kBytes; at += 7000) expect_bytes(stream, at, std::min<std::size_t>(7000, kBytes - at));
  EXPECT_EQ(stream.work_bytes(), kBytes);
  EXPECT_GE(stream.restart_points(), 15u);
  EXPECT_LE(stream.restart_points(), 30u);
}

TEST_P(InflateStreamOf, AnyPlaceIsReachedInAnyOrder) {
  InflateStream stream(file_, 4, deflated_.size(), kBytes, kCloseTogether);
  Random random(11);
  for (int i = 0; i < 300; ++i) {
    const auto count = static_cast<std::size_t>(random.uniform(1, 20'000));
    expect_bytes(stream, static_cast<std::size_t>(random.uniform(0, static_cast<double>(kBytes - count))), count);
  }
  expect_bytes(stream, 0, kBytes);
}

TEST_P(InflateStreamOf, APlaceBehindIsReachedFromTheNearestPoint) {
  InflateStream stream(file_, 4, deflated_.size(), kBytes, kCloseTogether);
  expect_bytes(stream, kBytes - 1, 1);
  for (std::size_t at = kBytes - 100'000; at > 100'000; at -= 130'000) {
    const std::uint64_t before = stream.work_bytes();
    expect_bytes(stream, at, 1000);
    // A block of this stream inflates to less than 100 kB, and a point is at a block's end.
    EXPECT_LE(stream.work_bytes() - before, 201'000u);
  }
}

TEST_P(InflateStreamOf, ACutStreamEndsEarlyAndIsGoodBefore) {
  InflateStream stream(file_, 4, deflated_.size() / 2, kBytes, kCloseTogether);
  std::string out(kBytes, '\0');
  EXPECT_EQ(stream.read(0, std::as_writable_bytes(std::span(out))), InflateStream::Fault::ends_early);
  const auto good = static_cast<std::size_t>(stream.good_bytes());
  EXPECT_GT(good, kBytes / 3);
  EXPECT_TRUE(out.substr(0, good) == bytes_.substr(0, good));
  expect_bytes(stream, 5000, good - 5000);
  EXPECT_EQ(stream.read(kBytes - 10, std::as_writable_bytes(std::span(out).first(10))),
            InflateStream::Fault::ends_early);
}

TEST_P(InflateStreamOf, AChangedByteIsFoundAtTheLatestWithTheLastByte) {
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    std::string damaged = deflated_;
    const auto at = static_cast<std::size_t>(random.uniform(20, static_cast<double>(damaged.size())));
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const InputFile file(folder_.write("damaged", damaged));
    InflateStream stream(file, 0, damaged.size(), kBytes, kCloseTogether);
    std::string out(1000, '\0');
    EXPECT_NE(stream.read(kBytes - 1000, std::as_writable_bytes(std::span(out))), InflateStream::Fault::none) << at;
    // Asking again does not make it good.
    EXPECT_NE(stream.read(kBytes - 1000, std::as_writable_bytes(std::span(out))), InflateStream::Fault::none) << at;
  }
}

TEST_P(InflateStreamOf, MoreBytesThanExpectedAreAFault) {
  InflateStream stream(file_, 4, deflated_.size(), kBytes - 1000, kCloseTogether);
  std::string out(1000, '\0');
  EXPECT_EQ(stream.read(1000, std::as_writable_bytes(std::span(out))), InflateStream::Fault::none);
  EXPECT_EQ(stream.read(kBytes - 2000, std::as_writable_bytes(std::span(out))), InflateStream::Fault::too_long);
}

TEST_P(InflateStreamOf, AVeryLongStreamKeepsABoundedNumberOfPoints) {
  const std::string zeros(60'000'000, '\0');
  const std::string stream_bytes = deflated(zeros, GetParam());
  const InputFile file(folder_.write("zeros", stream_bytes));
  InflateStream stream(file, 0, stream_bytes.size(), zeros.size(), {.restart_spacing_bytes = 1024});
  std::string out(10, 'x');
  EXPECT_EQ(stream.read(zeros.size() - 10, std::as_writable_bytes(std::span(out))), InflateStream::Fault::none);
  EXPECT_EQ(stream.read(1'000'000, std::as_writable_bytes(std::span(out))), InflateStream::Fault::none);
  EXPECT_EQ(out, std::string(10, '\0'));
  EXPECT_LE(stream.restart_points(), 2048u);
}

INSTANTIATE_TEST_SUITE_P(Headers, InflateStreamOf, testing::Values(15, 31),
                         [](const auto& test) { return test.param == 15 ? "Zlib" : "Gzip"; });

TEST(InflateOptions, RefusesPointsThatTakeMoreThanTheySave) {
  EXPECT_THROW(InflateOptions{.restart_spacing_bytes = 100}.check(), Error);
}

TEST(CompressedRecording, RandomAccessEqualsTheOriginalInEveryFormat) {
  const TestFolder folder;
  const MemoryRecording original =
      sample_recording({.width = 200, .height = 150, .frames = 40, .pixel_type = CV_16UC1});
  for (const char* name : {"r.mha", "r.mhd", "r.nrrd"}) {
    write_recording(original, folder / name, {.compress = true});
    const FileRecording read(folder / name, kCloseTogether);  // some twenty restart points
    Random random(2);
    for (int i = 0; i < 120; ++i) {
      const int f = static_cast<int>(random.uniform(0, 40));
      ASSERT_TRUE(same_pixels(read.image(f), original.image(f))) << f;
    }
  }
}

TEST(CompressedRecording, ThreadsReadingAtOnceSeeTheSamePixels) {
  const TestFolder folder;
  const MemoryRecording original = sample_recording({.width = 200, .height = 150, .frames = 40});
  for (const bool compress : {false, true}) {
    write_recording(original, folder / "r.mha", {.compress = compress});
    const FileRecording read(folder / "r.mha", kCloseTogether);
    std::vector<int> wrong(4);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        Random random(static_cast<std::uint64_t>(t));
        for (int i = 0; i < 60; ++i) {
          const int f = static_cast<int>(random.uniform(0, 40));
          wrong[static_cast<std::size_t>(t)] += !same_pixels(read.image(f), original.image(f));
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, std::vector<int>(4));
  }
}

}  // namespace
}  // namespace fathom
