#include <iostream>
#include <memory>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "core/atomic_file.h"
#include "exam/contact_sheet.h"
#include "exam/report_picture.h"
#include "segmentation/threshold_recording.h"

namespace fathom {

namespace {

struct SegmentCommand {
  std::string recording;
  std::string out;
  ThresholdRecordingOptions segment;
  std::string picture;
  bool json = false;
};

// On every recording of an exam.
Structure outline(const SegmentCommand& command) {
  const Progress progress = progress_bar("outlining");
  const auto exam = read_if_exam(command.recording);
  if (!exam) return segment_by_threshold(*open_recording(command.recording), command.segment, progress);
  Structure all;
  for (std::size_t i = 0; i < exam->recordings.size(); ++i) {
    const auto recording = open_recording(file_of(*exam, exam->recordings[i]));
    Structure one = segment_by_threshold(*recording, command.segment, progress);
    for (Contour& contour : one.contours) contour.recording = static_cast<int>(i);
    one.contours.insert(one.contours.begin(), all.contours.begin(), all.contours.end());
    all = std::move(one);
  }
  return all;
}

void run(const SegmentCommand& command) {
  const Structure structure = outline(command);
  AtomicFile contours(command.out);
  contours.write(contours_json({structure}));
  if (command.picture.empty()) {
    contours.commit();
  } else {
    AtomicFile picture(command.picture);
    write_png(contact_sheet(*open_only_recording(command.recording, "segment --picture"), {structure}), picture);
    AtomicFile::commit_all({&picture, &contours});
  }
  const auto frames = outlined_frames(structure);
  if (command.json) {
    print_json({{"contours", structure.contours.size()}, {"frames", frames}});
  } else {
    std::cout << "outlined " << structure.name << " by " << structure.contours.size() << " contours on " << frames
              << " frames, to " << command.out << "\n";
  }
}

}  // namespace

void add_segment(CLI::App& app) {
  auto options = std::make_shared<SegmentCommand>();
  ThresholdRecordingOptions& segment = options->segment;
  CLI::App* command = app.add_subcommand("segment", "Outline a structure on the frames of a recording");
  add_recording(*command, options->recording);
  command->add_option("--threshold", segment.threshold.threshold, "Pixels from this grey value on are inside")
      ->required()
      ->check(finite());
  command->add_flag("--below", segment.threshold.below, "Inside is below the threshold");
  command
      ->add_option("--min-area-px", segment.threshold.min_area_px, "Drop outlines and holes of smaller area, in pixels")
      ->check(at_least(0))
      ->capture_default_str();
  command->add_option("--structure", segment.structure, "Name of the structure")
      ->check(structure_name())
      ->capture_default_str();
  command->add_option("--every", segment.every, "Outline every N-th frame")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_flag("--ends", segment.ends, "Outline also the first and the last frame that show the structure");
  command->add_option("--out", options->out, "The contours file to write")->required();
  command->add_option("--picture", options->picture, "Writes the frames with their contours: .png")->check(png_name());
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
