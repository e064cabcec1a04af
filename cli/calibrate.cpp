#include "cli/calibrate.h"

#include "cli/command.h"

namespace fathom {

void add_calibrate(CLI::App& app) {
  CLI::App* calibrate = app.add_subcommand(
      "calibrate", "Find where the image lies on the probe, where a pointer's tip is, or how late the tracker is");
  calibrate->require_subcommand(1);
  add_calibrate_spatial(*calibrate);
  add_calibrate_pivot(*calibrate);
  add_calibrate_temporal(*calibrate);
}

}  // namespace fathom
