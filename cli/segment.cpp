#include <algorithm>
#include <functional>
#include <iostream>
#include <map>
#include <memory>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "cli/seed_input.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "exam/contact_sheet.h"
#include "exam/report_picture.h"
#include "segmentation/assisted_recording.h"
#include "segmentation/outline_topology.h"
#include "segmentation/threshold_recording.h"

namespace fathom {

namespace {

struct SegmentCommand {
  ScanInput input;
  std::string method = "threshold";
  std::string out;
  std::string picture;
  SeedInput seeds;
  ThresholdRecordingOptions threshold;
  LiveWireOptions live_wire;
  RegionOptions region;
  RefineOptions refine;
  FinishOptions finish;
  EdgeMapOptions edges;
  double smooth_image_px = -1.0;
  bool all_structures = true;
  bool json = false;
};

// One recording of the exam, or the only one there is.
struct Source {
  const Recording& recording;
  int index = 0;
  const Progress& progress;
};

void add_contours_of(std::vector<Contour> contours, Structure& structure) {
  structure.contours.insert(structure.contours.end(), contours.begin(), contours.end());
}

// What a method makes of one recording, put to what there is already.
using Method = std::function<void(const SegmentCommand&, const Source&, std::vector<Structure>&)>;

void by_threshold(const SegmentCommand& command, const Source& source, std::vector<Structure>& structures) {
  ThresholdRecordingOptions options = command.threshold;
  options.threshold.smoothing_px = std::max(0.0, command.smooth_image_px);
  Structure found = segment_by_threshold(source.recording, options, source.progress);
  for (Contour& contour : found.contours) contour.recording = source.index;
  add_contours_of(std::move(found.contours), structures.front());
}

void by_live_wire(const SegmentCommand& command, const Source& source, std::vector<Structure>& structures) {
  LiveWireOptions options = command.live_wire;
  options.edges = command.edges;
  add_contours_of(outline_by_seeds(source.recording, source.index, command.seeds.read(), options, source.progress),
                  structures.front());
}

void by_region(const SegmentCommand& command, const Source& source, std::vector<Structure>& structures) {
  RegionOptions options = command.region;
  if (command.smooth_image_px >= 0.0) options.smoothing_px = command.smooth_image_px;
  add_contours_of(outline_regions(source.recording, source.index, command.seeds.read(), options, source.progress),
                  structures.front());
}

void by_refinement(const SegmentCommand& command, const Source& source, std::vector<Structure>& structures) {
  RefineOptions options = command.refine;
  options.edges = command.edges;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    if (!command.all_structures && structures[i].name != command.threshold.structure) continue;
    refine_structure(source.recording, source.index, options, structures, i, source.progress);
  }
}

const std::map<std::string, Method>& methods() {
  static const std::map<std::string, Method> kAll = {
      {"threshold", by_threshold}, {"live-wire", by_live_wire}, {"region", by_region}, {"refine", by_refinement}};
  return kAll;
}

// Of a contours file where drawn contours are worked on; else one without contours yet.
std::vector<Structure> structures_to_start_with(const SegmentCommand& command, const std::optional<Exam>& exam,
                                                const std::vector<int>& frame_counts) {
  if (command.method != "refine") {
    Structure structure;
    structure.name = command.threshold.structure;
    return {structure};
  }
  const std::string file = contours_file(command.input, exam);
  std::vector<Structure> structures = read_contours(file);
  require_measurable(structures, frame_counts, OpenContours::kAllow, file);
  require_enclosing_outlines(structures, file);
  const bool found = std::any_of(structures.begin(), structures.end(), [&](const Structure& structure) {
    return command.all_structures || structure.name == command.threshold.structure;
  });
  if (!found) throw Error(file + ": has no structure " + command.threshold.structure + "; name one that it has");
  return structures;
}

std::vector<Structure> outline(const SegmentCommand& command) {
  const Progress progress = progress_bar("outlining");
  const auto exam = read_if_exam(command.input.recording);
  std::vector<std::string> files = {command.input.recording};
  if (exam) {
    files.clear();
    for (const std::string& name : exam->recordings) files.push_back(file_of(*exam, name).string());
  }
  if (command.method == "live-wire" || command.method == "region") command.seeds.require_recordings(files.size());
  std::vector<std::unique_ptr<Recording>> recordings;
  std::vector<int> frame_counts;
  for (const std::string& file : files) {
    recordings.push_back(open_recording(file));
    frame_counts.push_back(recordings.back()->header().frame_count());
  }
  std::vector<Structure> structures = structures_to_start_with(command, exam, frame_counts);
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    methods().at(command.method)(command, {*recordings[i], static_cast<int>(i), progress}, structures);
  }
  for (Structure& structure : structures) finish(command.finish, structure);
  return structures;
}

void write_results(const SegmentCommand& command, const std::vector<Structure>& structures) {
  AtomicFile contours(command.out);
  contours.write(contours_json(structures));
  if (command.picture.empty()) {
    contours.commit();
    return;
  }
  AtomicFile picture(command.picture);
  write_png(contact_sheet(*open_only_recording(command.input.recording, "segment --picture"), structures), picture);
  AtomicFile::commit_all({&picture, &contours});
}

void run(const SegmentCommand& command) {
  const std::vector<Structure> structures = outline(command);
  write_results(command, structures);
  std::size_t contours = 0;
  Structure together;
  for (const Structure& structure : structures) {
    contours += structure.contours.size();
    add_contours_of(structure.contours, together);
  }
  const int frames = outlined_frames(together);
  if (command.json) {
    print_json({{"contours", contours}, {"frames", frames}});
    return;
  }
  for (const Structure& structure : structures) {
    std::cout << "outlined " << structure.name << " by " << structure.contours.size() << " contours on "
              << outlined_frames(structure) << " frames, to " << command.out << "\n";
  }
}

void add_threshold_options(CLI::App& command, ThresholdRecordingOptions& options) {
  CLI::Option* threshold =
      command.add_option("--threshold", options.threshold.threshold, "Pixels from this grey value on are inside")
          ->check(finite())
          ->group("threshold");
  command.add_option("--upper", options.threshold.upper, "... and up to this one")
      ->check(finite())
      ->needs(threshold)
      ->group("threshold");
  command.add_flag("--below", options.threshold.below, "Inside is below the threshold (or above the upper one)")
      ->group("threshold");
  command
      .add_option("--min-area-px", options.threshold.min_area_px, "Drop outlines and holes of smaller area, in pixels")
      ->check(at_least(0))
      ->capture_default_str()
      ->group("threshold");
  command.add_option("--every", options.every, "Outline every N-th frame")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str()
      ->group("threshold");
  command.add_flag("--ends", options.ends, "Outline also the first and the last frame that show the structure")
      ->group("threshold");
}

void add_seed_options(CLI::App& command, SegmentCommand& options) {
  const char* group = "live-wire and region";
  add_seeds(command, options.seeds, group);
  command.add_flag("!--no-training", options.live_wire.train, "Take all edges alike, whatever the seeds show")
      ->group("live-wire");
  RegionOptions& region = options.region;
  command.add_option("--tolerance", region.tolerance, "Standard deviations of grey values that belong to the region")
      ->check(above(0))
      ->capture_default_str()
      ->group("region");
  command.add_option("--low", region.low, "Grey values from here on, in place of the tolerance")
      ->check(finite())
      ->group("region");
  command.add_option("--high", region.high, "Grey values up to here")->check(finite())->group("region");
  command.add_option("--neck-px", region.neck_px, "Do not grow through gaps narrower than this")
      ->check(between(0, 200))
      ->capture_default_str()
      ->group("region");
}

void add_refine_options(CLI::App& command, SegmentCommand& options) {
  const char* group = "refine";
  command.add_option("--contours", options.input.contours, "The contours to refine (default: the exam's)")
      ->group(group);
  command.add_option("--reach-px", options.refine.reach_px, "No point moves farther")
      ->check(between(0.5, 100))
      ->capture_default_str()
      ->group(group);
  command.add_option("--stiffness", options.refine.stiffness, "0 follows every edge, more keeps the drawn shape")
      ->check(between(0, 100))
      ->capture_default_str()
      ->group(group);
  command
      .add_flag("--keep-place", options.refine.keep_place,
                "Stay as far beside the steepest place as the drawn ones are")
      ->group(group);
}

void add_common_options(CLI::App& command, SegmentCommand& options) {
  command
      .add_option("--edge-scale-px", options.edges.scale_px, "Size of the finest edges (default: that of the speckle)")
      ->check(between(0.3, 50))
      ->group("live-wire and refine");
  command.add_option("--smooth-image-px", options.smooth_image_px, "Even out speckle first (default: 0; region 2)")
      ->check(between(0, 50))
      ->group("threshold and region");
  const char* group = "finishing";
  const auto add = [&](const std::string& name, double& value, double most, const std::string& help) {
    command.add_option(name, value, help)->check(between(0, most))->capture_default_str()->group(group);
  };
  add("--close-px", options.finish.clean.close_px, 500, "Fill gaps that cannot hold a disc of this radius");
  add("--open-px", options.finish.clean.open_px, 500, "Drop what cannot hold a disc of this radius");
  add("--min-part-px", options.finish.clean.min_part_px, 1e12, "Drop parts of smaller area");
  add("--fill-holes-px", options.finish.clean.fill_holes_px, 1e12, "Fill holes of smaller area");
  add("--smooth-px", options.finish.smooth_px, 100, "Even out bends shorter than this; areas stay");
}

}  // namespace

void add_segment(CLI::App& app) {
  auto options = std::make_shared<SegmentCommand>();
  CLI::App* command = app.add_subcommand("segment", "Outline a structure on the frames of a recording");
  add_recording(*command, options->input.recording);
  std::vector<std::string> names;
  for (const auto& [name, method] : methods()) names.push_back(name);
  command->add_option("--method", options->method, "How to find outlines")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  CLI::Option* structure =
      command->add_option("--structure", options->threshold.structure, "Name of the structure (refine: default all)")
          ->check(structure_name())
          ->capture_default_str();
  command->add_option("--out", options->out, "The contours file to write")->required();
  command->add_option("--picture", options->picture, "Writes the frames with their contours: .png")->check(png_name());
  command->add_flag("--json", options->json, "Print one JSON object");
  add_threshold_options(*command, options->threshold);
  add_seed_options(*command, *options);
  add_refine_options(*command, *options);
  add_common_options(*command, *options);
  command->callback([command, structure, options] {
    if (options->method == "threshold" && command->count("--threshold") == 0) throw CLI::RequiredError("--threshold");
    options->all_structures = structure->count() == 0;
    run(*options);
  });
}

}  // namespace fathom
