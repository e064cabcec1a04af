#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include <imgui.h>

#include "viewer/application.h"
#include "viewer/first_steps.h"
#include "viewer/timeline_pane.h"
#include "viewer/tool_options.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

struct ToolText {
  Tool tool;
  const char* label;
  const char* tip;
};

constexpr std::array<ToolText, kToolCount> kTools{
    {{Tool::kBrowse, "Browse", "Look: drag moves the image (B)"},
     {Tool::kDraw, "Draw", "Outline: drag free-hand, or click point by point; Enter closes (D)"},
     {Tool::kWire, "Wire", "Click along the border; between clicks the line follows the edges (E)"},
     {Tool::kRegion, "Region", "Click inside: the region around grows to its border; Enter takes it (K)"},
     {Tool::kThreshold, "Threshold", "Outlines of grey values in a range; click parts to take only those (I)"},
     {Tool::kRefine, "Refine", "Moves the outlines of this frame to the border beside them; Enter takes them (J)"},
     {Tool::kPoints, "Points", "Drag points; click on the line to insert one; Delete removes (P)"},
     {Tool::kBrush, "Push", "Push the outline with a round brush; [ and ] change its size (U)"},
     {Tool::kExtremity, "Extremity", "Mark where the frame only touches the structure (X)"},
     {Tool::kDistance, "Distance", "Two points (M)"},
     {Tool::kAngle, "Angle", "Three points, the second at the corner (N)"},
     {Tool::kArea, "Area", "Points around it (R)"}}};

constexpr ImGuiWindowFlags kPane = ImGuiWindowFlags_NoScrollWithMouse;

bool begin_pane(const char* name, ImVec2 low, ImVec2 size, ImGuiWindowFlags flags = kPane) {
  ImGui::SetCursorScreenPos(low);
  return ImGui::BeginChild(name, {std::max(size.x, 1.0F), std::max(size.y, 1.0F)}, false, flags);
}

}  // namespace

void Application::draw_menu_bar() {
  if (!ImGui::BeginMenuBar()) return;
  draw_menus(actions_);
  ImGui::EndMenuBar();
}

void Application::draw_toolbar() {
  const float em = ui::em();
  for (const ToolText& tool : kTools) {
    const bool on = session_.view.tool == tool.tool;
    if (ui::button(tool.label, tool.tip, on, session_.document() != nullptr)) review_.choose(session_, tool.tool);
    ImGui::SameLine();
  }
  ImGui::SameLine(0.0F, em);
  if (ui::button("Live", "Record from devices (F4)", live_shown_)) show_live(!live_shown_);
  const Document* document = session_.document();
  std::vector<std::string> names;
  if (document != nullptr) {
    for (const Structure& structure : document->structures()) names.push_back(structure.name);
  }
  int active = static_cast<int>(session_.active_structure().value_or(0));
  // In a narrow window on a line of its own, whatever tool is in hand: the panes must not jump.
  const float end = ImGui::GetItemRectMax().x + (11.0F + kToolOptionsWidth) * em;
  if (end < ImGui::GetIO().DisplaySize.x) ImGui::SameLine(0.0F, em);
  if (ui::combo("##structure", active, names, 10.0F * em)) session_.view.structure = static_cast<std::size_t>(active);
  ui::tip("The structure that tools work on");
  draw_tool_options(session_, review_);
}

void Application::draw_panes() {
  const ImGuiIO& io = ImGui::GetIO();
  ImGui::SetNextWindowPos({0.0F, 0.0F});
  ImGui::SetNextWindowSize(io.DisplaySize);
  constexpr ImGuiWindowFlags kMain = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                     ImGuiWindowFlags_MenuBar | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoScrollWithMouse |
                                     ImGuiWindowFlags_NoNav;
  ImGui::Begin("Fathom", nullptr, kMain);
  draw_menu_bar();
  draw_toolbar();
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const float bar = ui::kSplitter * ui::em() / 15.0F;
  const float status = 1.6F * ui::em();
  const ImVec2 whole(io.DisplaySize.x - 2.0F * low.x, io.DisplaySize.y - low.y - status);
  const float main = settings_.show_timeline ? std::round(whole.y * settings_.main) : whole.y;
  const bool right_side = settings_.show_outline || settings_.show_reslice || settings_.show_measurements;
  const float left = right_side ? std::round(whole.x * settings_.left) : whole.x;

  begin_pane("Review", low, {left - (right_side ? bar : 0.0F), main - bar});
  if (!live_shown_) {
    if (session_.document() == nullptr) draw_welcome(actions_, session_.view.hides_names);
    review_.draw(session_, window_->pointer_path());
  } else if (live_.draw(session_, settings_)) {
    show_live(false);
  }
  if (live_shown_) ui::note("pane:Live", low, {low.x + left - (right_side ? bar : 0.0F), low.y + main - bar});
  ImGui::EndChild();
  if (right_side) {
    ui::splitter("split:left", true, {low.x + left - bar, low.y}, main - bar, whole.x, settings_.left);
    draw_right_side({low.x + left, low.y}, {whole.x - left, main - bar});
  }
  if (settings_.show_timeline) {
    ui::splitter("split:main", false, {low.x, low.y + main - bar}, whole.x, whole.y, settings_.main);
    begin_pane("Timeline", {low.x, low.y + main}, {whole.x, whole.y - main});
    draw_first_steps("Timeline");
    draw_timeline(session_);
    ImGui::EndChild();
  }
  ImGui::SetCursorScreenPos({low.x, low.y + whole.y + 2.0F});
  draw_status();
  ImGui::End();
}

// Before the pane's own things, which are none as long as these are there.
void Application::draw_first_steps(const char* pane) {
  const Document* document = session_.document();
  if (document == nullptr) draw_purpose(pane);
  if (document != nullptr && !document->is_calibrated() && std::string_view(pane) == "Outline") {
    draw_calibration_missing(session_, actions_);
  }
}

void Application::draw_right_side(ImVec2 low, ImVec2 size) {
  const float bar = ui::kSplitter * ui::em() / 15.0F;
  const bool middle = settings_.show_outline || settings_.show_reslice;
  const bool last = settings_.show_measurements;
  const float width = !middle ? 0.0F : last ? std::round(size.x * settings_.middle) : size.x;
  const bool both = settings_.show_outline && settings_.show_reslice;
  const float upper = both ? std::round(size.y * settings_.upper) : settings_.show_outline ? size.y : 0.0F;
  const float inner = width - (last ? bar : 0.0F);
  if (settings_.show_outline) {
    begin_pane("Outline", low, {inner, upper - (both ? bar : 0.0F)});
    draw_first_steps("Outline");
    outline_.draw(session_);
    ImGui::EndChild();
  }
  if (settings_.show_reslice) {
    begin_pane("Reslice", {low.x, low.y + upper}, {inner, size.y - upper});
    draw_first_steps("Reslice");
    reslice_.draw(session_);
    ImGui::EndChild();
  }
  if (both) ui::splitter("split:upper", false, {low.x, low.y + upper - bar}, inner, size.y, settings_.upper);
  if (middle && last) {
    ui::splitter("split:middle", true, {low.x + width - bar, low.y}, size.y, size.x, settings_.middle);
  }
  if (last) {
    begin_pane("Measurements", {low.x + width, low.y}, {size.x - width, size.y}, 0);
    draw_first_steps("Measurements");
    measurements_.draw(session_);
    ImGui::EndChild();
  }
}

void Application::draw_status() {
  const Document* document = session_.document();
  if (!session_.view.hides_names) bars_.draw(session_);  // what is done may have a file's name
  if (document == nullptr) {
    ImGui::TextUnformatted("F1 shows the keys");
    return;
  }
  if (session_.view.hides_names) return;
  ImGui::Text("%s%s", document->title().c_str(), document->is_modified() ? " *" : "");
}

void Application::draw_messages() {
  std::vector<Message>& messages = session_.messages();
  if (messages.empty()) return;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5F * screen.x, screen.y - 2.5F * ui::em()}, ImGuiCond_Always, {0.5F, 1.0F});
  ImGui::SetNextWindowSizeConstraints({0.3F * screen.x, 0.0F}, {0.7F * screen.x, 0.5F * screen.y});
  ImGui::SetNextWindowBgAlpha(0.95F);
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_AlwaysAutoResize |
                                      ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                                      ImGuiWindowFlags_NoFocusOnAppearing;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1.0F);
  if (ImGui::Begin("##messages", nullptr, kFlags)) {
    ui::note("pane:Messages", ImGui::GetWindowPos(),
             {ImGui::GetWindowPos().x + ImGui::GetWindowWidth(), ImGui::GetWindowPos().y + ImGui::GetWindowHeight()});
    for (std::size_t i = 0; i < messages.size(); ++i) {
      ImGui::PushID(static_cast<int>(i));
      ImGui::PushStyleColor(ImGuiCol_Text,
                            messages[i].is_error ? IM_COL32(255, 110, 100, 255) : IM_COL32(240, 180, 70, 255));
      ImGui::TextWrapped("%s: %s", messages[i].about.c_str(), messages[i].text.c_str());
      ImGui::PopStyleColor();
      if (ui::button("Copy")) ImGui::SetClipboardText(messages[i].text.c_str());
      ImGui::SameLine();
      if (ui::button("Dismiss")) {
        messages.erase(messages.begin() + static_cast<std::ptrdiff_t>(i));
        ImGui::PopID();
        break;
      }
      ImGui::PopID();
    }
  }
  ImGui::End();
  ImGui::PopStyleVar();
}

void Application::draw_recover_question() {
  Document* document = session_.document();
  if (document == nullptr || !document->unsaved_work()) return;
  ImGui::OpenPopup("Unsaved work");
  if (!ImGui::BeginPopupModal("Unsaved work", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  const std::size_t actions = document->unsaved_work()->actions;
  ImGui::Text("The last session with %s ended before it was saved.", document->title().c_str());
  ImGui::Text("%zu %s of it can be done again; they can be undone as before.", actions,
              actions == 1 ? "action" : "actions");
  if (ui::button("Recover")) {
    session_.attempt(document->title(), [&] { document->recover(); });
    ImGui::CloseCurrentPopup();
  }
  ImGui::SameLine();
  if (ui::button("Discard")) {
    session_.attempt(document->title(), [&] { document->discard_unsaved(); });
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Application::draw_close_question() {
  if (!asks_to_close_) return;
  ImGui::OpenPopup("Not saved");
  if (!ImGui::BeginPopupModal("Not saved", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  ImGui::Text("%s has changes that are not saved.", session_.document()->title().c_str());
  if (ui::button("Save and close")) {
    asks_to_close_ = false;
    ImGui::CloseCurrentPopup();
    save();
    done_ = session_.document()->has_folder() && !session_.document()->is_modified();
  }
  ImGui::SameLine();
  if (ui::button("Close without saving")) done_ = true;
  ImGui::SameLine();
  if (ui::button("Back")) {
    asks_to_close_ = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace fathom
