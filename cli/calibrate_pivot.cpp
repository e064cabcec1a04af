#include <iostream>
#include <memory>

#include "acquisition/recording.h"
#include "cli/calibrate.h"
#include "cli/options.h"
#include "cli/output.h"
#include "registration/pivot_calibration.h"

namespace fathom {

namespace {

struct PivotCommand {
  std::string recording;
  FrameNames names;
  PivotOptions fit;
  bool json = false;
};

std::string verdict(const PivotCalibration& fit) {
  constexpr double kGoodMm = 0.3;  // trackers place a sensor no better
  constexpr double kGoodRmsMm = 1.0;
  constexpr double kFewLeftOut = 0.9;
  std::string text;
  if (fit.tip_sd_mm().maxCoeff() > kGoodMm) text += ", tilt the tool farther and record for longer to know it better";
  if (fit.rms_mm > kGoodRmsMm) text += ", the tip seems loose in its dimple or the sensor on the tool";
  if (fit.poses_used < kFewLeftOut * fit.poses_valid) {
    text +=
        ", " + std::to_string(fit.poses_valid - fit.poses_used) + " poses were left out, so the tip may have slipped";
  }
  return (text.empty() ? "good" : "usable") + text;
}

void run(const PivotCommand& command) {
  const auto recording = open_recording(command.recording);
  const ProbePoses poses = probe_poses(*recording, find_pose_chain(*recording, command.names));
  const PivotCalibration fit = calibrate_pivot(poses, command.fit);
  const Eigen::Vector3d sd = fit.tip_sd_mm();
  if (command.json) {
    nlohmann::ordered_json json;
    json["tip_mm"] = std::vector<double>(fit.tip_in_tool_mm.begin(), fit.tip_in_tool_mm.end());
    json["stddev_mm"] = std::vector<double>(sd.begin(), sd.end());
    json["pivot_mm"] = std::vector<double>(fit.pivot_in_reference_mm.begin(), fit.pivot_in_reference_mm.end());
    json["rms_mm"] = fit.rms_mm;
    json["max_mm"] = fit.max_mm;
    json["tilt_deg"] = fit.tilt_deg;
    json["poses_used"] = fit.poses_used;
    json["poses_valid"] = fit.poses_valid;
    json["verdict"] = verdict(fit);
    print_json(json);
    return;
  }
  print_table({{"tip of " + *command.names.probe, "x", "y", "z"},
               {"place (mm)", number_text(fit.tip_in_tool_mm.x(), 3), number_text(fit.tip_in_tool_mm.y(), 3),
                number_text(fit.tip_in_tool_mm.z(), 3)},
               {"standard deviation (mm)", number_text(sd.x(), 3), number_text(sd.y(), 3), number_text(sd.z(), 3)}});
  std::cout << "the tip stayed within " << number_text(fit.rms_mm, 3) << " mm (rms; at most "
            << number_text(fit.max_mm, 2) << " mm) over " << fit.poses_used << " of " << fit.poses_valid
            << " poses, tilted by " << number_text(fit.tilt_deg, 0) << " degrees (rms)\n"
            << "verdict: " << verdict(fit) << "\n";
}

}  // namespace

void add_calibrate_pivot(CLI::App& calibrate) {
  auto options = std::make_shared<PivotCommand>();
  options->names.probe = "Stylus";
  CLI::App* command =
      calibrate.add_subcommand("pivot", "Find a pointer's tip from a recording of it pivoting about its tip");
  command->add_option("RECORDING", options->recording, "A .mha, .mhd or .nrrd sequence; images are not needed")
      ->required();
  command->add_option("--tool,--probe-frame", options->names.probe, "Name of the tool's coordinates in the recording")
      ->capture_default_str();
  command->add_option("--reference-frame", options->names.reference,
                      "Name of the coordinates in which the tip rests (default: Reference, else Tracker)");
  command->add_option("--max-rms-mm", options->fit.max_rms_mm, "A tip that moves by more is refused")
      ->check(above(0))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
