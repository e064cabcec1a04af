#include "cli/options.h"

#include "core/numbers.h"

namespace fathom {

void add_frame_names(CLI::App& command, FrameNames& names) {
  command.add_option("--probe-frame", names.probe, "Name of the probe's coordinates in the recording (default: Probe)");
  command.add_option("--reference-frame", names.reference,
                     "Name of the coordinates to work in (default: Reference, else Tracker)");
}

CLI::Validator at_least(double low) {
  return CLI::Validator(
      [low](std::string& text) {
        const auto value = parse_real(text);
        return value && *value >= low ? std::string() : "must be a number of at least " + format_real(low);
      },
      ">=" + format_real(low));
}

}  // namespace fathom
