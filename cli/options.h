#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "registration/pose_chain.h"

namespace fathom {

/// Adds `--probe-frame` and `--reference-frame`.
void add_frame_names(CLI::App& command, FrameNames& names);

/// Accepts finite numbers: all, those from `low` on, those above `low`, or those from `low` to `high`.
CLI::Validator finite();
CLI::Validator at_least(double low);
CLI::Validator above(double low);
CLI::Validator between(double low, double high);

/// Accepts whole numbers from 0 to 2^64 - 1.
CLI::Validator whole_number();

/// Accepts what a contours file takes for the name of a structure.
CLI::Validator structure_name();

}  // namespace fathom
