#include "sim/target_scan.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "registration/wire_identification.h"
#include "sim/choice.h"
#include "sim/probe_motion.h"
#include "sim/random_stream.h"
#include "sim/target_setting.h"

namespace fathom {

namespace {

constexpr double kEchoReach_mm = 1.3;     // of a wire's echo to both sides: what is nearer to the edge is cut off
constexpr double kLeastFloorSeen = 0.25;  // of the columns
constexpr double kBeamReach = 1.0;        // full widths of the beam's thickness: a point farther off is not seen

/// What stands in the bath, in image axes (mm), for one frame.
struct TargetInImage {
  std::vector<Wire> wires;
  std::optional<Eigen::Vector3d> point_mm;
  std::optional<Eigen::Hyperplane<double, 3>> floor;  ///< its normal points out of it
};

struct Target {
  std::string object;
  std::vector<Wire> wires;
  TargetView view;
  std::vector<Eigen::Isometry3d> phantom_from_image;  ///< image axes in mm, rigid

  TargetInImage seen_in(std::size_t frame) const {
    const Eigen::Isometry3d image_from_phantom = phantom_from_image[frame].inverse();
    TargetInImage seen;
    for (const Wire& wire : wires) {
      seen.wires.push_back({wire.name, image_from_phantom * wire.front, image_from_phantom * wire.back});
    }
    const Eigen::Vector3d origin = image_from_phantom * Eigen::Vector3d::Zero();
    if (object == "point") seen.point_mm = origin;
    if (object == "wall") seen.floor.emplace(image_from_phantom.linear() * Eigen::Vector3d::UnitZ(), origin);
    return seen;
  }
};

/// Where a wire cuts the image plane between its ends.
std::optional<Eigen::Vector2d> cut_of(const Wire& wire) {
  const double front = wire.front.z();
  const double back = wire.back.z();
  if (front * back > 0.0 || front == back) return std::nullopt;
  return (wire.front + (wire.back - wire.front) * (front / (front - back))).head<2>();
}

class TargetRecording final : public Recording {
 public:
  TargetRecording(std::string name, RecordingHeader header, Target target)
      : Recording(std::move(name), std::move(header)), target_(std::move(target)), field_(target_.view.beam) {}

  cv::Mat image(int frame) const override {
    require_frame(frame);
    const TargetView& view = target_.view;
    const auto i = static_cast<std::size_t>(frame);
    const Eigen::Affine3d phantom_from_px =
        target_.phantom_from_image[i] *
        Eigen::Affine3d(Eigen::Scaling(view.pixel_mm.x(), view.pixel_mm.y(), view.pixel_mm.mean()));
    const cv::Mat texture = field_.amplitude(phantom_from_px, view.size);
    cv::Mat amplitude = std::pow(10.0, view.beam.tissue_db / 20.0) * texture;
    const TargetInImage seen = target_.seen_in(i);
    for (const Wire& wire : seen.wires) {
      if (const auto cut = cut_of(wire)) add_wire_echo(amplitude, view, *cut, (wire.back - wire.front).normalized());
    }
    if (seen.point_mm) add_point_echo(amplitude, view, *seen.point_mm);
    if (seen.floor) add_floor_echo(amplitude, view, seen.floor->normal(), -seen.floor->offset(), texture);
    cv::Mat image = log_compressed(amplitude, view.beam.dynamic_range_db);
    if (view.fan) blacken_outside_fan(image, view.fan->apex_px, view.fan->face_px, view.fan->half_angle_rad);
    return image;
  }

 private:
  Target target_;
  SpeckleField field_;
};

/// The truth of one frame; whether it shows the whole target.
class FrameTruth {
 public:
  explicit FrameTruth(const TargetView& view) : view_(view), margin_px_(kEchoReach_mm / view.pixel_mm.minCoeff()) {}

  bool add(const TargetInImage& seen, int frame, std::vector<TruePoint>& points) const {
    bool whole = true;
    for (const Wire& wire : seen.wires) {
      const auto cut = cut_of(wire);
      whole = (cut && add_point(frame, wire.name, *cut, points)) && whole;
    }
    if (seen.point_mm) {
      const bool in_beam = std::abs(seen.point_mm->z()) < kBeamReach * view_.beam.elevation_mm;
      whole = in_beam && add_point(frame, "point", seen.point_mm->head<2>(), points);
    }
    if (seen.floor) whole = add_floor(*seen.floor, frame, points);
    return whole;
  }

 private:
  bool add_point(int frame, const std::string& name, const Eigen::Vector2d& x_mm,
                 std::vector<TruePoint>& points) const {
    const Eigen::Vector2d x_px = x_mm.cwiseQuotient(view_.pixel_mm);
    if (shows(view_, x_px, 0.0)) points.push_back({frame, name, x_px});
    return shows(view_, x_px, margin_px_);
  }

  bool add_floor(const Eigen::Hyperplane<double, 3>& floor, int frame, std::vector<TruePoint>& points) const {
    const Eigen::Vector2d across = floor.normal().head<2>().cwiseProduct(view_.pixel_mm);
    if (!(std::abs(across.y()) > 0.0)) return false;
    const auto row_of = [&](double column) { return -(floor.offset() + across.x() * column) / across.y(); };
    int columns = 0;
    for (int x = 0; x < view_.size.width; ++x) columns += shows(view_, {x, row_of(x)}, 0.0) ? 1 : 0;
    if (columns < kLeastFloorSeen * view_.size.width) return false;
    const int last = view_.size.width - 1;
    points.push_back({frame, "left", {0.0, row_of(0)}});
    points.push_back({frame, "right", {static_cast<double>(last), row_of(last)}});
    return true;
  }

  const TargetView& view_;
  double margin_px_;
};

nlohmann::ordered_json frames_marked(const std::vector<bool>& marked) {
  auto frames = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (marked[i]) frames.push_back(i);
  }
  return frames;
}

}  // namespace

void TargetScanOptions::check() const {
  require_choice("object", object, target_names());
  require_choice("pattern", pattern, target_pattern_names());
  require_choice("probe", probe, probe_names());
  require_within("number of frames", frames, 1, SimulateOptions::kMaxFrames, "frames");
  require_within("distance", away_mm, 0.0, kMaxShift_mm, "mm");
  if (object == "wires") require_usable(phantom);
  TrackerOptions::check();
}

std::vector<std::string> target_names() { return {"wires", "wall", "point"}; }
std::vector<std::string> target_pattern_names() { return {"calibrate", "floor", "still"}; }
std::vector<std::string> probe_names() { return {"linear", "curvilinear"}; }

SimulatedTargetScan simulate_target(const TargetScanOptions& options) {
  options.check();
  const TargetSetting setting = target_setting(options);
  const TargetMotion motion(setting.sway, setting.anchor_mm, setting.anchor_sways, options.pattern == "floor",
                            random_stream(options.seed, Stream::kHand));
  Target target{options.object, {}, setting.view, {}};
  for (const NPattern& pattern : options.phantom.patterns) {
    if (options.object == "wires") target.wires.insert(target.wires.end(), pattern.begin(), pattern.end());
  }
  SimulatedTargetScan scan;
  scan.calibration = simulated_calibration(setting.view.pixel_mm, setting.view.size, options.latency_s);
  scan.reference_from_phantom = options.phantom.reference_from_phantom && options.object == "wires"
                                    ? *options.phantom.reference_from_phantom
                                    : simulated_reference_from_phantom();
  const auto phantom_from_image = [&](double time_s) {
    Eigen::Isometry3d bath_from_image = motion.bath_from_image(options.pattern == "still" ? 0.0 : time_s);
    bath_from_image.translation().z() += options.away_mm;
    return Eigen::Isometry3d(setting.phantom_from_bath * bath_from_image);
  };
  const Eigen::Isometry3d tracker_from_phantom = simulated_tracker_from_reference() * scan.reference_from_phantom;
  const Eigen::Affine3d mm_from_px(
      Eigen::Scaling(setting.view.pixel_mm.x(), setting.view.pixel_mm.y(), setting.view.pixel_mm.mean()));
  const Eigen::Affine3d image_from_probe = mm_from_px * scan.calibration.probe_from_image.inverse();
  std::vector<double> times_s;
  std::vector<Eigen::Isometry3d> tracker_from_probe;
  const FrameTruth truth(target.view);
  for (int frame = 0; frame < options.frames; ++frame) {
    const double time_s = frame / kFrameRate_hz;
    times_s.push_back(kFirstTime_s + time_s);
    target.phantom_from_image.push_back(phantom_from_image(time_s));
    const Eigen::Isometry3d seen = phantom_from_image(time_s - options.latency_s);
    tracker_from_probe.emplace_back((tracker_from_phantom.matrix() * seen.matrix() * image_from_probe.matrix()).eval());
    if (truth.add(target.seen_in(static_cast<std::size_t>(frame)), frame, scan.points)) ++scan.frames_in_view;
  }
  if (scan.frames_in_view == 0) {
    throw Error("simulate: none of the " + std::to_string(options.frames) + " frames shows the whole " +
                (options.object == "wall" ? "floor" : options.object) +
                "; choose a pattern and a distance that keep it in view");
  }
  TrackedPoses tracked = track(std::move(times_s), std::move(tracker_from_probe), options);
  RecordingHeader header = tracked_header(tracked, target.view.size.width, target.view.size.height);
  scan.wrong = std::move(tracked.wrong);
  scan.lost = std::move(tracked.lost);
  scan.recording = std::make_unique<TargetRecording>("sim:" + options.object + "/" + options.pattern, std::move(header),
                                                     std::move(target));
  return scan;
}

std::string truth_json(const SimulatedTargetScan& scan, const TargetScanOptions& options) {
  nlohmann::ordered_json json;
  json["fathom_truth"] = 1;
  json["object"] = options.object;
  json["pattern"] = options.pattern;
  json["probe"] = options.probe;
  json["frames"] = options.frames;
  json["seed"] = options.seed;
  json["calibration"] = nlohmann::ordered_json::parse(calibration_json(scan.calibration));
  json["latency_s"] = options.latency_s;
  auto& place = json["phantom_to_reference"] = nlohmann::ordered_json::array();
  for (int i = 0; i < 16; ++i) place.push_back(scan.reference_from_phantom.matrix()(i / 4, i % 4));
  json["noise_mm"] = options.noise_mm;
  json["noise_deg"] = options.noise_deg;
  json["frames_in_view"] = scan.frames_in_view;
  json["outliers"] = options.outliers;
  json["dropouts"] = options.dropouts;
  json["wrong_frames"] = frames_marked(scan.wrong);
  json["lost_frames"] = frames_marked(scan.lost);
  auto& points = json["points"] = nlohmann::ordered_json::array();
  for (const TruePoint& point : scan.points) {
    points.push_back(
        {{"frame", point.frame}, {"name", point.name}, {"x", point.position_px.x()}, {"y", point.position_px.y()}});
  }
  return json.dump(1, ' ') + "\n";
}

}  // namespace fathom
