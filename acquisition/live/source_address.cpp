#include "acquisition/live/source_address.h"

#include "core/error.h"
#include "core/numbers.h"
#include "core/printable.h"

namespace fathom {

namespace {

// Adds "name=value" of the options.
void add_option(SourceAddress& address, const std::string& option, const std::set<std::string>& known) {
  const std::size_t equals = option.find('=');
  const std::string name = option.substr(0, equals);
  if (equals == std::string::npos || !known.contains(name)) {
    std::string names;
    for (const std::string& each : known) names += (names.empty() ? "" : ", ") + each;
    address.fail("has no option '" + printable(name) + "'; " + (names.empty() ? "leave it out" : "there are " + names));
  }
  if (!address.options.emplace(name, option.substr(equals + 1)).second) {
    address.fail("the option '" + name + "' is given twice; leave one out");
  }
}

}  // namespace

double SourceAddress::number(const std::string& name, double fallback, double low, double high) const {
  const auto option = options.find(name);
  if (option == options.end()) return fallback;
  const auto value = parse_real(option->second);
  if (!value || *value < low || *value > high) {
    fail("'" + name + "' cannot be '" + printable(option->second) + "'; give a number from " + format_real(low) +
         " to " + format_real(high));
  }
  return *value;
}

bool SourceAddress::flag(const std::string& name) const {
  const double value = number(name, 0.0, 0.0, 1.0);
  if (value != 0.0 && value != 1.0) fail("'" + name + "' is neither on nor off; give 1 or 0");
  return value == 1.0;
}

void SourceAddress::fail(const std::string& what) const { throw Error(printable(text) + ": " + what); }

SourceAddress parse_source(const std::string& source, const std::set<std::string>& known) {
  SourceAddress address{source, source.substr(source.find(':') + 1), {}};
  // A file's name may hold '?': options are what has their form.
  const std::size_t question = address.target.rfind('?');
  if (question != std::string::npos && address.target.find('=', question) != std::string::npos) {
    const std::string options = address.target.substr(question + 1);
    address.target.erase(question);
    for (std::size_t from = 0; from <= options.size();) {
      const std::size_t to = std::min(options.find('&', from), options.size());
      add_option(address, options.substr(from, to - from), known);
      from = to + 1;
    }
  }
  if (address.target.empty()) address.fail("names nothing after the colon; say which");
  return address;
}

}  // namespace fathom
