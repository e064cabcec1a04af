#include <ctime>
#include <iostream>
#include <memory>

#include "cli/calibrate.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "exam/calibration_picture.h"
#include "exam/report_picture.h"
#include "registration/calibration_scan.h"
#include "registration/calibration_verdict.h"

namespace fathom {

namespace {

struct SpatialCommand {
  std::string recording;
  std::string validation;
  std::string phantom;
  std::string out;
  std::string picture;
  FrameNames names;
  ScanFitOptions fit;
  std::optional<double> water_celsius;
  double face_row_px = 0.0;
  std::optional<double> depth_mm;
  std::string probe;
  bool no_latency = false;
  bool no_skew = false;
  bool json = false;
};

struct Calibrated {
  CalibrationPhantom phantom;
  CalibrationScan scan;
  SpatialFit fit;
  Calibration calibration;
  TargetErrors own;
  std::optional<ScanErrors> validation;
  CalibrationVerdict verdict;
};

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  char text[16];
  std::strftime(text, sizeof text, "%Y-%m-%d", &utc);
  return text;
}

Calibration calibration_file(const SpatialCommand& command, const PoseChain& chain, const CalibrationScan& scan,
                             const SpatialFit& fit) {
  Calibration calibration = calibration_of(fit);
  calibration.probe_frame = chain.probe;
  calibration.reference_frame = chain.reference;
  calibration.image_size = scan.image_size;
  calibration.depth_mm = command.depth_mm;
  calibration.probe = command.probe;
  calibration.date = today();
  return calibration;
}

ScanErrors validated(const SpatialCommand& command, const CalibrationPhantom& phantom,
                     const CalibrationScanOptions& options, const CalibrationScan& calibrated, const SpatialFit& fit) {
  const auto recording = open_recording(command.validation);
  CalibrationScan scan = scan_phantom(*recording, find_pose_chain(*recording, command.names), phantom, options,
                                      progress_bar("looking at the second sweep"));
  if (scan.image_size != calibrated.image_size) {
    throw Error(command.validation + ": has images of another size than " + command.recording +
                "; validate with a sweep of the same probe at the same depth");
  }
  return scan_errors(scan, phantom, fit.state);
}

Calibrated calibrate(const SpatialCommand& command) {
  CalibrationPhantom phantom = calibration_phantom(command.phantom, command.names.reference);
  const auto recording = open_recording(command.recording);
  const PoseChain chain = find_pose_chain(*recording, command.names);
  CalibrationScanOptions options;
  if (command.water_celsius) options.depth = water_correction(*command.water_celsius, command.face_row_px);
  CalibrationScan scan = scan_phantom(*recording, chain, phantom, options, progress_bar("looking for the phantom"));
  ScanFitOptions allowed = command.fit;
  allowed.try_latency = !command.no_latency;
  allowed.try_skew = !command.no_skew;
  SpatialFit fit = calibrate_scan(scan, phantom, allowed);
  if (scan.wire_0_left) options.wire_0_left = scan.wire_0_left;
  std::optional<ScanErrors> validation;
  if (!command.validation.empty()) validation = validated(command, phantom, options, scan, fit);
  Calibration calibration = calibration_file(command, chain, scan, fit);
  const TargetErrors own = scan_errors(scan, phantom, fit.state);
  const CalibrationVerdict verdict = verdict_on(fit, scan, phantom.target, validation);
  return {std::move(phantom), std::move(scan), std::move(fit), std::move(calibration), own, validation, verdict};
}

void write_files(const SpatialCommand& command, const Calibrated& made) {
  AtomicFile file(command.out);
  file.write(calibration_json(made.calibration));
  if (command.picture.empty()) {
    file.commit();
    return;
  }
  AtomicFile picture(command.picture);
  write_png(calibration_picture(made.scan, residuals(made.scan, made.phantom, made.fit.state),
                                {"verdict: " + made.verdict.text}),
            picture);
  AtomicFile::commit_all({&picture, &file});
}

std::vector<double> deviations(const Calibration& calibration) {
  const Eigen::VectorXd sd = calibration.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return {sd.begin(), sd.end()};
}

nlohmann::ordered_json number_or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

void print_calibration_json(const Calibrated& made) {
  nlohmann::ordered_json json;
  auto& numbers = json["image_to_probe"] = nlohmann::ordered_json::array();
  for (int i = 0; i < 16; ++i) numbers.push_back(made.calibration.probe_from_image.matrix()(i / 4, i % 4));
  json["latency_s"] = made.calibration.latency_s;
  json["rms_mm"] = made.fit.rms_mm;
  json["mean_mm"] = made.own.mean_mm;
  const auto& validation = made.validation;
  const auto of = [&](double TargetErrors::*member) {
    return number_or_null(validation ? std::optional((*validation).*member) : std::nullopt);
  };
  json["validation_mean_mm"] = of(&TargetErrors::mean_mm);
  json["validation_mean_all_mm"] = of(&TargetErrors::mean_all_mm);
  json["validation_rms_mm"] = of(&TargetErrors::rms_mm);
  json["validation_max_mm"] = of(&TargetErrors::max_mm);
  json["validation_wire_mean_mm"] = number_or_null(validation ? validation->wire_mean_mm : std::nullopt);
  json["validation_wire_rms_mm"] = number_or_null(validation ? validation->wire_rms_mm : std::nullopt);
  json["validation_frames"] = validation ? nlohmann::ordered_json(validation->frames) : nlohmann::ordered_json(nullptr);
  json["parameters"] = made.calibration.parameters;
  json["stddev"] = deviations(made.calibration);
  json["point_stddev_mm"] = made.fit.worst_point_sd_mm;
  json["frames_used"] = made.fit.frames_used;
  json["frames_with_phantom"] = made.scan.frames_with_target;
  json["verdict"] = made.verdict.text;
  print_json(json);
}

void print_calibration(const Calibrated& made) {
  const std::vector<double> sd = deviations(made.calibration);
  const auto deviation_of = [&](const char* name, double factor, int decimals) {
    for (std::size_t i = 0; i < sd.size(); ++i) {
      if (made.calibration.parameters[i] == name) return number_text(factor * sd[i], decimals);
    }
    return std::string("not fitted");
  };
  const SpatialState& state = made.fit.state;
  constexpr double kUm = 1e3;
  const double sx_um = kUm * std::exp(state.log_sx);
  const double sy_um = kUm * std::exp(state.log_sy);
  print_table(
      {{"calibration", "value", "standard deviation"},
       {"place of the first pixel, x (mm)", number_text(state.translation_mm.x(), 3), deviation_of("tx_mm", 1.0, 3)},
       {"place of the first pixel, y (mm)", number_text(state.translation_mm.y(), 3), deviation_of("ty_mm", 1.0, 3)},
       {"place of the first pixel, z (mm)", number_text(state.translation_mm.z(), 3), deviation_of("tz_mm", 1.0, 3)},
       {"width of a pixel (um)", number_text(sx_um, 2), deviation_of("log_sx", sx_um, 2)},
       {"height of a pixel (um)", number_text(sy_um, 2), deviation_of("log_sy", sy_um, 2)},
       {"latency (ms)", number_text(1e3 * state.latency_s, 1), deviation_of("latency_s", 1e3, 1)}});
  std::cout << made.fit.frames_used << " of " << made.fit.frames_seen << " frames that show the phantom agree to "
            << number_text(made.fit.rms_mm, 3) << " mm (rms); a pixel's place is known to "
            << number_text(made.fit.worst_point_sd_mm, 3) << " mm or better\n";
  if (const auto& second = made.validation) {
    std::cout << "second sweep: off by " << number_text(second->mean_mm, 3) << " mm (mean of the best 95 %), "
              << number_text(second->mean_all_mm, 3) << " mm (mean), at most " << number_text(second->max_mm, 2)
              << " mm, over " << second->frames << " frames\n";
    if (second->wire_mean_mm) {
      std::cout << "second sweep: " << number_text(second->wire_mean_mm, 3) << " mm from the wires (mean), "
                << number_text(second->wire_rms_mm, 3) << " mm (rms)\n";
    }
  }
  std::cout << "verdict: " << made.verdict.text << "\n";
}

void run(const SpatialCommand& command) {
  const Calibrated made = calibrate(command);
  write_files(command, made);
  (command.json ? print_calibration_json : print_calibration)(made);
}

}  // namespace

void add_calibrate_spatial(CLI::App& calibrate) {
  auto options = std::make_shared<SpatialCommand>();
  CLI::App* command = calibrate.add_subcommand(
      "spatial", "Find where the image lies on the probe, from a sweep over a phantom in a water bath");
  command->add_option("RECORDING", options->recording, "A sweep over the phantom: .mha, .mhd or .nrrd")->required();
  command
      ->add_option("--phantom", options->phantom,
                   "A wire phantom's file (PLUS XML or Fathom's JSON), \"wall\" (a flat floor) or \"point\"")
      ->required();
  command->add_option("--out", options->out, "The calibration to write, as JSON")->required();
  command->add_option("--validate", options->validation, "A second sweep over the same phantom, to test on");
  command->add_option("--picture", options->picture, "Writes where the errors lie: .png")->check(png_name());
  auto* water = command->add_option("--water-temperature-c", options->water_celsius,
                                    "Of the bath: depths are corrected for sound's speed in water, for use in tissue");
  water->check(between(0, 95));
  command->add_option("--face-row", options->face_row_px, "Row of the image at which the transducer's face is, depth 0")
      ->needs(water)
      ->check(finite())
      ->capture_default_str();
  command->add_flag("--estimate-phantom", options->fit.estimate_phantom,
                    "Estimate where the wire phantom stands, though its file states it");
  command->add_flag("--no-latency", options->no_latency, "Fit no latency");
  command->add_flag("--no-skew", options->no_skew, "Fit no skew of the image's axes");
  command->add_option("--max-latency-s", options->fit.max_latency_s, "Latencies beyond, either way, are not looked for")
      ->check(between(0.01, 10))
      ->capture_default_str();
  command->add_option("--depth-mm", options->depth_mm, "Depth set at the scanner, kept in the file")->check(above(0));
  command->add_option("--probe", options->probe, "Name of the probe, kept in the file");
  add_frame_names(*command, options->names);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
