#include "sim/simulate.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "sim/choice.h"
#include "sim/phantom.h"
#include "sim/probe_motion.h"
#include "sim/scan_plan.h"
#include "sim/section.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
constexpr double kMm2PerCm2 = 100.0;
constexpr double kTouch_mm = 1e-6;    // planes of contact touch to 1e-9 mm
constexpr int kFramesPerReport = 64;  // outlined in some tenths of a second

class SimulatedRecording final : public Recording {
 public:
  SimulatedRecording(std::string name, RecordingHeader header, Phantom phantom,
                     std::vector<Eigen::Affine3d> phantom_from_image, std::optional<SpeckleOptions> speckle)
      : Recording(std::move(name), std::move(header)),
        phantom_(std::move(phantom)),
        phantom_from_image_(std::move(phantom_from_image)),
        speckle_(std::move(speckle)) {
    if (!speckle_) return;
    if (phantom_.bodies.empty()) {
      field_.emplace(*speckle_);
    } else {
      scene_.emplace(phantom_.bodies, speckle_->seed);
    }
  }

  cv::Mat image(int frame) const override {
    require_frame(frame);
    const Eigen::Affine3d& phantom_from_image = phantom_from_image_[static_cast<std::size_t>(frame)];
    const cv::Size size(header().width, header().height);
    if (scene_) return scene_->image(phantom_from_image, size);
    const cv::Mat inside = section_image(*phantom_.solid, phantom_from_image, size);
    return field_ ? speckled_image(*field_, *speckle_, inside, phantom_from_image) : inside;
  }

 private:
  Phantom phantom_;
  std::vector<Eigen::Affine3d> phantom_from_image_;
  std::optional<SpeckleOptions> speckle_;
  std::optional<SpeckleField> field_;
  std::optional<Scene> scene_;
};

/// Of every frame, the point at which its plane touches the object from outside, if it does.
std::vector<std::optional<Eigen::Vector3d>> touching_points(const ScanPlan& plan, const ProbeMotion& motion) {
  std::vector<std::optional<Eigen::Vector3d>> points(motion.phantom_from_image.size());
  for (std::size_t i = 0; i < plan.sweeps.size(); ++i) {
    const Sweep& sweep = motion.sweeps[i];
    if (frame_count(sweep) == 1) continue;
    points[static_cast<std::size_t>(sweep.first)] = plan.sweeps[i].first_touch_mm;
    points[static_cast<std::size_t>(sweep.last)] = plan.sweeps[i].last_touch_mm;
  }
  return points;
}

std::vector<Contour> outlines_of_plane(const Solid& solid, const ScanPlan& plan,
                                       const Eigen::Affine3d& phantom_from_image) {
  if (plan.cuts_off) return image_outlines(solid, phantom_from_image, plan.image_size);
  std::vector<Contour> contours;
  for (Polygon& outline : section_outlines(solid, phantom_from_image)) {
    contours.emplace_back().points_px = std::move(outline);
  }
  return contours;
}

Structure true_outlines(const PhantomPart& part, const ScanPlan& plan, const ProbeMotion& motion, bool steady,
                        const Progress& progress) {
  const int count = static_cast<int>(motion.phantom_from_image.size());
  std::vector<std::optional<Eigen::Vector3d>> touches(motion.phantom_from_image.size());
  if (steady) touches = touching_points(plan, motion);  // an unsteady plane cuts or misses
  for (auto& touch : touches) {
    if (touch && part.solid->distance_bound_mm(*touch) > kTouch_mm)
      touch.reset();  // it is another part that is touched
  }
  std::vector<std::vector<Contour>> outlines(static_cast<std::size_t>(count));
  for (int first = 0; first < count; first += kFramesPerReport) {
    report(progress, static_cast<double>(first) / count);
    cv::parallel_for_(cv::Range(first, std::min(count, first + kFramesPerReport)), [&](const cv::Range& range) {
      for (int frame = range.start; frame < range.end; ++frame) {
        const auto i = static_cast<std::size_t>(frame);
        if (!touches[i]) outlines[i] = outlines_of_plane(*part.solid, plan, motion.phantom_from_image[i]);
      }
    });
  }
  report(progress, 1.0);

  Structure structure;
  structure.name = part.name;
  for (int frame = 0; frame < count; ++frame) {
    const auto i = static_cast<std::size_t>(frame);
    if (touches[i]) {
      const Eigen::Vector3d x_in_image_px = motion.phantom_from_image[i].inverse() * *touches[i];
      structure.extremities.push_back({frame, x_in_image_px.head<2>()});
    } else if (outlines[i].empty()) {
      structure.absent.push_back({frame});
    }
    for (Contour& outline : outlines[i]) {
      outline.frame = frame;
      structure.contours.push_back(std::move(outline));
    }
  }
  return structure;
}

}  // namespace

void SimulateOptions::check() const {
  require_choice("object", object, object_names());
  require_choice("pattern", pattern, pattern_names());
  require_within("number of frames", frames, 1, SimulateOptions::kMaxFrames, "frames");
  require_within("jitter", jitter_mm, 0.0, kMaxShift_mm, "mm");
  require_within("jitter", jitter_deg, 0.0, kMaxTurn_deg, "degrees");
  require_within("misregistration", misregister_mm, 0.0, kMaxShift_mm, "mm");
  require_within("misregistration", misregister_deg, 0.0, kMaxTurn_deg, "degrees");
  TrackerOptions::check();
  if (speckle) speckle->check();
}

SimulatedScan simulate(const SimulateOptions& options, const Progress& progress) {
  options.check();
  return simulate_phantom(make_phantom(options.object), options, progress);
}

SimulatedScan simulate_phantom(const Phantom& phantom, const SimulateOptions& options, const Progress& progress) {
  options.check();
  const ScanPlan plan = make_scan_plan(phantom, options.pattern);

  SimulatedScan scan;
  scan.calibration = simulated_calibration(phantom.pixel_mm, plan.image_size, options.latency_s);
  ProbeMotion motion = move_probe(plan, phantom, scan.calibration, options);
  const bool steady = options.steady_ends || (options.jitter_mm == 0.0 && options.jitter_deg == 0.0);
  bool seen = false;
  for (const PhantomPart& part : phantom.parts) {
    scan.outlines.push_back(true_outlines(part, plan, motion, steady, progress));
    seen = seen || !scan.outlines.back().contours.empty() || !scan.outlines.back().extremities.empty();
    scan.truth.structures.push_back({part.name, part.solid->volume_mm3() / kMm3PerMl});
  }
  if (!seen) {
    throw Error("simulate: none of the " + std::to_string(options.frames) + " frames shows the " + phantom.name +
                "; disturb the probe's way less");
  }
  scan.truth.volume_ml = phantom.solid->volume_mm3() / kMm3PerMl;
  scan.truth.surface_area_cm2 = phantom.solid->area_mm2() / kMm2PerCm2;
  RecordingHeader header = tracked_header(motion.tracked, plan.image_size.width, plan.image_size.height);
  std::optional<SpeckleOptions> speckle = options.speckle;
  if (speckle) speckle->seed = options.seed;
  scan.recording =
      std::make_unique<SimulatedRecording>("sim:" + phantom.name + "/" + options.pattern, std::move(header), phantom,
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
  json["outliers"] = options.outliers;
  json["dropouts"] = options.dropouts;
  return json.dump(1, ' ') + "\n";
}

}  // namespace fathom
