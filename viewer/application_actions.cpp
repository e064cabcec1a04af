#include <algorithm>

#include "measurement/propagate.h"
#include "viewer/application.h"
#include "viewer/export_jobs.h"
#include "viewer/review_tools.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace fathom {

namespace {

constexpr float kBrushStep = 1.2F;
constexpr float kScaleStep = 0.1F;
constexpr int kFarStep = 10;

// The nearest frame before or behind the shown one on which the active structure is marked; or, of those, on which an
// outline that was filled in is unsure.
std::optional<int> next_outlined(const Session& session, bool forward, bool unsure = false) {
  const auto active = session.active_structure();
  if (!active) return std::nullopt;
  std::optional<int> best;
  const auto offer = [&](int recording, int frame) {
    if (recording != session.view.recording) return;
    const bool on_side = forward ? frame > session.view.frame : frame < session.view.frame;
    if (on_side && (!best || (forward ? frame < *best : frame > *best))) best = frame;
  };
  const Structure& structure = session.document()->structures()[*active];
  for (const Contour& contour : structure.contours) {
    if (!unsure || contour.confidence.value_or(1.0) < kSureContour) offer(contour.recording, contour.frame);
  }
  if (unsure) return best;
  for (const Extremity& extremity : structure.extremities) offer(extremity.recording, extremity.frame);
  return best;
}

void toggle_absent(Session& session) {
  session.attempt("absent mark", [&] {
    Document& document = *session.document();
    document.begin_action("Mark absent");
    const std::size_t structure = session.require_structure();
    const std::vector<AbsentMark>& marks = document.structures()[structure].absent;
    const bool is_marked = std::any_of(marks.begin(), marks.end(), [&](const AbsentMark& mark) {
      return mark.frame == session.view.frame && mark.recording == session.view.recording;
    });
    document.set_absent(structure, session.view.recording, session.view.frame, !is_marked);
    document.end_action();
  });
}

void step_back(Session& session, ReviewPane& review) {
  if (review.step_back(session)) return;
  session.attempt("undo", [&] { session.document()->undo(); });
  session.view.chosen.reset();
}

struct ToolKey {
  Tool tool;
  const char* label;
  int key;
};
constexpr std::array<ToolKey, kToolCount> kToolKeys{{{Tool::kBrowse, "Browse", GLFW_KEY_B},
                                                     {Tool::kDraw, "Draw outline", GLFW_KEY_D},
                                                     {Tool::kWire, "Wire along edges", GLFW_KEY_E},
                                                     {Tool::kRegion, "Fill region", GLFW_KEY_K},
                                                     {Tool::kThreshold, "Outline by threshold", GLFW_KEY_I},
                                                     {Tool::kRefine, "Refine outline", GLFW_KEY_J},
                                                     {Tool::kPoints, "Edit points", GLFW_KEY_P},
                                                     {Tool::kBrush, "Push outline", GLFW_KEY_U},
                                                     {Tool::kExtremity, "Mark extremity", GLFW_KEY_X},
                                                     {Tool::kDistance, "Distance", GLFW_KEY_M},
                                                     {Tool::kAngle, "Angle", GLFW_KEY_N},
                                                     {Tool::kArea, "Area", GLFW_KEY_R}}};

}  // namespace

std::vector<Action> make_actions(Application& app) {
  Session& session = app.session_;
  Settings& settings = app.settings_;
  std::vector<Action> actions;
  const auto open = [&session] { return session.document() != nullptr; };
  const auto add = [&](const char* menu, std::string label, KeyChord key, std::string about, std::function<void()> run,
                       std::function<bool()> enabled = {}, std::function<bool()> checked = {}, bool repeats = false) {
    actions.push_back({menu, std::move(label), key, std::move(about), std::move(run), std::move(enabled),
                       std::move(checked), repeats});
  };
  const auto ctrl = [](int key, bool shift = false) { return KeyChord{key, true, shift, false}; };
  const auto plain = [](int key, bool shift = false) { return KeyChord{key, false, shift, false}; };

  add("File", "Open...", ctrl(GLFW_KEY_O), "an exam or a recording", [&app] {
    app.files_.ask("Open", "Open", "", [&app](const std::filesystem::path& path) { app.open_dropped(path); });
  });
  add(
      "File", "Calibration...", {}, "where the image lies relative to the probe",
      [&app, &session] {
        app.files_.ask("Calibration", "Use", "", [&session](const std::filesystem::path& path) {
          session.attempt(path.filename().string(), [&] { session.document()->set_calibration(path); });
        });
      },
      open);
  add(
      "File", "Save", ctrl(GLFW_KEY_S), "", [&app] { app.save(); }, open);
  add(
      "File", "Save as...", ctrl(GLFW_KEY_S, true), "an exam in a folder of its own", [&app] { app.ask_save_as(); },
      open);
  const auto ask_export = [&app, &session](bool anonymous) {
    app.files_.ask(
        "Export to a folder", "Export", "report",
        [&session, anonymous](const std::filesystem::path& folder) { export_document(session, folder, anonymous); });
  };
  add(
      "File", "Export...", ctrl(GLFW_KEY_E), "results, a report, surfaces and pictures",
      [ask_export] { ask_export(false); }, open);
  add(
      "File", "Export without names...", {},
      "the same without patient, operator, date and notes; of B-scans only the box around an area drawn by Area (R)",
      [ask_export] { ask_export(true); }, open);
  add("File", "Picture...", ctrl(GLFW_KEY_P), "of the window or a pane, on request without names",
      [&app] { app.pictures_.ask(); });
  add(
      "File", "Close exam", ctrl(GLFW_KEY_W), "", [&session] { session.close(); }, open);
  add("File", "Quit", ctrl(GLFW_KEY_Q), "", [&app] { app.close_or_ask(); });

  add(
      "Edit", "Undo", ctrl(GLFW_KEY_Z), "or take back the last point of the line being drawn",
      [&session, &app] { step_back(session, app.review_); }, open, {}, true);
  add(
      "Edit", "Redo", ctrl(GLFW_KEY_Y), "",
      [&session] {
        session.view.chosen.reset();
        session.attempt("redo", [&] { session.document()->redo(); });
      },
      open, {}, true);
  add(
      "Edit", "Delete", plain(GLFW_KEY_DELETE), "the chosen point", [&session] { ReviewTools::remove_chosen(session); },
      open);
  add(
      "Edit", "Clear frame", plain(GLFW_KEY_DELETE, true), "all outlines and marks of the structure on this frame",
      [&session] { ReviewTools::clear_frame(session); }, open);
  add(
      "Edit", "Fill between", plain(GLFW_KEY_T), "outlines on all frames between those drawn of the structure",
      [&session] { fill_between(session); }, open);
  add(
      "Edit", "Absent here", plain(GLFW_KEY_A),
      "looked for the structure, it is not on this frame; again takes the mark away",
      [&session] { toggle_absent(session); }, open);
  add(
      "Edit", "Close the line", plain(GLFW_KEY_ENTER), "that is being drawn, or take what a tool proposes",
      [&session, &app] { app.review_.finish(session); }, open);
  add(
      "Edit", "Take back point", plain(GLFW_KEY_BACKSPACE), "the last one of the line being drawn, or the last seed",
      [&session, &app] { app.review_.step_back(session); }, open, {}, true);
  add(
      "Edit", "Give up", plain(GLFW_KEY_ESCAPE), "the line or ruler being drawn, or what a tool proposes",
      [&session, &app] { app.review_.give_up(session); }, open);

  for (const ToolKey& tool : kToolKeys) {
    add(
        "Tools", tool.label, plain(tool.key), "", [&session, &app, tool] { app.review_.choose(session, tool.tool); },
        open, [&session, tool] { return session.view.tool == tool.tool; });
  }
  add(
      "Tools", "Smaller brush", plain(GLFW_KEY_LEFT_BRACKET), "", [&session] { session.view.brush_px /= kBrushStep; },
      open, {}, true);
  add(
      "Tools", "Larger brush", plain(GLFW_KEY_RIGHT_BRACKET), "", [&session] { session.view.brush_px *= kBrushStep; },
      open, {}, true);

  struct FrameKey {
    const char* label;
    KeyChord key;
    int step;
  };
  for (const FrameKey& step : {FrameKey{"Next frame", plain(GLFW_KEY_RIGHT), 1},
                               {"Previous frame", plain(GLFW_KEY_LEFT), -1},
                               {"Ten frames on", plain(GLFW_KEY_PAGE_DOWN), kFarStep},
                               {"Ten frames back", plain(GLFW_KEY_PAGE_UP), -kFarStep},
                               {"First frame", plain(GLFW_KEY_HOME), -(1 << 28)},
                               {"Last frame", plain(GLFW_KEY_END), 1 << 28}}) {
    add(
        "Go", step.label, step.key, "", [&session, step] { session.show_frame(session.view.frame + step.step); }, open,
        {}, true);
  }
  struct OutlinedKey {
    const char* label;
    KeyChord key;
    bool forward;
    bool unsure;
  };
  for (const OutlinedKey& to : {OutlinedKey{"Next outlined frame", ctrl(GLFW_KEY_RIGHT), true, false},
                                {"Previous outlined frame", ctrl(GLFW_KEY_LEFT), false, false},
                                {"Next unsure frame", plain(GLFW_KEY_RIGHT, true), true, true},
                                {"Previous unsure frame", plain(GLFW_KEY_LEFT, true), false, true}}) {
    add(
        "Go", to.label, to.key, to.unsure ? "whose outline was filled in and may be wrong" : "",
        [&session, to] {
          if (const auto frame = next_outlined(session, to.forward, to.unsure)) session.show_frame(*frame);
        },
        open, {}, true);
  }

  add(
      "View", "Whole image", plain(GLFW_KEY_F), "", [&session] { session.view.zoom = 0.0F; }, open);
  add(
      "View", "Usual grey values", plain(GLFW_KEY_W), "window 255, level 127.5",
      [&session] {
        session.view.window = 255.0F;
        session.view.level = 127.5F;
      },
      open);
  const auto flag = [&](const char* label, KeyChord key, bool ViewState::*member) {
    add(
        "View", label, key, "", [&session, member] { session.view.*member = !(session.view.*member); }, open,
        [&session, member] { return session.view.*member; });
  };
  flag("Outlines", plain(GLFW_KEY_O), &ViewState::show_outlines);
  flag("Hatching", plain(GLFW_KEY_H), &ViewState::show_hatching);
  flag("Surfaces", plain(GLFW_KEY_S), &ViewState::show_surfaces);
  flag("Frames in space", plain(GLFW_KEY_G), &ViewState::show_posts);
  flag("Dividing planes", plain(GLFW_KEY_L), &ViewState::show_planes);
  add(
      "View", "All of space", plain(GLFW_KEY_V), "as reports show it",
      [&app] { app.outline_.look_at_all(app.session_); }, open);
  add(
      "View", "Along x", plain(GLFW_KEY_1), "", [&app] { app.outline_.look_along(0); }, open);
  add(
      "View", "Along y", plain(GLFW_KEY_2), "", [&app] { app.outline_.look_along(1); }, open);
  add(
      "View", "Along z", plain(GLFW_KEY_3), "", [&app] { app.outline_.look_along(2); }, open);

  add(
      "Window", "Live", plain(GLFW_KEY_F4), "record from devices, in place of Review",
      [&app] { app.show_live(!app.live_shown_); }, {}, [&app] { return app.live_shown_; });
  const auto pane = [&](const char* label, int key, bool Settings::*member) {
    add(
        "Window", label, plain(key), "show or hide this pane",
        [&settings, member] { settings.*member = !(settings.*member); }, {},
        [&settings, member] { return settings.*member; });
  };
  pane("Outline pane", GLFW_KEY_F5, &Settings::show_outline);
  pane("Reslice pane", GLFW_KEY_F6, &Settings::show_reslice);
  pane("Measurements pane", GLFW_KEY_F7, &Settings::show_measurements);
  pane("Timeline pane", GLFW_KEY_F8, &Settings::show_timeline);
  add(
      "Window", "Light", ctrl(GLFW_KEY_L), "light instead of dark colours",
      [&app, &settings] {
        settings.dark = !settings.dark;
        app.look_changed_ = true;
      },
      {}, [&settings] { return !settings.dark; });
  const auto rescale = [&app, &settings](float step) {
    const float now = settings.scale > 0.0F ? settings.scale : app.window_->display_scale();
    settings.scale = std::clamp(now + step, 0.7F, 3.0F);
    app.look_changed_ = true;
  };
  add("Window", "Larger texts", ctrl(GLFW_KEY_EQUAL), "", [rescale] { rescale(kScaleStep); });
  add("Window", "Smaller texts", ctrl(GLFW_KEY_MINUS), "", [rescale] { rescale(-kScaleStep); });
  add("Help", "Keys and mouse", plain(GLFW_KEY_F1), "this page", [&app] { app.help_ = !app.help_; });
  return actions;
}

}  // namespace fathom
