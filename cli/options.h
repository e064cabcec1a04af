#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "registration/pose_chain.h"

namespace fathom {

/// Adds `--probe-frame` and `--reference-frame`.
void add_frame_names(CLI::App& command, FrameNames& names);

/// An option that may be repeated, each time with `count` finite numbers between commas: `form`, as in messages.
CLI::Option* add_number_lists(CLI::App& command, const std::string& name, std::vector<std::vector<double>>& lists,
                              std::size_t count, const std::string& form, const std::string& help);

/// Accepts finite numbers: all, those from `low` on, those above `low`, or those from `low` to `high`.
CLI::Validator finite();
CLI::Validator at_least(double low);
CLI::Validator above(double low);
CLI::Validator between(double low, double high);

/// Accepts whole numbers from 0 to 2^64 - 1.
CLI::Validator whole_number();

/// Accepts the name of a picture to write.
CLI::Validator png_name();

/// Accepts what a contours file takes for the name of a structure.
CLI::Validator structure_name();

}  // namespace fathom
