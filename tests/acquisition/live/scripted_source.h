#pragma once

#include <memory>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "acquisition/live/live_source.h"
#include "acquisition/live/tracked_frame.h"

namespace fathom {

/// A source that delivers what a test tells it to, on the test's thread.
class ScriptedSource : public LiveSource {
 public:
  explicit ScriptedSource(std::string name) : name_(std::move(name)) {}

  const std::string& name() const override { return name_; }
  void start(LiveListener& listener) override { listener_ = &listener; }
  void stop() override {}

  void frame(double time_s, cv::Mat image, std::optional<double> device_time_s = {}) {
    LiveFrame frame;
    frame.image = std::move(image);
    frame.number = number_++;
    frame.time_s = time_s;
    frame.arrival_s = live_clock_s();
    frame.device_time_s = device_time_s;
    listener_->on_frame(std::move(frame));
  }
  void sample(double time_s, const Eigen::Matrix4d& matrix, const std::string& status = "OK",
              const std::string& transform = "ProbeToTracker", std::optional<double> device_time_s = {}) {
    listener_->on_sample({transform, {matrix, status}, time_s, live_clock_s(), device_time_s});
  }
  void event(SourceState state, const std::string& message) {
    listener_->on_event({state, live_clock_s(), name_ + ": " + message});
  }

 private:
  std::string name_;
  LiveListener* listener_ = nullptr;
  std::uint64_t number_ = 0;
};

inline Eigen::Matrix4d shifted(double x_mm, double angle_rad = 0.0) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d(1, 2, 2) / 3.0).toRotationMatrix();
  pose.translation().x() = x_mm;
  return pose.matrix();
}

/// An image of 8-bit pixels that tells which one it is.
inline cv::Mat numbered_image(int number, cv::Size size = {16, 12}, int type = CV_8UC1) {
  cv::Mat image(size, type);
  cv::randu(image, cv::Scalar(0), cv::Scalar(255));
  image.at<std::uint8_t>(0, 0) = static_cast<std::uint8_t>(number);
  return image;
}

/// A frame as a session delivers it, with a pose `x_mm` along x.
inline SharedFrame tracked_frame(double time_s, cv::Mat image, double x_mm, const std::string& status = "OK") {
  auto frame = std::make_shared<TrackedFrame>();
  frame->frame.image = std::move(image);
  frame->frame.time_s = time_s;
  frame->frame.arrival_s = time_s;
  frame->tracked = status == "OK";
  frame->poses.push_back({"ProbeToTracker", {shifted(x_mm, 0.001 * x_mm), status}});
  return frame;
}

}  // namespace fathom
