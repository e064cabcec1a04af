#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/progress.h"
#include "exam/results.h"

namespace fathom {

/// Prints one JSON object on standard output.
void print_json(const nlohmann::ordered_json& json);

/// Prints rows with their columns aligned: the first to the left, numbers and all others to the right.
void print_table(const std::vector<std::vector<std::string>>& rows);

/// "17.06"; "-" where there is no number.
std::string number_text(const std::optional<double>& value, int decimals);

/// The volumes of every structure as a table, warnings below.
void print_results(const std::vector<StructureResult>& results);

/// Draws a bar on standard error if that is a terminal; asks the work to stop once the user pressed Ctrl-C.
Progress progress_bar(const std::string& what);

/// Whether the user has pressed Ctrl-C.
bool was_interrupted();

/// From here on Ctrl-C and a polite kill end the program in order: what is being written is removed first. Asked a
/// second time, it ends at once.
void catch_interrupts();

}  // namespace fathom
