#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace fathom {

/// One value inside a JSON file, which remembers where it stands, so that every complaint can say so.
///
/// All accessors throw Error naming the file and the value ("exam.json: structures[2].name: ...").
class JsonValue {
 public:
  /// Reads and parses a file of at most 256 MiB, 6 million values and 32 levels. Throws Error when it is missing, no
  /// regular file, larger than that, or not JSON. The document must outlive every value taken from it.
  static nlohmann::json read_file(const std::filesystem::path& path);

  /// The root of a document that was read from `path`.
  JsonValue(const nlohmann::json& document, const std::filesystem::path& path);

  bool has(const std::string& key) const;
  /// The member `key` of this object; it must be there.
  JsonValue at(const std::string& key) const;
  /// The elements of this array.
  std::size_t size() const;
  JsonValue operator[](std::size_t index) const;

  bool is_null() const { return value_->is_null(); }
  std::string string() const;
  bool boolean() const;
  /// A finite number.
  double number() const;
  /// A whole number in [low, high].
  int integer(int low, int high) const;
  /// A whole number from 0 to 2^64 - 1, exactly.
  std::uint64_t whole_number() const;
  /// What stands here, as it was parsed.
  const nlohmann::json& raw() const { return *value_; }

  /// Throws Error about this value. Without advice of its own ("...; do this") the user is told to mend the file.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  JsonValue(const nlohmann::json* value, std::string file, std::string place);

  const nlohmann::json* value_;
  std::string file_;
  std::string place_;
};

/// Requires a root object with `"marker": version`, such as "fathom_contours": 1; anything else is an Error that says
/// what kind of file was expected.
void require_version(const JsonValue& root, const std::string& marker, int version);

}  // namespace fathom
