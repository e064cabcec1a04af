#pragma once

#include <CLI/CLI.hpp>

namespace fathom {

/// Each adds one sub-command to the program; the command runs when the line was parsed. What it throws ends the
/// program: Error with status 1.
void add_accuracy(CLI::App& app);
void add_calibrate(CLI::App& app);
void add_convert(CLI::App& app);
void add_demo(CLI::App& app);
void add_devices(CLI::App& app);
void add_eqnsurf(CLI::App& app);
void add_exam(CLI::App& app);
void add_info(CLI::App& app);
void add_isosurface(CLI::App& app);
void add_measure(CLI::App& app);
void add_planes(CLI::App& app);
void add_propagate(CLI::App& app);
void add_reconstruct(CLI::App& app);
void add_record(CLI::App& app);
void add_recover(CLI::App& app);
void add_register(CLI::App& app);
void add_reslice(CLI::App& app);
void add_segment(CLI::App& app);
void add_serve(CLI::App& app);
void add_simulate(CLI::App& app);
void add_surface(CLI::App& app);
void add_sweeps(CLI::App& app);
void add_view(CLI::App& app);

}  // namespace fathom
