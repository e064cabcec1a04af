#include "acquisition/live/video_source.h"

#include <gtest/gtest.h>

#include "acquisition/live/default_sources.h"
#include "core/error.h"
#include "tests/acquisition/live/heard.h"
#include "tests/acquisition/sample_recording.h"

namespace fathom {
namespace {

constexpr int kWidth = 32;
constexpr int kHeight = 20;
constexpr int kFrames = 12;
constexpr unsigned kInterval_us = 10000;

std::string number(unsigned value, int bytes = 4) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xff);
  return text;
}

std::string chunk(const std::string& name, const std::string& data) {
  return name + number(static_cast<unsigned>(data.size())) + data;
}

std::string list(const std::string& kind, const std::string& data) { return chunk("LIST", kind + data); }

cv::Mat picture(int frame) {
  cv::Mat image(kHeight, kWidth, CV_8UC3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      image.at<cv::Vec3b>(y, x) = {static_cast<std::uint8_t>(5 * x + frame), static_cast<std::uint8_t>(9 * y),
                                   static_cast<std::uint8_t>(20 * frame)};
    }
  }
  return image;  // red, green, blue
}

// An AVI file without compression, whose pixels are blue, green, red, from the bottom up.
std::string film() {
  std::string frames;
  for (int f = 0; f < kFrames; ++f) {
    const cv::Mat image = picture(f);
    std::string data;
    for (int y = kHeight - 1; y >= 0; --y) {
      for (int x = 0; x < kWidth; ++x) {
        for (int c = 2; c >= 0; --c) data += static_cast<char>(image.at<cv::Vec3b>(y, x)[c]);
      }
    }
    frames += chunk("00db", data);
  }
  const unsigned bytes = 3 * kWidth * kHeight;
  const std::string main = number(kInterval_us) + number(0) + number(0) + number(0) + number(kFrames) + number(0) +
                           number(1) + number(bytes) + number(kWidth) + number(kHeight) + std::string(16, '\0');
  const std::string stream = std::string("vidsDIB ") + std::string(12, '\0') + number(kInterval_us) + number(1000000) +
                             number(0) + number(kFrames) + number(bytes) + number(0) + number(0) + std::string(8, '\0');
  const std::string format = number(40) + number(kWidth) + number(kHeight) + number(1, 2) + number(24, 2) + number(0) +
                             number(bytes) + std::string(16, '\0');
  return chunk(
      "RIFF", "AVI " + list("hdrl", chunk("avih", main) + list("strl", chunk("strh", stream) + chunk("strf", format))) +
                  list("movi", frames));
}

void play(const std::string& source, Heard& heard) {
  const auto video = default_sources().make(source);
  video->start(heard);
  EXPECT_TRUE(heard.wait_for_state(SourceState::kEnded));
  video->stop();
}

TEST(VideoSource, PlaysAFilmInItsOwnTimePixelForPixel) {
  const TestFolder folder;
  const std::string file = folder.write("film.avi", film()).string();
  Heard heard;
  play("video:" + file + "?color=1", heard);
  ASSERT_EQ(heard.frames.size(), static_cast<std::size_t>(kFrames));
  for (int f = 0; f < kFrames; ++f) {
    const LiveFrame& frame = heard.frames[static_cast<std::size_t>(f)];
    EXPECT_EQ(frame.number, static_cast<std::uint64_t>(f));
    EXPECT_TRUE(same_pixels(frame.image, picture(f))) << f;
    EXPECT_NEAR(frame.time_s - heard.frames[0].time_s, f * 1e-6 * kInterval_us, 1e-3);
    EXPECT_GE(frame.arrival_s, frame.time_s);
  }
  Heard grey;
  play("video:" + file, grey);
  ASSERT_EQ(grey.frames.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(grey.frames[3].image.type(), CV_8UC1);
}

TEST(VideoSource, WhatIsNoVideoIsRefusedAtTheStart) {
  const TestFolder folder;
  const std::string text = folder.write("text.avi", "this is no film").string();
  const std::vector<std::string> sources{"video:/dev/no-such-video",   "video:99",          "video:99999999999",
                                         "video:http://127.0.0.1:1/x", "video:missing.avi", "video:" + text};
  for (const std::string& source : sources) {
    Heard heard;
    const auto video = default_sources().make(source);
    try {
      video->start(heard);
      ADD_FAILURE() << source << " was started";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("video"), std::string::npos) << error.what();
    }
    video->stop();
  }
  EXPECT_THROW(default_sources().make("video:x.avi?width=-1"), Error);
}

}  // namespace
}  // namespace fathom
