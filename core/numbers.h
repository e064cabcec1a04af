#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

/// The finite number that `text` is, whole and in the C locale; empty where it is anything else.
inline std::optional<double> parse_real(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Finite numbers separated by white space; empty where anything else stands between them.
inline std::optional<std::vector<double>> parse_reals(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n\f\v";
  std::vector<double> values;
  for (std::size_t at = text.find_first_not_of(kSpace); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSpace, at), text.size());
    const auto value = parse_real(text.substr(at, end - at));
    if (!value) return std::nullopt;
    values.push_back(*value);
    at = text.find_first_not_of(kSpace, end);
  }
  return values;
}

/// The shortest text that reads back as exactly this number.
inline std::string format_real(double value) {
  char text[32];
  const auto [end, code] = std::to_chars(text, text + sizeof text, value);
  return code == std::errc() ? std::string(text, end) : std::string();
}

}  // namespace fathom
