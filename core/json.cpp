#include "core/json.h"

#include <cmath>

#include "core/error.h"
#include "core/numbers.h"
#include "core/text_file.h"

namespace fathom {

namespace {

constexpr std::uintmax_t kMaxBytes = 256u << 20;

// A parsed value takes up to 100 bytes; this many stay well below a gigabyte.
constexpr std::size_t kMostValues = 6'000'000;

constexpr std::size_t kDeepest = 32;  // a contours file nests six deep; others' additions may nest deeper

// Rubbish of a few megabytes can be parsed into gigabytes, so values are counted first: each but the first of an array
// or object comes after a comma, and the first after an opening bracket.
void require_moderate(const std::string& text, const std::string& file) {
  std::size_t values = 0;
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
      continue;
    }
    if (c == '"') quoted = true;
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (c == '[' || c == '{' || c == ',') ++values;
    if (depth > kDeepest)
      throw Error(file + ": nests deeper than any file of this program; check that it is the right file");
    if (values > kMostValues) {
      throw Error(file + ": holds more than " + std::to_string(kMostValues / 1'000'000) +
                  " million values, more than fits into memory; thin out its contours");
    }
  }
}

}  // namespace

nlohmann::json JsonValue::read_file(const std::filesystem::path& path) {
  const std::string text = read_text_file(path, kMaxBytes);
  require_moderate(text, path.string());
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& e) {
    // The library's own text carries an id and quotes the input; only where the fault lies helps the user.
    if (const auto* parse = dynamic_cast<const nlohmann::json::parse_error*>(&e)) {
      throw Error(path.string() + ": is not valid JSON (at byte " + std::to_string(parse->byte) +
                  "); check that the file is complete");
    }
    throw Error(path.string() + ": is not valid JSON (a number out of range); check the file");
  }
}

JsonValue::JsonValue(const nlohmann::json& document, const std::filesystem::path& path)
    : JsonValue(&document, path.string(), "") {}

JsonValue::JsonValue(const nlohmann::json* value, std::string file, std::string place)
    : value_(value), file_(std::move(file)), place_(std::move(place)) {}

void JsonValue::fail(const std::string& what) const {
  const bool advises = what.find(';') != std::string::npos;
  throw Error(file_ + ": " + (place_.empty() ? "" : place_ + ": ") + what +
              (advises ? "" : "; correct it in the file, or make the file anew"));
}

bool JsonValue::has(const std::string& key) const {
  if (!value_->is_object()) fail("must be an object");
  return value_->contains(key);
}

JsonValue JsonValue::at(const std::string& key) const {
  if (!has(key)) fail("\"" + key + "\" is missing");
  return {&value_->at(key), file_, place_.empty() ? key : place_ + "." + key};
}

std::size_t JsonValue::size() const {
  if (!value_->is_array()) fail("must be an array");
  return value_->size();
}

JsonValue JsonValue::operator[](std::size_t index) const {
  if (index >= size()) fail("has no element " + std::to_string(index));
  return {&(*value_)[index], file_, place_ + "[" + std::to_string(index) + "]"};
}

std::string JsonValue::string() const {
  if (!value_->is_string()) fail("must be a text");
  return value_->get<std::string>();
}

bool JsonValue::boolean() const {
  if (!value_->is_boolean()) fail("must be true or false");
  return value_->get<bool>();
}

double JsonValue::number() const {
  if (!value_->is_number()) fail("must be a number");
  const double number = value_->get<double>();
  if (!std::isfinite(number)) fail("must be finite");
  return number;
}

int JsonValue::integer(int low, int high) const {
  const double value = number();
  if (value != std::floor(value)) fail("must be a whole number");
  if (value < low || value > high) {
    fail("must lie between " + std::to_string(low) + " and " + std::to_string(high));
  }
  return static_cast<int>(value);
}

std::uint64_t JsonValue::whole_number() const {
  if (!value_->is_number_unsigned()) fail("must be a whole number from 0 to 2^64 - 1");
  return value_->get<std::uint64_t>();
}

void require_version(const JsonValue& root, const std::string& marker, int version) {
  if (!root.has(marker)) root.fail("has no \"" + marker + "\"; this is not a file of that kind");
  const double found = root.at(marker).number();
  if (found != version) {
    root.at(marker).fail("is of version " + format_real(found) + "; this program reads version " +
                         std::to_string(version));
  }
}

}  // namespace fathom
