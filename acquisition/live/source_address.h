#pragma once

#include <map>
#include <set>
#include <string>

namespace fathom {

/// A source as typed, taken apart: "replay:sweep.mha?speed=2&loop=1".
struct SourceAddress {
  std::string text;                            ///< the whole
  std::string target;                          ///< between the scheme's colon and the options: "sweep.mha"
  std::map<std::string, std::string> options;  ///< what follows the last '?', where that has the form of options

  /// The option `name`, or `fallback` where it is not given. Throws Error unless it is a number in [low, high].
  double number(const std::string& name, double fallback, double low, double high) const;
  /// The same for a switch: 0 or 1.
  bool flag(const std::string& name) const;

  /// Throws Error with the source before `what`.
  [[noreturn]] void fail(const std::string& what) const;
};

/// Throws Error when there is nothing between scheme and options, an option is not one of `known`, or is given twice.
SourceAddress parse_source(const std::string& source, const std::set<std::string>& known);

}  // namespace fathom
