#include "acquisition/live/source_registry.h"

#include <cassert>
#include <utility>

#include "core/error.h"
#include "core/printable.h"

namespace fathom {

void SourceRegistry::add(const std::string& name, Scheme scheme) {
  assert(scheme.make && !schemes_.contains(name));
  schemes_.emplace(name, std::move(scheme));
}

std::unique_ptr<LiveSource> SourceRegistry::make(const std::string& source) const {
  const auto scheme = schemes_.find(source.substr(0, source.find(':')));
  if (scheme == schemes_.end() || source.find(':') == std::string::npos) {
    std::string forms;
    for (const auto& [name, known] : schemes_) forms += (forms.empty() ? "" : ", ") + known.form;
    throw Error(printable(source) + ": is no source; give one of: " + forms);
  }
  return scheme->second.make(source);
}

}  // namespace fathom
