#include "viewer/live_pane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

#include <imgui.h>
#include <opencv2/imgproc.hpp>

#include "core/numbers.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr ImU32 kGood = IM_COL32(110, 220, 120, 255);
constexpr ImU32 kDoubtful = IM_COL32(240, 180, 70, 255);
constexpr ImU32 kBad = IM_COL32(255, 110, 100, 255);
constexpr double kStale_s = 1.0;

void colored(ImU32 color, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

const char* text_of(SourceState state) {
  constexpr std::array<const char*, 4> kTexts{"connecting", "running", "ended", "failed"};
  return kTexts[static_cast<std::size_t>(state)];
}

const char* text_of(const RecorderStatus& status, bool gated) {
  switch (status.state) {
    case RecorderState::kPaused:
      return "paused";
    case RecorderState::kWaiting:
      return "hold the probe still";
    case RecorderState::kRecording:
      return gated && status.gate == GateState::kReady ? "sweep now" : "recording";
    case RecorderState::kEnded:
      return "ended";
  }
  return "";
}

std::string free_folder_name() {
  const std::time_t now = std::time(nullptr);
  std::tm parts = {};
  ::localtime_r(&now, &parts);
  char text[40];
  std::strftime(text, sizeof text, "recording-%Y%m%d-%H%M%S", &parts);
  return text;
}

void stream_line(const char* what, const StreamStatistics& stream) {
  std::string text = std::string(what) + ": " + text_of(stream.state) + ", " + format_rounded(stream.rate_hz, 1) +
                     " / s, " + std::to_string(stream.received) + " received";
  if (stream.lost > 0) text += ", " + std::to_string(stream.lost) + " lost";
  if (stream.dropped > 0) text += ", " + std::to_string(stream.dropped) + " dropped";
  const bool stale = stream.age_s && *stream.age_s > kStale_s;
  const ImU32 color = stream.state == SourceState::kFailed             ? kBad
                      : stream.state != SourceState::kRunning || stale ? kDoubtful
                                                                       : kGood;
  colored(color, text);
  if (!stream.message.empty() && stream.state != SourceState::kRunning) colored(color, stream.message);
}

}  // namespace

bool LivePane::draw(Session& session, Settings& settings) {
  const float width = std::min(22.0F * ui::em(), 0.5F * ImGui::GetContentRegionAvail().x);
  ImGui::BeginChild("live controls", {width, 0.0F});
  const ImVec2 low = ImGui::GetWindowPos();
  ui::note("pane:Live", low, {low.x + ImGui::GetWindowWidth(), low.y + ImGui::GetWindowHeight()});
  draw_sources(session, settings);
  // What is pressed stands above what grows: warnings must not push it away.
  if (live_.connected()) {
    ImGui::Separator();
    draw_recorder(session);
  }
  const bool review = draw_verdict(session);
  if (live_.connected()) {
    ImGui::Separator();
    draw_statistics();
  }
  ImGui::EndChild();
  ImGui::SameLine();
  draw_image();
  return review;
}

void LivePane::draw_sources(Session& session, Settings& settings) {
  if (!looked_) {
    looked_ = true;
    live_.look_for_devices(session.worker());
  }
  ImGui::TextUnformatted("Images");
  ui::text("##image source", settings.image_source, -1.0F);
  ImGui::TextUnformatted("Tracker (empty: the same)");
  ui::text("##tracker source", settings.tracker_source, -1.0F);
  if (!live_.connected()) {
    if (ui::button("Connect", nullptr, false, !settings.image_source.empty())) {
      session.attempt("sources", [&] { live_.connect(settings.image_source, settings.tracker_source); });
    }
    for (const FoundDevice& device : live_.devices()) {
      if (ImGui::Selectable((device.source + "  " + device.description).c_str())) settings.image_source = device.source;
      ui::note_last("device:" + device.source);
    }
    ImGui::Spacing();
    for (const auto& [name, scheme] : live_.sources().schemes()) {
      ImGui::TextWrapped("%s: %s", scheme.form.c_str(), scheme.description.c_str());
    }
  } else if (ui::button("Disconnect", nullptr, false, !live_.recording())) {
    live_.disconnect();
    shown_.reset();
  }
}

void LivePane::draw_statistics() {
  const SessionStatistics now = live_.statistics();
  stream_line("Images", now.images);
  if (now.width > 0) ImGui::Text("%d x %d pixels", now.width, now.height);
  if (!now.tracker.source.empty()) stream_line("Tracker", now.tracker);
  for (const TransformStatistics& transform : now.transforms) {
    const bool good = transform.last.valid() && transform.age_s < kStale_s;
    std::string text = transform.transform + ": " +
                       (transform.last.valid() ? std::string("OK") : transform.last.status) + ", " +
                       format_rounded(transform.rate_hz, 1) + " / s";
    if (transform.last.valid()) {
      const Eigen::Matrix4d& m = transform.last.matrix;
      text += ", at " + format_rounded(m(0, 3), 1) + " " + format_rounded(m(1, 3), 1) + " " +
              format_rounded(m(2, 3), 1) + " mm";
    }
    colored(good ? kGood : kBad, text);
  }
  if (!now.transforms.empty() && !now.tracked) colored(kBad, "The probe is not tracked");
  if (!now.geometry_fault.empty()) {
    colored(kBad, now.geometry_fault + ": frames are not valid; connect again, with the calibration of this setting");
  }
  const std::vector<SessionEvent> events = live_.events();
  const std::size_t first = events.size() > 3 ? events.size() - 3 : 0;
  for (std::size_t i = first; i < events.size(); ++i) {
    if (events[i].warning && !events[i].geometry) colored(kDoubtful, events[i].message);  // that is told above
  }
}

void LivePane::draw_recorder(Session& session) {
  if (!live_.recording()) {
    if (folder_.empty()) folder_ = free_folder_name();
    ImGui::TextUnformatted("Record to the new folder");
    ui::text("##recording folder", folder_, -1.0F);
    ui::check("Gate", gated_, "Sweeps begin when the probe has been held still, and end when it is still again");
    if (ui::button("Record", nullptr, false, !folder_.empty())) {
      session.attempt("recording", [&] { live_.record(folder_, gated_); });
    }
    return;
  }
  const RecorderStatus status = live_.status();
  const bool running = status.state == RecorderState::kRecording;
  colored(running ? kGood : kDoubtful, text_of(status, gated_));
  if (status.state == RecorderState::kPaused) {
    if (ui::button("Go on", "With another sweep")) live_.go_on();
  } else if (ui::button("Pause", nullptr, false, status.state != RecorderState::kEnded)) {
    live_.pause();
  }
  ImGui::SameLine();
  if (ui::button("New sweep", "The next frame begins another sweep", false, running)) live_.new_sweep();
  ImGui::SameLine();
  if (ui::button("End")) {
    live_.end(session.worker(), [&session](const std::string& error) { session.say("recording", error); });
    folder_.clear();
  }
  ImGui::Text("%llu frames, %.1f s, sweep %d", static_cast<unsigned long long>(status.frames), status.duration_s,
              status.sweep + 1);
  if (status.invalid_frames > 0) colored(kDoubtful, std::to_string(status.invalid_frames) + " not valid");
  if (status.dropped_frames > 0)
    colored(kBad, std::to_string(status.dropped_frames) + " dropped: the disk is too slow");
  if (status.minutes_left) {
    colored(*status.minutes_left < 5.0 ? kBad : kGood,
            "disk for " + format_rounded(*status.minutes_left, 0) + " more minutes");
  }
  if (!status.message.empty()) colored(kDoubtful, status.message);
}

bool LivePane::draw_verdict(Session& session) {
  const auto& verdict = live_.verdict();
  if (!verdict) return false;
  ImGui::Separator();
  colored(verdict->good() ? kGood : kDoubtful,
          verdict->good() ? "The sweep is good" : "The sweep can be used with care, or made again:");
  for (const std::string& warning : verdict->warnings) colored(kDoubtful, warning);
  ImGui::Text("%d of %d frames valid", verdict->valid_frames, verdict->frames);
  if (verdict->speed_mm_s) ImGui::Text("%.0f mm/s", *verdict->speed_mm_s);
  if (!ui::button("Review it", "Open what was recorded")) return false;
  session.open(live_.folder());
  return true;
}

void LivePane::draw_image() {
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 size = ImGui::GetContentRegionAvail();
  if (size.x < 2.0F || size.y < 2.0F) return;
  ui::note("pane:Live image", low, {low.x + size.x, low.y + size.y});
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(low, {low.x + size.x, low.y + size.y}, IM_COL32(0, 0, 0, 255));
  const SharedFrame frame = live_.latest_frame();
  if (frame && frame != shown_ && !frame->frame.image.empty()) {
    cv::Mat grey;
    frame->frame.image.convertTo(grey, CV_8U);
    cv::Mat rgba;
    cv::cvtColor(grey, rgba, grey.channels() == 3 ? cv::COLOR_RGB2RGBA : cv::COLOR_GRAY2RGBA);
    texture_.upload(rgba);
    live_.note_shown(frame);
  }
  if (frame) shown_ = frame;
  if (!shown_ || texture_.size().empty()) return;
  const cv::Size image = texture_.size();
  const float scale = std::min(size.x / static_cast<float>(image.width), size.y / static_cast<float>(image.height));
  const ImVec2 half(0.5F * scale * static_cast<float>(image.width), 0.5F * scale * static_cast<float>(image.height));
  const ImVec2 middle(low.x + 0.5F * size.x, low.y + 0.5F * size.y);
  list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(texture_.id())),
                {middle.x - half.x, middle.y - half.y}, {middle.x + half.x, middle.y + half.y});
  if (!shown_->valid()) list.AddText({low.x + 6.0F, low.y + 6.0F}, kBad, "not valid");
}

}  // namespace fathom
