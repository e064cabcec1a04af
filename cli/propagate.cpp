#include "measurement/propagate.h"

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "exam/contact_sheet.h"
#include "exam/report_picture.h"
#include "registration/find_sweeps.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

struct PropagateCommand {
  ScanInput input;
  PropagateOptions propagate;
  std::string structure;
  std::string out;
  std::string picture;
  bool json = false;
};

/// Where frames are, and the sweeps between which nothing is propagated.
struct Placed {
  std::optional<FrameLocator> locator;
  std::vector<Sweep> sweeps;
};

Placed placed(const PropagateCommand& command, const std::optional<Exam>& exam, const Recording& recording) {
  Placed result;
  const bool calibrated = !command.input.calibration.empty() || (exam && !exam->calibration.empty());
  if (calibrated) {
    const Calibration calibration = read_calibration(calibration_file(command.input, exam), command.input.names.probe);
    result.locator.emplace(recording, calibration, command.input.names);
  }
  if (exam) result.sweeps = exam->sweeps;
  if (!result.sweeps.empty()) return result;
  if (calibrated) {
    result.sweeps = find_sweeps(recording, *result.locator);
    return result;
  }
  if (recording.header().transforms.empty()) return result;
  // Without a calibration the path of the probe's own origin is followed: enough to see where it jumps.
  FindSweepsOptions find;
  find.follow_px = Eigen::Vector2d::Zero();
  result.sweeps = find_sweeps(recording, FrameLocator(recording, {}, command.input.names), find);
  return result;
}

nlohmann::ordered_json json_of(const Propagation& result) {
  nlohmann::ordered_json json;
  json["contours"] = result.contours;
  json["confidence"] = nlohmann::ordered_json::array();
  for (const PropagatedFrame& frame : result.frames) {
    json["confidence"].push_back({{"structure", frame.structure},
                                  {"frame", frame.frame},
                                  {"contours", frame.contours},
                                  {"confidence", frame.confidence}});
  }
  json["refused"] = result.refused;
  return json;
}

void print(const Propagation& result, const std::string& out) {
  struct Sum {
    int frames = 0, contours = 0, unsure = 0;
    double confidence = 0.0;
    std::string doubtful;
  };
  std::map<std::string, Sum> sums;
  for (const PropagatedFrame& frame : result.frames) {
    Sum& sum = sums[frame.structure];
    ++sum.frames;
    sum.contours += frame.contours;
    sum.confidence += frame.confidence;
    if (frame.confidence >= kSureContour) continue;
    constexpr int kMostNamed = 30;
    if (sum.unsure < kMostNamed) sum.doubtful += (sum.unsure == 0 ? "" : ", ") + std::to_string(frame.frame);
    if (sum.unsure == kMostNamed) sum.doubtful += ", ...";
    ++sum.unsure;
  }
  std::vector<std::vector<std::string>> rows{{"structure", "frames", "contours", "mean confidence", "below 0.9"}};
  for (const auto& [name, sum] : sums) {
    rows.push_back({name, std::to_string(sum.frames), std::to_string(sum.contours),
                    number_text(sum.confidence / sum.frames, 2), std::to_string(sum.unsure)});
  }
  print_table(rows);
  for (const auto& [name, sum] : sums) {
    if (sum.unsure > 0) std::cout << name << ": look at frames " << sum.doubtful << "\n";
  }
  for (const std::string& why : result.refused) std::cout << "not filled: " << why << "\n";
  std::cout << "added " << result.contours << " contours, to " << out << "\n";
}

void run(PropagateCommand& command) {
  const auto exam = read_if_exam(command.input.recording);
  const auto recording = open_only_recording(command.input.recording, "propagate");
  const std::string file = contours_file(command.input, exam);
  const std::vector<Structure> structures = read_contours(file);
  require_measurable(structures, recording->header().frame_count(), file);
  require_enclosing_outlines(structures, file);
  if (!command.structure.empty()) command.propagate.structure = command.structure;
  const Placed where = placed(command, exam, *recording);
  const Propagation result = propagate(*recording, structures, where.locator ? &*where.locator : nullptr, where.sweeps,
                                       command.propagate, progress_bar("propagating"));
  AtomicFile contours(command.out);
  contours.write(contours_json(result.structures));
  if (command.picture.empty()) {
    contours.commit();
  } else {
    AtomicFile picture(command.picture);
    write_png(contact_sheet(*recording, result.structures), picture);
    AtomicFile::commit_all({&picture, &contours});
  }
  if (command.json) {
    print_json(json_of(result));
  } else {
    print(result, command.out);
  }
}

}  // namespace

void add_propagate(CLI::App& app) {
  auto options = std::make_shared<PropagateCommand>();
  CLI::App* command = app.add_subcommand("propagate", "Outline the frames between drawn ones");
  add_recording(*command, options->input.recording);
  add_contours(*command, options->input);
  add_calibration(*command, options->input);
  add_frame_names(*command, options->input.names);
  command->add_option("--structure", options->structure, "Only this one (default: all)")->check(structure_name());
  command->add_option("--every", options->propagate.every, "Of the frames between two drawn ones, every N-th")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--out", options->out, "The contours file to write")->required();
  command->add_option("--picture", options->picture, "Writes the frames with their contours: .png")->check(png_name());
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
