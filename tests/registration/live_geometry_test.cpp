#include <chrono>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "acquisition/live/live_session.h"
#include "acquisition/live/recorder.h"
#include "acquisition/recording.h"
#include "core/error.h"
#include "registration/cropped_source.h"
#include "registration/geometry_watch.h"
#include "tests/acquisition/live/scripted_source.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

const cv::Rect kPicture(20, 8, 80, 70);
const cv::Size kSize(120, 90);

/// What a linear probe shows: speckle within `shape`, and a mark that stands still.
cv::Mat picture(const cv::Rect& shape, cv::Size size = kSize) {
  cv::Mat image = cv::Mat::zeros(size, CV_8UC1);
  cv::Mat speckle = image(shape);
  cv::randu(speckle, cv::Scalar(40), cv::Scalar(200));
  image(cv::Rect(2, 2, 8, 4)) = 220;
  return image;
}

/// Keeps what the session tells.
class Told : public SessionListener {
 public:
  void on_frame(const SharedFrame& frame) override {
    const std::lock_guard lock(mutex_);
    valid_.push_back(frame->valid());
    pixels_ = frame->frame.image.data;
  }
  void on_event(const SessionEvent& event) override {
    const std::lock_guard lock(mutex_);
    if (event.geometry) faults_.push_back(*event.geometry);
  }
  std::vector<GeometryFault> faults() const {
    const std::lock_guard lock(mutex_);
    return faults_;
  }
  std::vector<bool> valid() const {
    const std::lock_guard lock(mutex_);
    return valid_;
  }
  const unsigned char* pixels() const {
    const std::lock_guard lock(mutex_);
    return pixels_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<GeometryFault> faults_;
  std::vector<bool> valid_;
  const unsigned char* pixels_ = nullptr;
};

/// A session that watches and records; its images and poses come every 4 ms.
class Watched {
 public:
  explicit Watched(const std::optional<ImagePreset>& preset = {}) {
    auto source = std::make_unique<ScriptedSource>("scanner");
    source_ = source.get();
    std::unique_ptr<LiveSource> images = std::move(source);
    if (preset) images = std::make_unique<CroppedSource>(std::move(images), *preset);
    SessionOptions options;
    options.watch_geometry = watching(std::make_shared<GeometryWatch>());
    session = std::make_unique<LiveSession>(std::move(images), nullptr, options);
    session->add(told);
    session->add(recorder);
    recorder.record();
    session->start();
  }
  ~Watched() { session->stop(); }

  void send(const cv::Mat& image) {
    const double time_s = start_s_ + 0.004 * static_cast<double>(sent);
    source_->sample(time_s, shifted(static_cast<double>(sent)));
    source_->frame(time_s, image);
    ++sent;
    while (session->statistics().frames + 20 < sent) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  /// Ends, and opens what was recorded.
  std::unique_ptr<Recording> recording() {
    session->stop();
    recorder.finish();
    return open_recording(scratch / "scan");
  }

  ScratchFolder scratch;
  Told told;
  Recorder recorder{scratch / "scan"};
  std::unique_ptr<LiveSession> session;
  std::size_t sent = 0;

 private:
  ScriptedSource* source_ = nullptr;
  double start_s_ = live_clock_s() - 1.5;
};

std::string field(const RecordingHeader& header, const std::string& name) {
  for (const auto& [known, value] : header.fields) {
    if (known == name) return value;
  }
  return "none";
}

TEST(LiveGeometry, ARecordingWithoutAChangeSaysNothingOfIt) {
  Watched watched;
  for (int i = 0; i < 150; ++i) watched.send(picture(kPicture));
  const auto recording = watched.recording();
  EXPECT_TRUE(watched.told.faults().empty());
  EXPECT_EQ(watched.session->statistics().geometry_fault, "");
  EXPECT_EQ(field(recording->header(), "GeometryFault"), "none");
  for (const FrameHeader& frame : recording->header().frames) EXPECT_TRUE(frame.image_valid());
}

TEST(LiveGeometry, FramesOfAnotherDepthAreNeverValid) {
  constexpr std::size_t kBefore = 100, kAfter = 120;
  Watched watched;
  for (std::size_t i = 0; i < kBefore; ++i) watched.send(picture(kPicture));
  // Deeper: a linear probe's picture is drawn narrower.
  for (std::size_t i = 0; i < kAfter; ++i) watched.send(picture(cv::Rect(30, 8, 60, 70)));
  const auto recording = watched.recording();
  ASSERT_EQ(watched.told.faults().size(), 1u);
  EXPECT_NE(watched.session->statistics().geometry_fault.find("depth"), std::string::npos);
  EXPECT_EQ(field(recording->header(), "GeometryFault"), watched.told.faults()[0].message);
  const auto& frames = recording->header().frames;
  ASSERT_EQ(frames.size(), kBefore + kAfter);
  // Also those that had been recorded before it was noticed.
  for (std::size_t i = kBefore; i < frames.size(); ++i) EXPECT_FALSE(frames[i].image_valid()) << i;
  // A change is placed to the three windows of 30 frames before it was noticed.
  for (std::size_t i = 0; i < kBefore - 30; ++i) EXPECT_TRUE(frames[i].image_valid()) << i;
  EXPECT_TRUE(watched.told.valid().at(kBefore - 1));
  EXPECT_FALSE(watched.told.valid().back());
}

TEST(LiveGeometry, AnotherSizeIsToldAtOnceAndEndsTheRecording) {
  Watched watched;
  for (int i = 0; i < 20; ++i) watched.send(picture(kPicture));
  for (int i = 0; i < 5; ++i) watched.send(picture(kPicture, {140, 90}));
  for (int i = 0; i < 5; ++i) watched.send(picture(kPicture));
  const auto recording = watched.recording();
  EXPECT_EQ(recording->header().frame_count(), 20);
  EXPECT_EQ(field(recording->header(), "GeometryFault"), "the images changed from 120x90 to 140x90 pixels");
  const std::vector<bool> valid = watched.told.valid();
  ASSERT_EQ(valid.size(), 30u);
  // The size that comes back does not bring the calibration back: nobody saw what else was changed meanwhile.
  for (std::size_t i = 0; i < valid.size(); ++i) EXPECT_EQ(valid[i], i < 20) << i;
}

TEST(LiveGeometry, AFaultFromBeforeTheFirstRecordedFrameIsInTheHeaderToo) {
  Watched watched;
  watched.recorder.pause();
  watched.send(picture(kPicture));
  watched.send(picture(kPicture, {140, 90}));
  while (watched.told.faults().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  watched.recorder.record();
  for (int i = 0; i < 3; ++i) watched.send(picture(kPicture, {140, 90}));
  const auto recording = watched.recording();
  EXPECT_NE(field(recording->header(), "GeometryFault"), "none");
  for (const FrameHeader& frame : recording->header().frames) EXPECT_FALSE(frame.image_valid());
}

TEST(LiveGeometry, APresetKeepsItsPartWithoutACopy) {
  const ImagePreset preset{"8 cm", kSize, 80.0, {0.5, 0.5}, kPicture};
  Watched watched(preset);
  const cv::Mat image = picture(kPicture);
  watched.send(image);
  for (int i = 0; i < 3; ++i) watched.send(image);
  watched.session->stop();
  EXPECT_EQ(watched.told.pixels(), image.ptr(kPicture.y) + kPicture.x);
  const auto recording = watched.recording();
  EXPECT_EQ(cv::norm(recording->image(0), image(kPicture), cv::NORM_INF), 0.0);
}

TEST(LiveGeometry, APresetOfAnotherSizeIsRefusedAndALaterSizeIsAChange) {
  const ImagePreset preset{"8 cm", kSize, 80.0, {0.5, 0.5}, kPicture};
  {
    Watched watched(preset);
    watched.send(picture(kPicture, {140, 90}));
    watched.session->stop();
    EXPECT_TRUE(watched.session->ended());
    const std::string message = watched.session->statistics().images.message;
    EXPECT_NE(message.find("140 x 90"), std::string::npos) << message;
    EXPECT_NE(message.find("choose the preset"), std::string::npos) << message;
  }
  Watched watched(preset);
  for (int i = 0; i < 4; ++i) watched.send(picture(kPicture));
  watched.send(picture(kPicture, {140, 90}));
  const auto recording = watched.recording();
  EXPECT_EQ(recording->header().frame_count(), 4);
  EXPECT_FALSE(watched.told.valid().back());
  EXPECT_EQ(watched.told.faults().size(), 1u);
}

}  // namespace
}  // namespace fathom
