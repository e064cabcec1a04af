#pragma once

#include <CLI/CLI.hpp>

namespace fathom {

/// Each adds one kind of calibration to `fathom calibrate`.
void add_calibrate_spatial(CLI::App& calibrate);
void add_calibrate_pivot(CLI::App& calibrate);
void add_calibrate_temporal(CLI::App& calibrate);

}  // namespace fathom
