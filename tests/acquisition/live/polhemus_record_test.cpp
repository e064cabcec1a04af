#include "acquisition/live/polhemus_record.h"

#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "acquisition/rigid.h"
#include "tests/acquisition/live/polhemus_bytes.h"

namespace fathom {
namespace {

constexpr int kMostDistortion = 10;

std::vector<PolhemusFormat> all_formats() {
  std::vector<PolhemusFormat> formats;
  for (const auto model : {PolhemusModel::kFastrak, PolhemusModel::kPatriot, PolhemusModel::kLiberty}) {
    for (const bool text : {false, true}) {
      for (const bool distortion : {false, true}) formats.push_back({model, text, 10.0, distortion});
    }
  }
  return formats;
}

// What a reading is rounded to on its way, mm: five digits of text, or 24 bits.
double rounding_mm(const PolhemusFormat& format) { return format.text ? 6e-3 : 1e-4; }

void expect_same(const PolhemusReading& found, const PolhemusReading& sent, const PolhemusFormat& format) {
  EXPECT_EQ(found.station, sent.station);
  EXPECT_EQ(found.error, sent.error);
  EXPECT_LE((found.position_mm - sent.position_mm).cwiseAbs().maxCoeff(), rounding_mm(format));
  EXPECT_LE((found.quaternion - sent.quaternion).cwiseAbs().maxCoeff(), format.text ? 6e-5 : 1e-7);
  const bool fastrak = format.model == PolhemusModel::kFastrak;
  EXPECT_EQ(found.time_ms, fastrak ? std::nullopt : sent.time_ms);
  EXPECT_EQ(found.frame, fastrak ? std::nullopt : sent.frame);
  EXPECT_EQ(found.distortion, fastrak || !format.distortion ? std::nullopt : sent.distortion);
}

std::vector<PolhemusReading> random_readings(const PolhemusFormat& format, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<PolhemusReading> readings;
  for (int i = 0; i < count; ++i) {
    readings.push_back(random_reading(random, 1 + i % most_stations(format.model), static_cast<std::uint32_t>(i)));
  }
  return readings;
}

std::string stream_of(const std::vector<PolhemusReading>& readings, const PolhemusFormat& format) {
  std::string bytes;
  for (const PolhemusReading& reading : readings) bytes += polhemus_bytes(reading, format);
  return bytes;
}

TEST(PolhemusRecord, IsReadAsSentInAnyPieces) {
  for (const PolhemusFormat& format : all_formats()) {
    const auto sent = random_readings(format, 40, 1);
    const std::string bytes = stream_of(sent, format);
    for (const std::size_t piece : {1, 2, 3, 7, 64, 1'000'000}) {
      const PolhemusFound found = find_all(bytes, format, piece);
      ASSERT_EQ(found.readings.size(), sent.size()) << name_of(format.model) << " text " << format.text;
      EXPECT_EQ(found.noise + found.left, 0U);
      for (std::size_t i = 0; i < sent.size(); ++i) expect_same(found.readings[i], sent[i], format);
    }
  }
}

TEST(PolhemusRecord, GivesThePoseFromSensorToSource) {
  PolhemusReading reading;
  reading.station = 1;
  reading.position_mm = Eigen::Vector3d(10, -20, 30);
  // A quarter turn about z takes x to y.
  reading.quaternion = Eigen::Vector4d(std::sqrt(0.5), 0, 0, std::sqrt(0.5));
  const Pose pose = polhemus_pose(reading, kMostDistortion);
  EXPECT_EQ(pose.status, "OK");
  const Eigen::Vector4d tip = pose.matrix * Eigen::Vector4d(1, 0, 0, 1);
  EXPECT_LT((tip - Eigen::Vector4d(10, -19, 30, 1)).norm(), 1e-12);
}

TEST(PolhemusRecord, InInchesComesOutInMillimetres) {
  PolhemusFormat inches{PolhemusModel::kLiberty, false, 25.4, true};
  PolhemusReading sent = random_readings(inches, 1, 2).front();
  sent.position_mm = Eigen::Vector3d(25.4, 254.0, -12.7);
  const std::string bytes = polhemus_bytes(sent, inches);
  // 1, 10 and -0.5 inches are exact in binary, so that the bytes themselves are known.
  EXPECT_EQ(bytes.substr(20, 12), std::string("\x00\x00\x80\x3f\x00\x00\x20\x41\x00\x00\x00\xbf", 12));
  EXPECT_EQ(find_all(bytes, inches).readings.at(0).position_mm, sent.position_mm);
}

TEST(PolhemusRecord, IsFoundAmongNoise) {
  for (const PolhemusFormat& format : all_formats()) {
    Random random(3);
    const auto sent = random_readings(format, 200, 4);
    std::string bytes;
    for (const PolhemusReading& reading : sent) {
      const auto noise = static_cast<int>(random.uniform(0, 12));
      for (int i = 0; i < noise; ++i) bytes += static_cast<char>(random.uniform(0, 256));
      // Text has no other mark of a beginning than the line's end before it.
      if (format.text) bytes += '\n';
      bytes += polhemus_bytes(reading, format);
    }
    const PolhemusFound found = find_all(bytes, format, 17);
    ASSERT_EQ(found.readings.size(), sent.size()) << name_of(format.model) << " text " << format.text;
    EXPECT_GT(found.noise, 0U);
    for (std::size_t i = 0; i < sent.size(); ++i) expect_same(found.readings[i], sent[i], format);
  }
}

// Any run of bytes is lost from the middle one of three records: the others must come through, and no pose may be made
// of the parts.
TEST(PolhemusRecord, ThatWasCutHarmsNoOtherAndBecomesNoPose) {
  for (const PolhemusFormat& format : all_formats()) {
    if (format.text && format.model != PolhemusModel::kFastrak) continue;  // lines of these have no fixed length
    const auto sent = random_readings(format, 3, 5);
    const std::string first = polhemus_bytes(sent[0], format);
    const std::string cut = polhemus_bytes(sent[1], format);
    const std::string last = polhemus_bytes(sent[2], format);
    // A line that has lost its end is one with the next.
    const std::size_t end = format.text ? cut.size() - 1 : cut.size();
    for (std::size_t from = 0; from < end; ++from) {
      for (std::size_t to = from + 1; to <= end; ++to) {
        const auto found = find_all(first + cut.substr(0, from) + cut.substr(to) + last, format).readings;
        std::size_t valid = 0;
        for (const PolhemusReading& reading : found) {
          if (polhemus_pose(reading, kMostDistortion).valid()) ++valid;
        }
        ASSERT_EQ(valid, 2U) << name_of(format.model) << " text " << format.text << " lost " << from << " to " << to;
        expect_same(found.front(), sent[0], format);
        expect_same(found.back(), sent[2], format);
      }
    }
  }
}

TEST(PolhemusRecord, WithAnErrorSaysWhichAndIsNoValidPose) {
  const std::pair<int, const char*> errors[] = {
      {'u', "OUT_OF_VOLUME"}, {49, "OUT_OF_VOLUME"}, {'a', "INSTRUMENT_ERROR_a"}, {57, "INSTRUMENT_ERROR_57"}};
  const PolhemusFormat format{PolhemusModel::kLiberty, false, 10.0, true};
  PolhemusReading sent = random_readings(format, 1, 6).front();
  for (const auto& [code, status] : errors) {
    sent.error = code;
    const auto found = find_all(polhemus_bytes(sent, format), format).readings;
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(polhemus_pose(found[0], kMostDistortion).status, status);
  }
  for (const bool text : {false, true}) {
    const PolhemusFormat fastrak{PolhemusModel::kFastrak, text, 10.0, false};
    sent.error = 'x';  // out of the motion box
    EXPECT_EQ(polhemus_pose(find_all(polhemus_bytes(sent, fastrak), fastrak).readings.at(0), 0).status,
              "OUT_OF_VOLUME");
  }
}

TEST(PolhemusRecord, WithNumbersThatAreNoPoseIsRefused) {
  const auto check = [](const auto& change, const char* status) {
    for (const PolhemusFormat& format : all_formats()) {
      PolhemusReading sent = random_readings(format, 1, 7).front();
      change(sent);
      const auto found = find_all(polhemus_bytes(sent, format), format).readings;
      if (found.empty() && format.text) continue;  // a number too wide for its column makes no line
      ASSERT_EQ(found.size(), 1U) << name_of(format.model) << " text " << format.text << status;
      const Pose pose = polhemus_pose(found[0], kMostDistortion);
      EXPECT_EQ(pose.status, status);
      EXPECT_TRUE(pose.matrix.allFinite());
    }
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  check([](PolhemusReading& r) { r.position_mm[1] = kNan; }, "NOT_FINITE");
  check([](PolhemusReading& r) { r.quaternion[2] = kNan; }, "NOT_FINITE");
  check([](PolhemusReading& r) { r.position_mm[0] = std::numeric_limits<double>::infinity(); }, "NOT_FINITE");
  check([](PolhemusReading& r) { r.quaternion *= 1.01; }, "NOT_RIGID");
  check([](PolhemusReading& r) { r.quaternion.setZero(); }, "NOT_RIGID");
  check([](PolhemusReading& r) { r.position_mm[2] = 12'000; }, "OUT_OF_VOLUME");
}

TEST(PolhemusRecord, WithTooMuchDistortionIsRefused) {
  for (const bool text : {false, true}) {
    const PolhemusFormat format{PolhemusModel::kPatriot, text, 10.0, true};
    PolhemusReading sent = random_readings(format, 1, 8).front();
    for (const int distortion : {0, kMostDistortion, kMostDistortion + 1, 255}) {
      sent.distortion = distortion;
      const auto found = find_all(polhemus_bytes(sent, format), format).readings;
      ASSERT_EQ(found.size(), 1U);
      EXPECT_EQ(polhemus_pose(found[0], kMostDistortion).status, distortion > kMostDistortion ? "DISTORTED" : "OK");
    }
  }
}

// Any bytes: reading goes on, holds back less than the longest record, and what it calls a pose is one.
void fuzz(std::uint64_t seed, int rounds) {
  Random random(seed);
  const auto formats = all_formats();
  for (int round = 0; round < rounds; ++round) {
    const PolhemusFormat& format = formats[static_cast<std::size_t>(round) % formats.size()];
    std::string bytes = stream_of(random_readings(format, 20, seed + static_cast<std::uint64_t>(round)), format);
    const auto changes = static_cast<int>(random.uniform(0, 60));
    for (int i = 0; i < changes; ++i) {
      const auto at = static_cast<std::size_t>(random.uniform(0, static_cast<double>(bytes.size())));
      const double kind = random.uniform();
      if (kind < 0.5) bytes[at] = static_cast<char>(random.uniform(0, 256));
      if (kind >= 0.5 && kind < 0.75) bytes.erase(at, static_cast<std::size_t>(random.uniform(1, 40)));
      if (kind >= 0.75) bytes.insert(at, 1, "PLYA0\n -.eE"[static_cast<int>(random.uniform(0, 11))]);
    }
    const PolhemusFound found = find_all(bytes, format, static_cast<std::size_t>(random.uniform(1, 90)));
    EXPECT_LE(found.left, 257U);
    for (const PolhemusReading& reading : found.readings) {
      ASSERT_GE(reading.station, 1);
      ASSERT_LE(reading.station, most_stations(format.model));
      const Pose pose = polhemus_pose(reading, kMostDistortion);
      ASSERT_TRUE(pose.matrix.allFinite());
      ASSERT_TRUE(is_rigid(pose.matrix));
      if (pose.valid()) {
        ASSERT_LE(reading.position_mm.norm(), 10'000.0);
      }
    }
  }
}

TEST(PolhemusRecord, SurvivesAnyBytes) { fuzz(9, 600); }
TEST(PolhemusRecordStudy, SurvivesAnyBytesForLong) { fuzz(10, 200'000); }

}  // namespace
}  // namespace fathom
