#include "viewer/tool_options.h"

#include <algorithm>

#include <imgui.h>

#include "viewer/review_pane.h"
#include "viewer/session.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

void draw_even_out(ViewState& view, float em) {
  ImGui::SameLine();
  ui::slider("##even out", view.assist.even_out_px, 0.0F, 12.0F, "even out %.1f px", 9.0F * em);
  ui::tip("Evens out speckle before grey values are compared");
}

void draw_region_options(ViewState& view, float em) {
  ui::slider("##tolerance", view.assist.tolerance, 0.5F, 8.0F, "up to %.1f sd", 12.0F * em);
  ui::tip("How far grey values may be from the region's mean, in its standard deviations");
  draw_even_out(view, em);
}

void draw_threshold_options(ViewState& view, float em) {
  AssistOptions& assist = view.assist;
  if (ui::slider("##low", assist.low, view.grey_low, view.grey_high, "from %.0f", 8.0F * em)) {
    assist.high = std::max(assist.high, assist.low);
  }
  ui::tip("At its left end there is no lower limit");
  ImGui::SameLine();
  if (ui::slider("##high", assist.high, view.grey_low, view.grey_high, "to %.0f", 8.0F * em)) {
    assist.low = std::min(assist.low, assist.high);
  }
  ui::tip("At its right end there is no upper limit");
  draw_even_out(view, em);
}

void draw_refine_options(ViewState& view, float em) {
  ui::slider("##reach", view.assist.reach_px, 1.0F, 40.0F, "reach %.0f px", 12.0F * em);
  ui::tip("No point moves farther");
}

void draw_brush_options(ViewState& view, float em) {
  ui::slider("##brush", view.brush_px, 3.0F, 200.0F, "%.0f px", 8.0F * em);
}

struct ToolSettings {
  Tool tool;
  void (*draw)(ViewState& view, float em);
};
constexpr std::array<ToolSettings, 4> kSettings{{{Tool::kRegion, draw_region_options},
                                                 {Tool::kThreshold, draw_threshold_options},
                                                 {Tool::kRefine, draw_refine_options},
                                                 {Tool::kBrush, draw_brush_options}}};

}  // namespace

void draw_tool_options(Session& session, ReviewPane& review) {
  ViewState& view = session.view;
  for (const ToolSettings& settings : kSettings) {
    if (settings.tool != view.tool) continue;
    ImGui::SameLine();
    settings.draw(view, ui::em());
  }
  if (!is_assist(view.tool)) return;
  const bool any = !view.preview_px.empty();
  ImGui::SameLine();
  if (ui::button("Take", "What is proposed becomes part of the exam (Enter)", false, any)) review.finish(session);
  ImGui::SameLine();
  if (ui::button("Drop", "What is proposed (Escape)", false, any)) review.give_up(session);
}

}  // namespace fathom
