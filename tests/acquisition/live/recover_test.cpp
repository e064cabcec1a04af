#include <fstream>

#include <gtest/gtest.h>

#include "acquisition/live/folder_names.h"
#include "acquisition/live/recorder.h"
#include "acquisition/live/sweep_lines.h"
#include "core/error.h"
#include "core/random.h"
#include "tests/acquisition/live/scripted_source.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

constexpr int kFrames = 24;
constexpr std::size_t kFrameBytes = 16 * 12;

/// A folder as a crash leaves it: everything but the header.
std::vector<SharedFrame> record_unfinished(const std::filesystem::path& folder) {
  std::vector<SharedFrame> frames;
  for (int i = 0; i < kFrames; ++i) frames.push_back(tracked_frame(10.0 + 0.02 * i, numbered_image(i), i));
  Recorder recorder(folder);
  recorder.record();
  for (const SharedFrame& frame : frames) {
    recorder.on_frame(frame);
    recorder.on_sample({"ProbeToTracker", frame->poses[0].pose, frame->frame.time_s, frame->frame.time_s, {}});
  }
  recorder.finish();
  std::filesystem::remove(folder / kSweepHeader);
  return frames;
}

void copy_folder(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::filesystem::copy(from, to, std::filesystem::copy_options::recursive);
}

/// Checks that the recovered frames are the `numbers` of the recorded ones.
void expect_frames(const std::filesystem::path& folder, const std::vector<SharedFrame>& frames,
                   const std::vector<int>& numbers) {
  const auto recording = open_recording(folder);
  ASSERT_EQ(recording->header().frame_count(), static_cast<int>(numbers.size()));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const TrackedFrame& expected = *frames[static_cast<std::size_t>(numbers[i])];
    const cv::Mat image = recording->image(static_cast<int>(i));
    EXPECT_EQ(cv::norm(image, expected.frame.image, cv::NORM_INF), 0.0) << i;
    EXPECT_EQ(recording->header().frames[i].time_s, expected.frame.time_s);
    EXPECT_EQ(recording->header().frames[i].poses.at(0), expected.poses[0].pose);
  }
}

std::vector<int> first_numbers(std::size_t count) {
  std::vector<int> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(static_cast<int>(i));
  return numbers;
}

TEST(Recover, IsAskedForByWhoeverOpensAnUnfinishedRecording) {
  const ScratchFolder scratch;
  record_unfinished(scratch / "scan");
  const std::string message = message_of<Error>([&] { open_recording(scratch / "scan"); });
  EXPECT_NE(message.find("cut off before it was finished; run `fathom recover "), std::string::npos) << message;
  std::filesystem::create_directory(scratch / "empty");
  for (const auto& folder : {scratch / "empty", scratch / "none"}) {
    EXPECT_NE(message_of<Error>([&] { recover_recording(folder); }), "");
  }
  EXPECT_NE(message_of<Error>([&] { open_recording(scratch / "empty"); }).find("without a recording"),
            std::string::npos);
}

TEST(Recover, LeavesARecordingAloneThatIsBeingMadeOrWasFinished) {
  const ScratchFolder scratch;
  Recorder recorder(scratch / "scan");
  recorder.record();
  recorder.on_frame(tracked_frame(1.0, numbered_image(1), 1));
  EXPECT_NE(message_of<Error>([&] { recover_recording(scratch / "scan"); }).find("is being recorded"),
            std::string::npos);
  EXPECT_NE(message_of<Error>([&] { open_recording(scratch / "scan"); }).find("is being recorded"), std::string::npos);
  recorder.finish();
  const std::string header = content_of(scratch / "scan" / kSweepHeader);
  const FinishedRecording found = recover_recording(scratch / "scan");
  EXPECT_TRUE(found.was_finished);
  EXPECT_EQ(found.frames, 1u);
  EXPECT_EQ(content_of(scratch / "scan" / kSweepHeader), header);
}

TEST(Recover, GivesBackEveryWholeFrameOfFilesCutAnywhere) {
  const ScratchFolder scratch;
  const auto frames = record_unfinished(scratch / "scan");
  const std::string lines = content_of(scratch / "scan" / kSweepLines);
  const std::size_t first_line = lines.find('\n') + 1;
  Random random(7);
  for (int round = 0; round < 60; ++round) {
    const auto folder = scratch / ("cut" + std::to_string(round));
    copy_folder(scratch / "scan", folder);
    const auto pixel_bytes = static_cast<std::size_t>(random.uniform(0, kFrames * kFrameBytes + 1));
    const auto line_bytes = static_cast<std::size_t>(
        random.uniform(static_cast<double>(first_line), static_cast<double>(lines.size() + 1)));
    std::filesystem::resize_file(folder / kSweepPixels, pixel_bytes);
    std::filesystem::resize_file(folder / kSweepLines, line_bytes);
    std::filesystem::resize_file(folder / kTrackerLines, static_cast<std::size_t>(random.uniform(0, 500)));
    const std::string kept_lines = content_of(folder / kSweepLines);
    const auto whole_lines = static_cast<std::size_t>(std::count(kept_lines.begin(), kept_lines.end(), '\n')) - 1;
    const std::size_t whole = std::min(pixel_bytes / kFrameBytes, whole_lines);
    if (whole == 0) {
      EXPECT_NE(message_of<Error>([&] { recover_recording(folder); }).find("holds no whole frame"), std::string::npos);
      continue;
    }
    const FinishedRecording found = recover_recording(folder);
    EXPECT_EQ(found.frames, whole);
    EXPECT_GE(found.lost_bytes, pixel_bytes - whole * kFrameBytes);
    expect_frames(folder, frames, first_numbers(whole));
    EXPECT_EQ(std::filesystem::file_size(folder / kSweepPixels), pixel_bytes);
    EXPECT_EQ(content_of(folder / kSweepLines), kept_lines);
  }
}

TEST(Recover, LeavesOutDamagedFramesAndKeepsThoseBehind) {
  const ScratchFolder scratch;
  const auto frames = record_unfinished(scratch / "scan");
  std::string pixels = content_of(scratch / "scan" / kSweepPixels);
  pixels[3 * kFrameBytes + 5] = static_cast<char>(pixels[3 * kFrameBytes + 5] ^ 0x10);
  put(scratch / "scan" / kSweepPixels, pixels);
  std::string lines = content_of(scratch / "scan" / kSweepLines);
  const std::size_t place = lines.find("\"frame\":7,");
  lines[place + 30] = static_cast<char>(lines[place + 30] ^ 1);
  put(scratch / "scan" / kSweepLines, lines);
  const FinishedRecording found = recover_recording(scratch / "scan");
  EXPECT_EQ(found.frames, kFrames - 2u);
  EXPECT_GT(found.lost_bytes, 2 * kFrameBytes);
  std::vector<int> numbers = first_numbers(kFrames);
  std::erase(numbers, 3);
  std::erase(numbers, 7);
  expect_frames(scratch / "scan", frames, numbers);
  EXPECT_EQ(content_of(scratch / "scan" / kSweepPixels), pixels);
}

TEST(Recover, NeedsTheFirstLine) {
  const ScratchFolder scratch;
  record_unfinished(scratch / "scan");
  std::string lines = content_of(scratch / "scan" / kSweepLines);
  lines[20] = '#';
  put(scratch / "scan" / kSweepLines, lines);
  const auto before = scratch.names();
  EXPECT_NE(message_of<Error>([&] { recover_recording(scratch / "scan"); }).find("first line is damaged"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(scratch / "scan" / kSweepHeader));
}

TEST(SweepLines, AreKnownToBeWholeByTheirChecksum) {
  FrameLine line;
  line.frame = 3;
  line.bytes = 7;
  line.tracked = *tracked_frame(0.1, {}, 2.0 / 3.0);
  line.tracked.frame.fields = {{"a \"b\"", "line\nend"}};
  std::string text = line_of(line);
  ASSERT_EQ(text.back(), '\n');
  text.pop_back();
  const auto read = parse_frame_line(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->tracked.poses.at(0).pose, line.tracked.poses[0].pose);
  EXPECT_EQ(read->tracked.frame.fields, line.tracked.frame.fields);
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string damaged = text;
    damaged[i] = static_cast<char>(damaged[i] ^ 1);
    EXPECT_FALSE(is_whole_line(damaged)) << i;
    EXPECT_FALSE(is_whole_line(text.substr(0, i)));
  }
  EXPECT_FALSE(parse_invalid_line(text));
}

TEST(FolderNames, OfAnyDeviceCanBeReadBack) {
  const ScratchFolder scratch;
  auto frame = std::make_shared<TrackedFrame>();
  frame->frame.image = numbered_image(1);
  frame->frame.time_s = 1.0;
  frame->frame.status = " OK";
  frame->frame.fields = {{"Timestamp", "x"}, {"AToBTransform", "1"}, {"fine", "1"}, {"fine", "2"}, {"a=b", "\n"}};
  Eigen::Matrix4d skewed = shifted(1);
  skewed(0, 1) = 0.5;
  frame->poses = {{"Probe=To\nTracker", {shifted(2), "OK"}},
                  {"Probe_To_Tracker", {shifted(3), "OK"}},
                  {"", {shifted(4), "OK"}},
                  {"Skew", {skewed, "OK"}},
                  {"Odd", {shifted(5), "OK\n"}}};
  Recorder recorder(scratch / "scan", {.fields = {{"DimSize", "1"}, {"Depth", "12"}}});
  recorder.record();
  recorder.on_frame(frame);
  recorder.finish();
  const auto recording = open_recording(scratch / "scan");
  const FrameHeader& header = recording->header().frames.at(0);
  EXPECT_EQ(recording->header().transforms, (std::vector<std::string>{"Probe_To_Tracker", "Skew", "Odd"}));
  EXPECT_EQ(header.poses.at(0)->matrix, shifted(2));
  EXPECT_FALSE(header.poses.at(1)->valid());
  EXPECT_FALSE(header.poses.at(2)->valid());
  EXPECT_FALSE(header.image_valid());
  EXPECT_EQ(header.fields.front(), (std::pair<std::string, std::string>("fine", "1")));
}

// PLUS takes a line in pieces below 1000 characters, and what does not fit for a line of its own.
TEST(FolderNames, MakeNoLineOfTheHeaderTooLongForPlus) {
  const ScratchFolder scratch;
  const std::string long_name(300, 'n');
  auto frame = std::make_shared<TrackedFrame>();
  frame->frame.image = numbered_image(1);
  frame->frame.time_s = 1.0;
  Eigen::Matrix4d far = shifted(1e8 / 3);
  far.topLeftCorner<3, 3>() = Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  frame->poses = {{long_name + "To" + long_name, {far, "OK"}}};
  for (const std::size_t length : {700, 980, 4000}) {
    frame->frame.fields.emplace_back(std::string(200, 'f') + std::to_string(length), std::string(length, 'v'));
    frame->frame.fields.emplace_back("Field" + std::to_string(length), std::string(length, 'v'));
  }
  Recorder recorder(scratch / "scan", {.fields = frame->frame.fields});
  recorder.record();
  recorder.on_frame(frame);
  recorder.finish();
  EXPECT_EQ(open_recording(scratch / "scan")->header().frames.at(0).fields.front().first, "Field700");
  std::ifstream header(scratch / "scan" / "sweep.mhd");
  for (std::string line; std::getline(header, line);) EXPECT_LT(line.size(), 1000U) << line.substr(0, 40);
}

}  // namespace
}  // namespace fathom
