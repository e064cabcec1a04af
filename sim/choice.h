#pragma once

#include <string>
#include <vector>

namespace fathom {

/// Throws Error for a name that is not among those there are: "simulate: there is no object "bal"; choose one of ...".
[[noreturn]] void refuse_choice(const std::string& kind, const std::string& name,
                                const std::vector<std::string>& names);

/// The same unless the name is among them.
void require_choice(const std::string& kind, const std::string& name, const std::vector<std::string>& names);

}  // namespace fathom
