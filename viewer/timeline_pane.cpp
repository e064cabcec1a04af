#include "viewer/timeline_pane.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <imgui.h>

#include "core/error.h"
#include "measurement/propagate.h"
#include "viewer/look.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr float kRest_s = 1.2F;  // before the pane is explained

// Where frames lie along the bar.
struct Track {
  ImVec2 low;
  ImVec2 size;
  int frames = 1;

  float x(double frame) const {
    return low.x + size.x * static_cast<float>((frame + 0.5) / static_cast<double>(frames));
  }
  float half() const { return std::max(0.5F * size.x / static_cast<float>(frames), 1.0F); }
};

void draw_sweeps(const Session& session, const Track& track, float y, float height, ImDrawList& list) {
  std::vector<Sweep> sweeps = session.document()->content().sweeps;
  try {
    const std::optional<Division>& division = session.document()->division();
    if (division) sweeps = division->sweeps;
  } catch (const Error&) {
    // Said where the volume is.
  }
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    if (sweeps[i].recording != static_cast<std::size_t>(session.view.recording)) continue;
    const ImVec2 low(track.x(sweeps[i].first) - track.half(), y);
    const ImVec2 high(track.x(sweeps[i].last) + track.half(), y + height);
    list.AddRectFilled(low, high, i % 2 == 0 ? IM_COL32(70, 110, 160, 160) : IM_COL32(90, 150, 110, 160), 3.0F);
    const std::string name = "sweep " + std::to_string(i + 1);
    if (ImGui::CalcTextSize(name.c_str()).x < high.x - low.x) {
      list.AddText({low.x + 4.0F, y}, IM_COL32(255, 255, 255, 255), name.c_str());
    }
  }
}

// Neighbours that are alike become one bar.
template <typename Test>
void draw_runs(const Track& track, float y, float height, ImU32 color, ImDrawList& list, const Test& test) {
  for (int frame = 0; frame < track.frames; ++frame) {
    if (!test(frame)) continue;
    const int first = frame;
    while (frame + 1 < track.frames && test(frame + 1)) ++frame;
    list.AddRectFilled({track.x(first) - track.half(), y}, {track.x(frame) + track.half(), y + height}, color);
  }
}

void draw_structures(const Session& session, const Track& track, float y, float height, ImDrawList& list) {
  const std::vector<Structure>& structures = session.document()->structures();
  if (structures.empty()) return;
  const float row = height / static_cast<float>(structures.size());
  const int recording = session.view.recording;
  for (const Structure& structure : structures) {
    const ImU32 color = packed_color(structure.color.c_str());
    const ImU32 filled = packed_color(structure.color.c_str(), 0.5F);
    const float half = std::max(track.half(), 1.5F);
    for (const Contour& contour : structure.contours) {
      if (contour.recording != recording) continue;
      const float x = track.x(contour.frame);
      list.AddRectFilled({x - half, y}, {x + half, y + row - 1.0F}, contour.confidence ? filled : color);
      if (!contour.confidence || *contour.confidence >= kSureContour) continue;
      list.AddRectFilled({x - half, y}, {x + half, y + 0.3F * row}, IM_COL32(240, 120, 40, 255));
    }
    for (const Extremity& extremity : structure.extremities) {
      if (extremity.recording != recording) continue;
      list.AddCircle({track.x(extremity.frame), y + 0.5F * row}, std::max(0.35F * row, 2.0F), color, 0, 1.5F);
    }
    for (const AbsentMark& mark : structure.absent) {
      if (mark.recording != recording) continue;
      const float x = track.x(mark.frame);
      list.AddLine({x - 3.0F, y + row - 1.0F}, {x + 3.0F, y}, color, 1.5F);
    }
    y += row;
  }
}

// Whether the pointer has been still on the item for a while: who goes through frames needs no explanation.
bool has_rested(bool hovered) {
  float& rested_s = *ImGui::GetStateStorage()->GetFloatRef(ImGui::GetID("rested"));
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  const bool still = hovered && moved.x == 0.0F && moved.y == 0.0F;
  rested_s = still ? rested_s + ImGui::GetIO().DeltaTime : 0.0F;
  return rested_s > kRest_s;
}

}  // namespace

void draw_timeline(Session& session) {
  const RecordingHeader* header = session.header();
  if (header == nullptr || header->frame_count() == 0) return;
  const float em = ui::em();
  const std::size_t recordings = session.document()->scan()->recordings.size();
  if (recordings > 1) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < recordings; ++i) names.push_back("recording " + std::to_string(i + 1));
    int shown = session.view.recording;
    if (ui::combo("##recording", shown, names, 9.0F * em)) session.show_recording(shown);
    ImGui::SameLine();
  }
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 size = ImGui::GetContentRegionAvail();
  if (size.x < 10.0F || size.y < 10.0F) return;
  ImGui::InvisibleButton("frames", size);
  ui::note("pane:Timeline", low, {low.x + size.x, low.y + size.y});
  const Track track{low, size, header->frame_count()};
  if (ImGui::IsItemActive()) {
    const float along = (ImGui::GetIO().MousePos.x - low.x) / size.x;
    session.show_frame(static_cast<int>(std::floor(along * static_cast<float>(track.frames))));
  }
  if (ImGui::IsItemHovered() && ImGui::GetIO().MouseWheel != 0.0F) {
    session.show_frame(session.view.frame - static_cast<int>(std::lround(ImGui::GetIO().MouseWheel)));
  }

  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.PushClipRect(low, {low.x + size.x, low.y + size.y}, true);
  list.AddRectFilled(low, {low.x + size.x, low.y + size.y}, ImGui::GetColorU32(ImGuiCol_FrameBg), 3.0F);
  const float sweep_height = std::min(1.2F * em, 0.35F * size.y);
  draw_sweeps(session, track, low.y, sweep_height, list);
  const float state_height = std::max(0.12F * size.y, 3.0F);
  const float state_y = low.y + sweep_height + 2.0F;
  draw_runs(track, state_y, state_height, IM_COL32(220, 70, 70, 255), list,
            [&](int frame) { return !header->frames[static_cast<std::size_t>(frame)].image_valid(); });
  if (session.document()->is_calibrated()) {
    const FrameLocator& locator =
        session.document()->scan()->locators[static_cast<std::size_t>(session.view.recording)];
    draw_runs(track, state_y, state_height, IM_COL32(220, 140, 50, 255), list, [&](int frame) {
      return header->frames[static_cast<std::size_t>(frame)].image_valid() && !locator.reference_from_image(frame);
    });
  }
  const float structures_y = state_y + state_height + 2.0F;
  draw_structures(session, track, structures_y, low.y + size.y - structures_y, list);
  const float x = track.x(session.view.frame);
  list.AddLine({x, low.y}, {x, low.y + size.y}, IM_COL32(255, 235, 60, 255), 2.0F);
  list.PopClipRect();
  if (has_rested(ImGui::IsItemHovered() && !ImGui::IsItemActive())) {
    // Above the frames, which it would hide.
    ImGui::SetNextWindowPos({ImGui::GetIO().MousePos.x, low.y - 0.3F * em}, ImGuiCond_Always, {0.5F, 1.0F});
    ImGui::SetTooltip(
        "Red: image invalid. Orange: no pose. Below: outlined frames, pale where filled in between, orange on top "
        "where that is unsure; circles: extremities; strokes: absent.");
  }
}

}  // namespace fathom
