#include <iostream>
#include <new>

#include <opencv2/core/utils/logger.hpp>
#include <unistd.h>

#include "cli/command.h"
#include "cli/output.h"
#include "core/error.h"

namespace {

constexpr int kInputAtFault = 1;
constexpr int kCommandLineWrong = 2;

int fail(const std::string& message) {
  std::string line = message;
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';  // one line, whatever a file put into it
  }
  if (::isatty(STDERR_FILENO) != 0) std::cerr << "\r\033[K";  // where a bar was drawn
  std::cerr << "fathom: error: " << line << "\n";
  return kInputAtFault;
}

}  // namespace

int main(int argc, char** argv) {
  fathom::catch_interrupts();
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);

  CLI::App app("Fathom: freehand 3D ultrasound, from scan to measurement", "fathom");
  app.set_version_flag("--version", "fathom " FATHOM_VERSION);
  app.require_subcommand(1);
  fathom::add_info(app);
  fathom::add_convert(app);
  fathom::add_simulate(app);
  fathom::add_record(app);
  fathom::add_recover(app);
  fathom::add_exam(app);
  fathom::add_segment(app);
  fathom::add_sweeps(app);
  fathom::add_planes(app);
  fathom::add_propagate(app);
  fathom::add_measure(app);
  fathom::add_surface(app);
  fathom::add_reslice(app);
  fathom::add_reconstruct(app);
  fathom::add_isosurface(app);
  fathom::add_eqnsurf(app);
  fathom::add_calibrate(app);
  fathom::add_register(app);
  fathom::add_devices(app);
  fathom::add_serve(app);
  fathom::add_accuracy(app);
  fathom::add_demo(app);
  fathom::add_view(app);

  try {
    app.parse(argc, argv);
    std::cout.flush();
    if (!std::cout) return fail("standard output cannot be written; the results were not shown");
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kCommandLineWrong;
  } catch (const std::bad_alloc&) {
    return fail("not enough memory; close other programs or use a smaller recording");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}
