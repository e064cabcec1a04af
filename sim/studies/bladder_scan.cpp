#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "measurement/contour_surface.h"
#include "measurement/planimetry.h"
#include "segmentation/outline_loops.h"
#include "sim/studies/bladder_study.h"

namespace fathom {

namespace {

constexpr int kFrames = 69;
constexpr int kEvery = 4;  // frames from one outline to the next: 16 outlines and the two ends; published: 15 to 20
constexpr double kLeastArea_px = 300.0;  // smaller sections are not outlined
constexpr double kWantedDice = 0.98;     // of an outline that is followed by wire
constexpr double kJitter_mm = 0.5;       // of the hand
constexpr double kJitter_deg = 0.5;
constexpr double kNoise_mm = 0.25;  // of the tracker
constexpr double kNoise_deg = 0.15;
constexpr const char* kPattern = "free";

bool is_within(const Polygon& outline, const RecordingHeader& header) {
  constexpr double kMargin_px = 3.0;
  return std::all_of(outline.begin(), outline.end(), [&](const Eigen::Vector2d& p) {
    return p.minCoeff() > kMargin_px && p.x() < header.width - kMargin_px && p.y() < header.height - kMargin_px;
  });
}

}  // namespace

BladderScan scan_bladder(const BladderPatient& patient, std::size_t number, std::uint64_t seed) {
  SimulateOptions options;
  options.object = "bladder";
  options.pattern = kPattern;
  options.frames = kFrames;
  options.seed = seed;
  options.jitter_mm = kJitter_mm;
  options.jitter_deg = kJitter_deg;
  options.steady_ends = true;  // where the bladder just vanishes, the hand waits
  options.noise_mm = kNoise_mm;
  options.noise_deg = kNoise_deg;
  options.speckle.emplace();
  BladderScan result;
  result.scan = simulate_phantom(patient.bladder(patient.volume_ml(kBladderScans_min.at(number))), options);
  const Structure& all = result.scan.outlines.front();
  result.true_outlines.name = all.name;
  result.true_outlines.extremities = all.extremities;
  for (const Contour& contour : all.contours) {
    if (contour.frame % kEvery != 0 || std::abs(signed_area(contour.points_px)) < kLeastArea_px) continue;
    if (!is_within(contour.points_px, result.scan.recording->header())) {
      throw Error("the bladder does not fit into the image; choose a larger depth");
    }
    result.true_outlines.contours.push_back(contour);
  }
  return result;
}

OutliningTrial live_wire_outline(const cv::Mat& image, const Contour& truth) {
  OutliningTrial trial = scripted_outline(image, truth.points_px, kWantedDice);
  trial.frame = truth.frame;
  return trial;
}

Structure assisted_outlines(const BladderScan& scan, std::vector<OutliningTrial>* trials) {
  Structure assisted = scan.true_outlines;
  for (Contour& contour : assisted.contours) {
    OutliningTrial trial = live_wire_outline(scan.scan.recording->image(contour.frame), contour);
    contour.points_px = trial.outline_px;
    if (trials != nullptr) trials->push_back(std::move(trial));
  }
  return assisted;
}

std::vector<std::optional<double>> bladder_volumes_ml(const BladderScan& scan, const Structure& outlines) {
  const FrameLocator locator(*scan.scan.recording, scan.scan.calibration);
  const PlanimetryVolumes volumes = measure_planimetry(cross_sections(outlines, locator, nullptr)).volumes;
  ContourSurface surface(locator, {});
  surface.update(outlines);
  return {volumes.linear_ml, volumes.cubic_ml, volumes.quadric_ml, surface.volume_ml()};
}

}  // namespace fathom
