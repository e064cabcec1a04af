#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "surface/mesh_source.h"

namespace fathom {

/// The words and brackets of a VRML 2.0 text.
class VrmlTokens {
 public:
  explicit VrmlTokens(MeshSource& source) : source_(source) {}

  /// The next token: one of "{}[]", a text in quotes (shown as "\""), or a word; empty at the end of the file.
  const std::string& next();
  /// Throws Error when another one comes next.
  void expect(std::string_view expected);
  /// Throws Error with the number of the line.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::optional<char> skip_space();
  void skip_text();

  MeshSource& source_;
  std::string token_;
};

}  // namespace fathom
