#include <algorithm>
#include <iostream>
#include <memory>

#include "acquisition/recording.h"
#include "cli/calibrate.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/text_file.h"
#include "registration/calibration.h"
#include "registration/temporal_motion.h"

namespace fathom {

namespace {

struct TemporalCommand {
  std::string image;
  std::string tracker;
  std::string calibration;
  std::string out;
  FrameNames names;
  TemporalOptions fit;
  bool json = false;
};

std::string verdict(const TemporalCalibration& fit) {
  constexpr double kGood_s = 0.002;  // a probe moved at 50 mm/s is 0.1 mm farther then
  constexpr double kGoodCorrelation = 0.98;
  std::string text;
  if (fit.stddev_s > kGood_s) text += ", move the probe faster and for longer to know it better";
  if (fit.correlation < kGoodCorrelation) text += ", move the probe straight up and down, without tilting it";
  return (text.empty() ? "good" : "usable") + text;
}

nlohmann::ordered_json results(const TemporalCalibration& fit) {
  return {{"latency_s", fit.latency_s}, {"stddev_s", fit.stddev_s}, {"correlation", fit.correlation}};
}

/// Another latency makes what is known of one that was fitted with the rest wrong.
Calibration with_latency(Calibration calibration, double latency_s) {
  const auto& parameters = calibration.parameters;
  if (std::find(parameters.begin(), parameters.end(), "latency_s") != parameters.end()) {
    calibration.parameters.clear();
    calibration.covariance.resize(0, 0);
  }
  calibration.latency_s = latency_s;
  return calibration;
}

void run(const TemporalCommand& command) {
  std::optional<Calibration> calibration;
  if (!command.calibration.empty()) calibration = read_calibration(command.calibration, command.names.probe);
  const auto image = open_recording(command.image);
  const auto tracker = command.tracker.empty() ? nullptr : open_recording(command.tracker);
  const Recording& tracked = tracker ? *tracker : *image;
  const ProbePoses poses = probe_poses(tracked, find_pose_chain(tracked, command.names));
  const Signal depth = floor_signal(*image, detect_wall(*image, {}, progress_bar("looking for the floor")));
  const TemporalCalibration fit = find_latency(depth, poses, command.fit);
  if (!command.out.empty()) {
    nlohmann::ordered_json document{{"fathom_latency", 1}};
    document.update(results(fit));
    write_text_file(command.out, calibration ? calibration_json(with_latency(*calibration, fit.latency_s))
                                             : document.dump(1, ' ') + "\n");
  }
  if (command.json) {
    nlohmann::ordered_json json = results(fit);
    json["px_per_mm"] = fit.px_per_mm;
    json["rms_px"] = fit.rms_px;
    json["frames_used"] = fit.frames_used;
    json["frames_with_floor"] = fit.frames_seen;
    json["verdict"] = verdict(fit);
    print_json(json);
    return;
  }
  std::cout << "the tracker's stamps are " << (fit.latency_s < 0.0 ? "early" : "late") << " by "
            << number_text(1e3 * std::abs(fit.latency_s), 1) << " ms, standard deviation "
            << number_text(1e3 * fit.stddev_s, 1) << " ms\n"
            << "correlation " << number_text(fit.correlation, 4) << "; the floor lies within "
            << number_text(fit.rms_px, 1) << " pixels (rms) of where the tracker expects it, in " << fit.frames_used
            << " of " << fit.frames_seen << " frames that show it\n"
            << "verdict: " << verdict(fit) << "\n";
}

}  // namespace

void add_calibrate_temporal(CLI::App& calibrate) {
  auto options = std::make_shared<TemporalCommand>();
  CLI::App* command = calibrate.add_subcommand(
      "temporal", "Find how late the tracker's time stamps are, from a probe moved up and down over a flat floor");
  command->add_option("--image", options->image, "Recording with the images of the floor")->required();
  command->add_option("--tracker", options->tracker, "Recording with the probe's poses (default: that of the images)");
  CLI::Option* out = command->add_option("--out", options->out, "Where the latency is written, as JSON");
  command->add_option("--calibration", options->calibration, "A calibration; --out becomes the same with this latency")
      ->needs(out);
  command->add_option("--max-latency-s", options->fit.max_latency_s, "Latencies beyond, either way, are not looked for")
      ->check(between(0.01, 10))
      ->capture_default_str();
  add_frame_names(*command, options->names);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
