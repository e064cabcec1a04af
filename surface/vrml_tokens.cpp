#include "surface/vrml_tokens.h"

#include "core/printable.h"

namespace fathom {

namespace {

constexpr std::size_t kLongestWord = 1'000;  // bytes of a name or number

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ','; }
bool is_bracket(char c) { return c == '{' || c == '}' || c == '[' || c == ']'; }

}  // namespace

const std::string& VrmlTokens::next() {
  token_.clear();
  auto c = skip_space();
  if (!c) return token_;
  if (is_bracket(*c)) {
    source_.skip();
    return token_ = *c;
  }
  if (*c == '"') {
    skip_text();
    return token_ = '"';
  }
  while (c && !is_space(*c) && !is_bracket(*c) && *c != '"' && *c != '#') {
    if (token_.size() == kLongestWord) fail("holds a word of more than 1000 bytes; the file is damaged");
    token_ += *c;
    source_.skip();
    c = source_.peek();
  }
  return token_;
}

void VrmlTokens::expect(std::string_view expected) {
  if (next() != expected) {
    if (token_.empty()) source_.fail_cut_short();
    fail("has \"" + printable(token_) + "\" in place of \"" + std::string(expected) + "\"; write the mesh anew");
  }
}

void VrmlTokens::fail(const std::string& what) const {
  source_.fail("line " + std::to_string(source_.line_number() + 1) + " " + what);
}

std::optional<char> VrmlTokens::skip_space() {
  auto c = source_.peek();
  while (c && (is_space(*c) || *c == '#')) {
    const bool is_comment = *c == '#';
    source_.skip();
    c = source_.peek();
    while (is_comment && c && *c != '\n') {
      source_.skip();
      c = source_.peek();
    }
  }
  return c;
}

void VrmlTokens::skip_text() {
  source_.skip();
  while (const auto c = source_.peek()) {
    source_.skip();
    if (*c == '"') return;
    if (*c == '\\' && source_.peek()) source_.skip();
  }
  source_.fail_cut_short();
}

}  // namespace fathom
