#include "core/numbers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace fathom {

namespace {
constexpr double kUnderflow = 1e-300;  // what is smaller is as good as zero
}

std::optional<double> parse_real(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, code] = std::from_chars(text.data(), end, value);
  if (rest != end || code == std::errc::invalid_argument) return std::nullopt;
  if (code == std::errc::result_out_of_range) {
    // Too large and too small are the same code here; only what is too small is harmless.
    value = std::strtod(std::string(text).c_str(), nullptr);
    if (std::abs(value) > kUnderflow) return std::nullopt;
  }
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::vector<double>> parse_reals(std::string_view text) {
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

std::string format_real(double value) {
  char text[32];  // the longest shortest form has 24 characters
  const auto [end, code] = std::to_chars(text, text + sizeof text, value);
  return code == std::errc() ? std::string(text, end) : std::string();
}

std::string format_rounded(double value, int decimals) {
  std::array<char, 400> text{};  // 1.8e308 has 309 digits
  const auto [end, code] = std::to_chars(text.begin(), text.end(), value, std::chars_format::fixed, decimals);
  const std::string_view digits(text.data(), static_cast<std::size_t>(end - text.begin()));
  const bool nothing = digits.find_first_not_of("-0.") == std::string_view::npos;
  return std::string(nothing && digits.starts_with('-') ? digits.substr(1) : digits);
}

std::string format_signed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  const std::string text = format_rounded(value, decimals);
  return text.starts_with('-') ? text : "+" + text;
}

}  // namespace fathom
