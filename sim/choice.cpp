#include "sim/choice.h"

#include <algorithm>

#include "core/error.h"

namespace fathom {

void refuse_choice(const std::string& kind, const std::string& name, const std::vector<std::string>& names) {
  constexpr std::size_t kMaxQuoted = 40;  // what the user typed is shown, but must not flood or break the line
  std::string quoted = name.substr(0, kMaxQuoted);
  for (char& c : quoted) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  std::string choice;
  for (const std::string& one : names) choice += (choice.empty() ? "" : ", ") + one;
  throw Error("simulate: there is no " + kind + " \"" + quoted + "\"; choose one of " + choice);
}

void require_choice(const std::string& kind, const std::string& name, const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) == names.end()) refuse_choice(kind, name, names);
}

}  // namespace fathom
