#include <algorithm>
#include <iostream>
#include <limits>
#include <memory>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "registration/pose_chain.h"

namespace fathom {

namespace {

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

void run(const InfoOptions& options) {
  const auto recording = open_recording(options.recording);
  const RecordingHeader& header = recording->header();
  const bool chosen = options.names.probe || options.names.reference;
  const auto chain = chosen ? std::optional(find_pose_chain(*recording, options.names))
                            : default_pose_chain(*recording, options.names);
  const int valid = valid_frames(*recording, chain);
  const auto timed = timing(header);
  const auto duration = timed ? std::optional(timed->duration_s) : std::nullopt;
  const auto rate = timed ? timed->frame_rate_hz : std::nullopt;

  if (options.json) {
    nlohmann::ordered_json json;
    json["frames"] = header.frame_count();
    json["valid_frames"] = valid;
    json["width"] = header.width;
    json["height"] = header.height;
    json["pixel_type"] = pixel_type_name(header.pixel_type);
    json["duration_s"] = duration ? nlohmann::ordered_json(*duration) : nlohmann::ordered_json(nullptr);
    json["frame_rate_hz"] = rate ? nlohmann::ordered_json(*rate) : nlohmann::ordered_json(nullptr);
    json["transforms"] = header.transforms;
    json["default_pose"] = chain ? nlohmann::ordered_json(chain->probe + "To" + chain->reference) : nullptr;
    json["warnings"] = header.warnings;
    print_json(json);
    return;
  }
  std::string transforms;
  for (const std::string& name : header.transforms) transforms += (transforms.empty() ? "" : ", ") + name;
  const std::string images = header.has_images()
                                 ? std::to_string(header.width) + " x " + std::to_string(header.height) + " pixels, " +
                                       pixel_type_name(header.pixel_type)
                                 : "none, poses only";
  std::cout << "recording   " << recording->name() << "\n"
            << "frames      " << header.frame_count() << ", of which " << valid << " valid"
            << (chain ? " (pose " + chain->probe + " to " + chain->reference + ")" : " (no pose of the probe)") << "\n"
            << "images      " << images << "\n"
            << "duration    " << number_text(duration, 3) << " s, " << number_text(rate, 2) << " frames/s\n"
            << "transforms  " << (transforms.empty() ? "none" : transforms) << "\n";
  for (const std::string& warning : header.warnings) std::cout << "warning: " << warning << "\n";
}

}  // namespace

void add_info(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app.add_subcommand("info", "Tell what is in a recording");
  command->add_option("RECORDING", options->recording, "A .mha, .mhd or .nrrd sequence")->required();
  add_frame_names(*command, options->names);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
