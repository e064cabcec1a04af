#pragma once

#include <CLI/CLI.hpp>

namespace fathom {

/// Add `fathom exam report` and `fathom exam export`.
void add_exam_report(CLI::App& exam);
void add_exam_export(CLI::App& exam);

}  // namespace fathom
