#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "registration/pose_chain.h"

namespace fathom {

/// Adds `--probe-frame` and `--reference-frame`.
void add_frame_names(CLI::App& command, FrameNames& names);

/// Accepts finite numbers from `low` on.
CLI::Validator at_least(double low);

}  // namespace fathom
