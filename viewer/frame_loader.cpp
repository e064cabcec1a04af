#include "viewer/frame_loader.h"

#include <exception>
#include <utility>

namespace fathom {

namespace {

FrameLoader::Frame read(const Scan& scan, std::size_t recording, int frame) {
  FrameLoader::Frame result{recording, frame, {}, {}};
  try {
    result.image = scan.recordings.at(recording)->image(frame).clone();
  } catch (const std::exception& error) {
    result.error = error.what();
  }
  return result;
}

}  // namespace

FrameLoader::FrameLoader(std::function<void()> wake) : wake_main_(std::move(wake)), thread_([this] { run(); }) {}

FrameLoader::~FrameLoader() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void FrameLoader::ask(std::shared_ptr<const Scan> scan, std::size_t recording, int frame) {
  {
    const std::lock_guard lock(mutex_);
    scan_ = std::move(scan);
    recording_ = recording;
    frame_ = frame;
  }
  wake_.notify_all();
}

std::optional<FrameLoader::Frame> FrameLoader::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(ready_, std::nullopt);
}

bool FrameLoader::busy() const {
  const std::lock_guard lock(mutex_);
  return reading_ || scan_ != nullptr || ready_.has_value();
}

void FrameLoader::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stopping_ || scan_ != nullptr; });
    if (stopping_) return;
    const std::shared_ptr<const Scan> scan = std::exchange(scan_, nullptr);
    const std::size_t recording = recording_;
    const int frame = frame_;
    reading_ = true;
    lock.unlock();
    Frame result = read(*scan, recording, frame);
    lock.lock();
    reading_ = false;
    ready_ = std::move(result);
    if (wake_main_) wake_main_();
  }
}

}  // namespace fathom
