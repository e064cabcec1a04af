#pragma once

#include <string>

#include "exam/edit.h"

namespace fathom {

class JsonValue;

/// The text of an edit, in one line (docs/file-formats.md); reads back as the same.
std::string edit_json(const Edit& edit);

/// Throws Error where it is damaged. Whether it fits what it is to be applied to is seen there.
Edit read_edit(const JsonValue& value);

}  // namespace fathom
