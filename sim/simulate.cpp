#include "sim/simulate.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "sim/choice.h"
#include "sim/phantom.h"
#include "sim/probe_motion.h"
#include "sim/scan_path.h"
#include "sim/section.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
constexpr double kMm2PerCm2 = 100.0;
constexpr int kFramesPerReport = 64;  // outlined in some tenths of a second

void require_within(const char* what, double value, double low, double high, const char* unit) {
  if (value >= low && value <= high) return;  // false for what is not a number
  const auto text = [](double number) { return nlohmann::json(number).dump(); };
  throw Error(std::string("simulate: the ") + what + " cannot be " +
              (std::isfinite(value) ? text(value) : "without a finite value") + "; choose from " + text(low) + " to " +
              text(high) + " " + unit);
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

class SimulatedRecording final : public Recording {
 public:
  SimulatedRecording(std::string name, RecordingHeader header, Phantom phantom,
                     std::vector<Eigen::Affine3d> phantom_from_image, std::optional<SpeckleOptions> speckle)
      : Recording(std::move(name), std::move(header)),
        phantom_(std::move(phantom)),
        phantom_from_image_(std::move(phantom_from_image)),
        speckle_(std::move(speckle)) {
    if (speckle_) field_.emplace(*speckle_);
  }

  cv::Mat image(int frame) const override {
    require_frame(frame);
    const Eigen::Affine3d& phantom_from_image = phantom_from_image_[static_cast<std::size_t>(frame)];
    const cv::Mat inside = section_image(*phantom_.solid, phantom_from_image, kImageSize);
    return field_ ? speckled_image(*field_, *speckle_, inside, phantom_from_image) : inside;
  }

 private:
  Phantom phantom_;
  std::vector<Eigen::Affine3d> phantom_from_image_;
  std::optional<SpeckleOptions> speckle_;
  std::optional<SpeckleField> field_;
};

RecordingHeader recorded_header(const ProbeMotion& motion) {
  RecordingHeader header;
  header.width = kImageSize.width;
  header.height = kImageSize.height;
  header.pixel_type = CV_8UC1;
  header.transforms = {"ProbeToTracker", "ReferenceToTracker"};
  for (std::size_t i = 0; i < motion.times_s.size(); ++i) {
    FrameHeader frame;
    frame.time_s = motion.times_s[i];
    frame.image_status = "OK";
    frame.poses = {Pose{motion.tracker_from_probe[i].matrix(), "OK"},
                   Pose{motion.tracker_from_reference.matrix(), "OK"}};
    header.frames.push_back(std::move(frame));
  }
  return header;
}

Structure true_outlines(const Phantom& phantom, const ScanPath& path, const ProbeMotion& motion, bool steady,
                        const Progress& progress) {
  const int count = static_cast<int>(motion.times_s.size());
  const auto touch_of = [&](int frame) -> const Contact* {
    // An unsteady plane cuts or misses; a plane that lies in a flat face sees the face.
    if (!steady || count == 1) return nullptr;
    if (frame == 0 && !path.first_contact.on_face) return &path.first_contact;
    if (frame == count - 1 && !path.last_contact.on_face) return &path.last_contact;
    return nullptr;
  };
  std::vector<std::vector<Polygon>> outlines(static_cast<std::size_t>(count));
  for (int first = 0; first < count; first += kFramesPerReport) {
    report(progress, static_cast<double>(first) / count);
    cv::parallel_for_(cv::Range(first, std::min(count, first + kFramesPerReport)), [&](const cv::Range& range) {
      for (int frame = range.start; frame < range.end; ++frame) {
        if (touch_of(frame) != nullptr) continue;
        const auto i = static_cast<std::size_t>(frame);
        outlines[i] = section_outlines(*phantom.solid, motion.phantom_from_image[i]);
      }
    });
  }
  report(progress, 1.0);

  Structure structure;
  structure.name = phantom.name;
  for (int frame = 0; frame < count; ++frame) {
    const auto i = static_cast<std::size_t>(frame);
    if (const Contact* contact = touch_of(frame)) {
      const Eigen::Vector3d x_in_image_px = motion.phantom_from_image[i].inverse() * contact->point_mm;
      structure.extremities.push_back({frame, x_in_image_px.head<2>()});
    } else if (outlines[i].empty()) {
      structure.absent.push_back({frame});
    }
    for (Polygon& outline : outlines[i]) {
      Contour contour;
      contour.frame = frame;
      contour.points_px = std::move(outline);
      structure.contours.push_back(std::move(contour));
    }
  }
  return structure;
}

}  // namespace

void SimulateOptions::check() const {
  if (!contains(object_names(), object)) refuse_choice("object", object, object_names());
  if (!contains(pattern_names(), pattern)) refuse_choice("pattern", pattern, pattern_names());
  require_within("number of frames", frames, 1, SimulateOptions::kMaxFrames, "frames");
  require_within("jitter", jitter_mm, 0.0, kMaxShift_mm, "mm");
  require_within("jitter", jitter_deg, 0.0, kMaxTurn_deg, "degrees");
  require_within("misregistration", misregister_mm, 0.0, kMaxShift_mm, "mm");
  require_within("misregistration", misregister_deg, 0.0, kMaxTurn_deg, "degrees");
  require_within("tracker noise", noise_mm, 0.0, kMaxShift_mm, "mm");
  require_within("tracker noise", noise_deg, 0.0, kMaxTurn_deg, "degrees");
  require_within("latency", latency_s, -kMaxLatency_s, kMaxLatency_s, "seconds");
  if (speckle) speckle->check();
}

SimulatedScan simulate(const SimulateOptions& options, const Progress& progress) {
  options.check();
  const Phantom phantom = make_phantom(options.object);
  const ScanPath path = make_scan_path(phantom, options.pattern);

  SimulatedScan scan;
  scan.calibration = simulated_calibration(phantom, options.latency_s);
  ProbeMotion motion = move_probe(path, phantom, scan.calibration, options);
  const bool steady = options.jitter_mm == 0.0 && options.jitter_deg == 0.0;
  scan.outlines = {true_outlines(phantom, path, motion, steady, progress)};
  scan.truth.volume_ml = phantom.solid->volume_mm3() / kMm3PerMl;
  scan.truth.surface_area_cm2 = phantom.solid->area_mm2() / kMm2PerCm2;
  scan.truth.structures = {{phantom.name, scan.truth.volume_ml}};
  RecordingHeader header = recorded_header(motion);
  std::optional<SpeckleOptions> speckle = options.speckle;
  if (speckle) speckle->seed = options.seed;
  scan.recording =
      std::make_unique<SimulatedRecording>("sim:" + options.object + "/" + options.pattern, std::move(header), phantom,
                                           std::move(motion.phantom_from_image), std::move(speckle));
  return scan;
}

std::string truth_json(const SimulatedScan& scan, const SimulateOptions& options) {
  nlohmann::ordered_json json;
  json["fathom_truth"] = 1;
  json["object"] = options.object;
  json["pattern"] = options.pattern;
  json["frames"] = options.frames;
  json["seed"] = options.seed;
  json["volume_ml"] = scan.truth.volume_ml;
  json["surface_area_cm2"] = scan.truth.surface_area_cm2;
  json["structures"] = nlohmann::ordered_json::array();
  for (const SimulatedTruth::StructureTruth& structure : scan.truth.structures) {
    json["structures"].push_back({{"name", structure.name}, {"volume_ml", structure.volume_ml}});
  }
  json["calibration"] = nlohmann::ordered_json::parse(calibration_json(scan.calibration));
  json["latency_s"] = options.latency_s;
  json["jitter_mm"] = options.jitter_mm;
  json["jitter_deg"] = options.jitter_deg;
  json["misregister_mm"] = options.misregister_mm;
  json["misregister_deg"] = options.misregister_deg;
  json["noise_mm"] = options.noise_mm;
  json["noise_deg"] = options.noise_deg;
  return json.dump(1, ' ') + "\n";
}

}  // namespace fathom
