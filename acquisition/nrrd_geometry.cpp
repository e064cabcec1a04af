#include "acquisition/nrrd_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "acquisition/header_text.h"
#include "core/numbers.h"

namespace fathom {

std::vector<std::vector<double>> parse_nrrd_vectors(std::string_view text) {
  std::vector<std::vector<double>> vectors;
  while (!(text = trimmed(text)).empty()) {
    if (text.starts_with("none")) {
      vectors.emplace_back();
      text.remove_prefix(4);
      continue;
    }
    const std::size_t close = text.find(')');
    if (text[0] != '(' || close == std::string_view::npos) return {};
    std::string numbers(text.substr(1, close - 1));
    std::replace(numbers.begin(), numbers.end(), ',', ' ');
    std::vector<double> vector(words(numbers).size());
    if (vector.empty() || !parse_reals(numbers, vector)) return {};
    vectors.push_back(std::move(vector));
    text.remove_prefix(close + 1);
  }
  return vectors;
}

namespace {

/// Three numbers as text, unless all are the usual one.
std::optional<std::string> three_numbers(std::vector<double> values, double usual) {
  if (std::all_of(values.begin(), values.end(), [&](double x) { return x == usual; })) return std::nullopt;
  values.resize(3, usual);
  std::string text;
  for (const double x : values) {
    if (!text.empty()) text += ' ';
    text += format_real(x);
  }
  return text;
}

/// The first two of three numbers in a MetaImage field of the recording.
std::array<double, 2> image_vector(const RecordingHeader& header, std::string_view name, double usual) {
  std::array<double, 3> values = {usual, usual, usual};
  for (const auto& [field, value] : header.fields) {
    std::array<double, 3> read = {};
    if (field == name && (parse_reals(value, read) || parse_reals(value, std::span(read).first<2>()))) values = read;
  }
  return {values[0], values[1]};
}

}  // namespace

NrrdGeometry parse_nrrd_geometry(std::string_view space_directions, std::string_view spacings,
                                 std::string_view space_origin) {
  std::vector<double> lengths;
  for (const auto& direction : parse_nrrd_vectors(space_directions)) {
    double squares = 0.0;
    for (const double x : direction) squares += x * x;
    if (!direction.empty()) lengths.push_back(std::sqrt(squares));
  }
  if (lengths.empty()) {
    for (const std::string_view word : words(spacings)) {
      if (const auto x = parse_real(word)) lengths.push_back(*x);  // "nan" marks an axis that is no space
    }
  }
  const auto origins = parse_nrrd_vectors(space_origin);
  return {three_numbers(lengths, 1.0), three_numbers(origins.size() == 1 ? origins[0] : std::vector<double>(), 0.0)};
}

std::string nrrd_geometry_fields(const RecordingHeader& header) {
  const auto spacing = image_vector(header, "ElementSpacing", 1.0);
  const auto origin = image_vector(header, "Offset", 0.0);
  std::string text = "space dimension: 2\nspace directions: ";
  if (CV_MAT_CN(header.pixel_type) > 1) text += "none ";
  text += '(';
  text += format_real(spacing[0]);
  text += ",0) (0,";
  text += format_real(spacing[1]);
  text += ") none\nspace origin: (";
  text += format_real(origin[0]);
  text += ',';
  text += format_real(origin[1]);
  text += ")\n";
  return text;
}

}  // namespace fathom
