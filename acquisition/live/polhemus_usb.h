#pragma once

#include <string>
#include <vector>

namespace fathom {

/// What Polhemus instruments are on the USB, one line for people each; empty where the USB cannot be looked at.
std::vector<std::string> find_polhemus_usb();

}  // namespace fathom
