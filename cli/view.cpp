#include <memory>

#include "cli/command.h"
#include "viewer/viewer.h"

namespace fathom {

void add_view(CLI::App& app) {
  auto options = std::make_shared<ViewerOptions>();
  CLI::App* command = app.add_subcommand("view", "The bedside application: review, outline, measure in one window");
  command->add_option("EXAM or RECORDING", options->open, "What to open (default: nothing)");
  command->add_option("--calibration", options->calibration, "Of a recording: Fathom's JSON, or a PLUS XML");
  command->add_option("--contours", options->contours, "Of a recording: outlines to begin with");
  command->add_option("--script", options->script, "Replay mouse, key and menu events and take pictures");
  command->callback([options] { run_viewer(*options); });
}

}  // namespace fathom
