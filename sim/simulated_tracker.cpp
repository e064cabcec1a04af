#include "sim/simulated_tracker.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"
#include "core/numbers.h"
#include "core/random.h"
#include "sim/random_stream.h"

namespace fathom {

namespace {

constexpr double kRadian = std::numbers::pi / 180.0;
constexpr double kWrong_mm = 15.0;  // on each axis, standard deviation
constexpr double kWrong_rad = 0.1;  // about each axis
constexpr int kLongestLoss = 12;    // frames in a row: half a second with the sensor covered

/// `share` of `count` frames, to the nearest frame, in runs of up to `longest`.
std::vector<bool> chosen(std::size_t count, double share, int longest, Random random) {
  std::vector<bool> marked(count, false);
  auto left = static_cast<long>(std::lround(share * static_cast<double>(count)));
  while (left > 0) {
    auto at = static_cast<std::size_t>(random.uniform() * static_cast<double>(count));
    const int run = 1 + static_cast<int>(random.uniform() * longest);
    for (int i = 0; i < run && left > 0 && at < count; ++i, ++at) {
      if (!marked[at]) --left;
      marked[at] = true;
    }
  }
  return marked;
}

}  // namespace

Eigen::Vector3d gaussian_vector(Random& random, double sigma) {
  Eigen::Vector3d vector;
  for (int axis = 0; axis < 3; ++axis) vector[axis] = random.normal();
  return vector * sigma;
}

void displace(Eigen::Isometry3d& pose, double mm, double rad, Random& random) {
  const Eigen::Vector3d shift = gaussian_vector(random, mm);
  const Eigen::Vector3d turn = gaussian_vector(random, rad);
  pose.translation() += shift;
  if (turn.norm() > 0.0) {
    pose.linear() = (pose.linear() * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix()).eval();
  }
}

void require_within(const char* what, double value, double low, double high, const char* unit) {
  if (value >= low && value <= high) return;  // false for what is not a number
  throw Error(std::string("simulate: the ") + what + " cannot be " +
              (std::isfinite(value) ? format_real(value) : "without a finite value") + "; choose from " +
              format_real(low) + " to " + format_real(high) + (*unit == '\0' ? "" : " ") + unit);
}

void TrackerOptions::check() const {
  require_within("tracker noise", noise_mm, 0.0, kMaxShift_mm, "mm");
  require_within("tracker noise", noise_deg, 0.0, kMaxTurn_deg, "degrees");
  require_within("latency", latency_s, -kMaxLatency_s, kMaxLatency_s, "seconds");
  require_within("share of outliers", outliers, 0.0, 1.0, "");
  require_within("share of dropouts", dropouts, 0.0, 1.0, "");
}

Eigen::Isometry3d placed(const Eigen::Vector3d& turn_rad, const Eigen::Vector3d& place_mm) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()).toRotationMatrix();
  pose.translation() = place_mm;
  return pose;
}

Eigen::Isometry3d simulated_tracker_from_reference() { return placed({-0.42, 0.23, 0.91}, {118.0, -342.0, 251.0}); }

Eigen::Isometry3d simulated_reference_from_phantom() { return placed({0.17, 0.36, -0.52}, {31.0, -18.0, 147.0}); }

TrackedPoses track(std::vector<double> times_s, std::vector<Eigen::Isometry3d> tracker_from_probe,
                   const TrackerOptions& options) {
  const std::size_t count = tracker_from_probe.size();
  TrackedPoses poses{std::move(times_s), std::move(tracker_from_probe), {}, {}};
  poses.wrong = chosen(count, options.outliers, 1, random_stream(options.seed, Stream::kOutliers));
  poses.lost = chosen(count, options.dropouts, kLongestLoss, random_stream(options.seed, Stream::kDropouts));
  Random noise = random_stream(options.seed, Stream::kNoise);
  Random blunder = random_stream(options.seed, Stream::kBlunders);
  const double each = 1.0 / std::sqrt(3.0);  // axis, of a distance in space
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Isometry3d& pose = poses.tracker_from_probe[i];
    displace(pose, each * options.noise_mm, each * options.noise_deg * kRadian, noise);
    if (poses.wrong[i]) displace(pose, kWrong_mm, kWrong_rad, blunder);
    if (poses.lost[i]) pose = Eigen::Isometry3d::Identity();
  }
  return poses;
}

RecordingHeader tracked_header(const TrackedPoses& poses, int width, int height) {
  RecordingHeader header;
  header.width = width;
  header.height = height;
  header.pixel_type = CV_8UC1;
  header.transforms = {"ProbeToTracker", "ReferenceToTracker"};
  const Pose reference{simulated_tracker_from_reference().matrix(), "OK"};
  for (std::size_t i = 0; i < poses.times_s.size(); ++i) {
    FrameHeader frame;
    frame.time_s = poses.times_s[i];
    frame.image_status = "OK";
    frame.poses = {Pose{poses.tracker_from_probe[i].matrix(), poses.lost[i] ? "INVALID" : "OK"}, reference};
    header.frames.push_back(std::move(frame));
  }
  return header;
}

}  // namespace fathom
