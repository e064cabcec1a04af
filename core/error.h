#pragma once

#include <stdexcept>
#include <string>

namespace fathom {

/// A fault that the user can mend: in a file, a device, an argument. The message names the file or device, what is
/// wrong, and what to do, in one line. Mistakes of the program itself are asserts, never this.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fathom
