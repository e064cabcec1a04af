#include <algorithm>
#include <iostream>
#include <limits>
#include <memory>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "core/printable.h"
#include "registration/pose_chain.h"

namespace fathom {

namespace {

constexpr std::size_t kLongestText = 500;  // of an exam's notes: the rest is in the file

struct InfoOptions {
  std::string recording;
  FrameNames names;
  bool json = false;
};

std::string pixel_type_name(int type) {
  switch (type) {
    case CV_8UC1:
      return "uint8";
    case CV_8SC1:
      return "int8";
    case CV_16UC1:
      return "uint16";
    case CV_16SC1:
      return "int16";
    case CV_32FC1:
      return "float32";
    case CV_64FC1:
      return "float64";
    case CV_8UC3:
      return "rgb8";
    default:
      return cv::typeToString(type);
  }
}

// Of the frames that have a time stamp, at least two.
struct Timing {
  double duration_s = 0.0;  // from the first stamp to the last
  std::optional<double> frame_rate_hz;
};

std::optional<Timing> timing(const RecordingHeader& header) {
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  int stamped = 0;
  for (const FrameHeader& frame : header.frames) {
    if (!frame.time_s) continue;
    first = std::min(first, *frame.time_s);
    last = std::max(last, *frame.time_s);
    ++stamped;
  }
  if (stamped < 2) return std::nullopt;
  Timing timing{last - first, std::nullopt};
  if (last > first) timing.frame_rate_hz = (stamped - 1) / (last - first);
  return timing;
}

int valid_frames(const Recording& recording, const std::optional<PoseChain>& chain) {
  if (!chain) return 0;
  int count = 0;
  for (int i = 0; i < recording.header().frame_count(); ++i) {
    const bool image = recording.header().frames[static_cast<std::size_t>(i)].image_valid();
    if (image && reference_from_probe(recording, *chain, i)) ++count;
  }
  return count;
}

nlohmann::ordered_json about_recording(const Recording& recording, const FrameNames& names) {
  const RecordingHeader& header = recording.header();
  const bool chosen = names.probe || names.reference;
  const auto chain = chosen ? std::optional(find_pose_chain(recording, names)) : default_pose_chain(recording, names);
  const auto timed = timing(header);
  nlohmann::ordered_json json;
  json["frames"] = header.frame_count();
  json["valid_frames"] = valid_frames(recording, chain);
  json["width"] = header.width;
  json["height"] = header.height;
  json["pixel_type"] = pixel_type_name(header.pixel_type);
  json["duration_s"] = nullptr;
  json["frame_rate_hz"] = nullptr;
  if (timed) json["duration_s"] = timed->duration_s;
  if (timed && timed->frame_rate_hz) json["frame_rate_hz"] = *timed->frame_rate_hz;
  json["transforms"] = header.transforms;
  json["default_pose"] = chain ? nlohmann::ordered_json(chain->probe + "To" + chain->reference) : nullptr;
  json["warnings"] = header.warnings;
  return json;
}

void print_recording(const Recording& recording, const FrameNames& names) {
  const RecordingHeader& header = recording.header();
  const bool chosen = names.probe || names.reference;
  const auto chain = chosen ? std::optional(find_pose_chain(recording, names)) : default_pose_chain(recording, names);
  const auto timed = timing(header);
  const auto duration = timed ? std::optional(timed->duration_s) : std::nullopt;
  const auto rate = timed ? timed->frame_rate_hz : std::nullopt;
  std::string transforms;
  for (const std::string& name : header.transforms) transforms += (transforms.empty() ? "" : ", ") + name;
  const std::string images = header.has_images()
                                 ? std::to_string(header.width) + " x " + std::to_string(header.height) + " pixels, " +
                                       pixel_type_name(header.pixel_type)
                                 : "none, poses only";
  std::cout << "recording   " << recording.name() << "\n"
            << "frames      " << header.frame_count() << ", of which " << valid_frames(recording, chain) << " valid"
            << (chain ? " (pose " + chain->probe + " to " + chain->reference + ")" : " (no pose of the probe)") << "\n"
            << "images      " << images << "\n"
            << "duration    " << number_text(duration, 3) << " s, " << number_text(rate, 2) << " frames/s\n"
            << "transforms  " << (transforms.empty() ? "none" : transforms) << "\n";
  for (const std::string& warning : header.warnings) std::cout << "warning: " << warning << "\n";
}

void run_exam(const Exam& exam, const InfoOptions& options) {
  std::vector<std::unique_ptr<Recording>> recordings;
  for (const std::string& name : exam.recordings) recordings.push_back(open_recording(file_of(exam, name)));
  if (options.json) {
    nlohmann::ordered_json json;
    // One recording is told of as if it stood alone.
    if (recordings.size() == 1) json = about_recording(*recordings.front(), options.names);
    int frames = 0;
    int valid = 0;
    nlohmann::ordered_json items = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      nlohmann::ordered_json item{{"file", exam.recordings[i]}};
      item.update(about_recording(*recordings[i], options.names));
      frames += item["frames"].get<int>();
      valid += item["valid_frames"].get<int>();
      items.push_back(std::move(item));
    }
    json["frames"] = frames;
    json["valid_frames"] = valid;
    json["recordings"] = std::move(items);
    json["exam"] = nlohmann::ordered_json::parse(exam_text(exam));
    print_json(json);
    return;
  }
  for (const auto& recording : recordings) {
    print_recording(*recording, options.names);
    std::cout << "\n";
  }
  const std::pair<const char*, std::string> rows[] = {
      {"exam        ", exam_json(exam).string()},
      {"patient     ", exam.patient},
      {"operator    ", exam.operator_name},
      {"date        ", exam.date},
      {"notes       ", exam.notes},
      {"calibration ", exam.calibration.empty() ? "none" : exam.calibration},
      {"contours    ", exam.structures.empty() ? "none" : exam.structures},
      {"sweeps      ", std::to_string(exam.sweeps.size())},
      {"planes      ", std::to_string(exam.dividing_planes.size())},
      {"results     ", exam.results.is_null() ? "none" : "saved"}};
  for (const auto& [name, text] : rows) {
    if (!text.empty()) std::cout << name << printable(text, kLongestText) << "\n";
  }
}

void run(const InfoOptions& options) {
  if (const auto exam = read_if_exam(options.recording)) return run_exam(*exam, options);
  const auto recording = open_recording(options.recording);
  if (options.json) {
    print_json(about_recording(*recording, options.names));
  } else {
    print_recording(*recording, options.names);
  }
}

}  // namespace

void add_info(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app.add_subcommand("info", "Tell what is in a recording");
  add_recording(*command, options->recording);
  add_frame_names(*command, options->names);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
