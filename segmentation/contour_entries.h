#pragma once

#include <string>

#include "segmentation/contours.h"

namespace fathom {

class JsonValue;

// The parts of a contours file, for other files that hold such parts.

/// The text of one entry, in one line.
std::string entry_json(const Contour& contour);
std::string entry_json(const Extremity& extremity);
std::string entry_json(const AbsentMark& mark);

/// The text of a structure, whose entries begin with `line_start`: empty to have all in one line.
std::string structure_json(const Structure& structure, const std::string& line_start);

/// Adds an entry to a structure. Throws Error as read_contours.
void read_entry(const JsonValue& value, Structure& structure);

/// "#rrggbb"; an opacity in [0, 1]. Throw Error for anything else.
std::string read_color(const JsonValue& value);
double read_opacity(const JsonValue& value);

/// Throws Error as read_contours.
Structure read_structure(const JsonValue& value);

}  // namespace fathom
