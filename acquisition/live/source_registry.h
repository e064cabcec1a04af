#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/live/live_source.h"

namespace fathom {

/// Something that can be used as a source here and now.
struct FoundDevice {
  std::string source;       ///< what to type: "video:/dev/video0"
  std::string description;  ///< one line for people
};

/// Makes live sources from their strings ("igtl://...", "video:...").
class SourceRegistry {
 public:
  struct Scheme {
    std::string form;         ///< how it is typed, for help texts: "replay:FILE[?speed=1]"
    std::string description;  ///< one line for people
    /// Gets the whole string. Throws Error where it is malformed; touches no device.
    std::function<std::unique_ptr<LiveSource>(const std::string& source)> make;
    std::function<std::vector<FoundDevice>()> find;  ///< empty where nothing can be looked for; does not throw
  };

  /// `name` is what stands before the colon.
  void add(const std::string& name, Scheme scheme);

  /// Throws Error, naming the schemes there are, for an unknown one; and as Scheme::make.
  std::unique_ptr<LiveSource> make(const std::string& source) const;

  const std::map<std::string, Scheme>& schemes() const { return schemes_; }

 private:
  std::map<std::string, Scheme> schemes_;
};

}  // namespace fathom
