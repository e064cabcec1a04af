#include <iostream>
#include <memory>

#include "acquisition/live/recording_folder.h"
#include "cli/command.h"
#include "cli/output.h"

namespace fathom {

namespace {

struct RecoverCommand {
  std::string folder;
  bool json = false;
};

void run(const RecoverCommand& command) {
  const FinishedRecording found = recover_recording(command.folder, progress_bar("recovering"));
  if (command.json) {
    print_json({{"frames", found.frames}, {"lost_bytes", found.lost_bytes}, {"was_finished", found.was_finished}});
  } else if (found.was_finished) {
    std::cout << command.folder << " was finished, with " << found.frames << " frames; nothing was changed\n";
  } else {
    std::cout << "recovered " << found.frames << " frames (" << found.invalid_frames << " not valid); "
              << found.lost_bytes << " bytes behind them belong to no whole frame or sample\n";
  }
}

}  // namespace

void add_recover(CLI::App& app) {
  auto options = std::make_shared<RecoverCommand>();
  CLI::App* command =
      app.add_subcommand("recover", "Make a recording readable that a crash, a power cut or a full disk has cut off");
  command->add_option("DIR", options->folder, "The folder that was recorded into")->required();
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
