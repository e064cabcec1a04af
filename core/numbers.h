#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

// Numbers in files and on the command line. Nothing here depends on the user's locale.

/// The finite number that `text` is, whole; a sign before it is allowed. What is too small for a double is 0. Empty
/// where the text is anything else, NaN or infinite.
std::optional<double> parse_real(std::string_view text);

/// Finite numbers separated by white space; empty where anything else stands between them.
std::optional<std::vector<double>> parse_reals(std::string_view text);

/// The shortest text that reads back as exactly this number.
std::string format_real(double value);

/// A finite number for a reader's eyes, rounded: "-0.30" for (-0.3, 2); never "-0.00".
std::string format_rounded(double value, int decimals);

/// The same with its sign, for errors: "+0.30"; "-" where there is no finite number.
std::string format_signed(double value, int decimals);

}  // namespace fathom
