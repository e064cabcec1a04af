#pragma once

namespace fathom {

class ReviewPane;
class Session;

/// What the settings of a tool need beside the structure's name, in sizes of the text.
inline constexpr float kToolOptionsWidth = 34.0F;

/// Settings of the tool in hand, on the line of the cursor; "Take" and "Drop" where it proposes outlines.
void draw_tool_options(Session& session, ReviewPane& review);

}  // namespace fathom
