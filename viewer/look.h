#pragma once

namespace fathom {

/// Colours and sizes of everything drawn with Dear ImGui. `scale` is that of the texts.
void apply_look(bool dark, float scale);

/// Loads the system's DejaVu where there is one, else Dear ImGui's own font; `scale` 1 is 15 pixels.
void load_look_font(float scale);

/// A colour "#rrggbb" as Dear ImGui packs it; grey where it is none.
unsigned packed_color(const char* color, float alpha = 1.0F);

}  // namespace fathom
