#include "viewer/look.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <imgui.h>

namespace fathom {

namespace {

constexpr float kFontPixels = 15.0F;
constexpr std::array<const char*, 3> kFonts{"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                            "/usr/share/fonts/dejavu/DejaVuSans.ttf",
                                            "/usr/share/fonts/TTF/DejaVuSans.ttf"};
// Latin with accents, Greek, and the signs that the viewer's own texts use.
constexpr std::array<ImWchar, 11> kGlyphs{0x20, 0x17f, 0x370, 0x3ff, 0x2010, 0x2027, 0x2190, 0x2193, 0x25a0, 0x25ff, 0};

}  // namespace

void load_look_font(float scale) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  const float pixels = std::round(kFontPixels * scale);
  for (const char* path : kFonts) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) continue;
    if (atlas.AddFontFromFileTTF(path, pixels, nullptr, kGlyphs.data()) != nullptr) return;
  }
  ImFontConfig config;
  config.SizePixels = pixels;
  atlas.AddFontDefault(&config);
}

void apply_look(bool dark, float scale) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  if (dark) {
    ImGui::StyleColorsDark();
    style.Colors[ImGuiCol_WindowBg] = ImVec4(0.10F, 0.11F, 0.12F, 1.0F);
    style.Colors[ImGuiCol_ChildBg] = ImVec4(0.10F, 0.11F, 0.12F, 1.0F);
    style.Colors[ImGuiCol_MenuBarBg] = ImVec4(0.15F, 0.16F, 0.18F, 1.0F);
  } else {
    ImGui::StyleColorsLight();
    style.Colors[ImGuiCol_WindowBg] = ImVec4(0.94F, 0.94F, 0.94F, 1.0F);
    style.Colors[ImGuiCol_ChildBg] = ImVec4(0.94F, 0.94F, 0.94F, 1.0F);
  }
  style.WindowRounding = 0.0F;
  style.FrameRounding = 3.0F;
  style.WindowBorderSize = 0.0F;
  style.WindowPadding = ImVec2(6.0F, 6.0F);
  style.ItemSpacing = ImVec2(6.0F, 4.0F);
  style.ScaleAllSizes(scale);
}

unsigned packed_color(const char* color, float alpha) {
  unsigned red = 128;
  unsigned green = 128;
  unsigned blue = 128;
  std::sscanf(color, "#%2x%2x%2x", &red, &green, &blue);
  const auto opacity = static_cast<unsigned>(std::lround(255.0F * alpha));
  return IM_COL32(red, green, blue, opacity);
}

}  // namespace fathom
