#include "viewer/review_pane.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "viewer/look.h"
#include "viewer/review_overlays.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr double kZoomStep = 1.15;
constexpr double kNearest = 64.0;  // window's pixels a pixel
constexpr double kFarthest = 0.05;
constexpr double kReach = 8.0;  // window's pixels

// 16-bit and signed images begin with the grey values that they have.
void choose_grey_values(const cv::Mat& image, ViewState& view) {
  if (image.depth() == CV_8U) return;
  double low = 0.0;
  double high = 255.0;
  cv::minMaxLoc(image.reshape(1), &low, &high);
  view.level = static_cast<float>(0.5 * (low + high));
  view.window = static_cast<float>(std::max(high - low, 1e-3));
}

}  // namespace

void ReviewPane::ask_for_frame(Session& session) {
  const auto scan = session.document()->scan();
  const auto recording = static_cast<std::size_t>(session.view.recording);
  const bool same = asked_frame_ == session.view.frame && asked_recording_ == recording;
  if (same && asked_scan_.lock() == scan) return;
  if (asked_scan_.lock() != scan) image_frame_ = -1;
  session.frames().ask(scan, recording, session.view.frame);
  asked_scan_ = scan;
  asked_recording_ = recording;
  asked_frame_ = session.view.frame;
}

void ReviewPane::take_frame(Session& session) {
  auto frame = session.frames().take();
  if (!frame) return;
  const bool first = image_frame_ < 0;
  image_ = frame->image;
  error_ = frame->error;
  image_recording_ = frame->recording;
  image_frame_ = frame->number;
  if (first && !image_.empty()) choose_grey_values(image_, session.view);
  shown_window_ = 0.0F;
}

bool ReviewPane::settled(const Session& session) const {
  return session.document() == nullptr ||
         (image_frame_ == session.view.frame && image_recording_ == static_cast<std::size_t>(session.view.recording));
}

void ReviewPane::show_grey_values(const ViewState& view) {
  if (image_.empty() || (shown_level_ == view.level && shown_window_ == view.window)) return;
  const double gain = 255.0 / std::max(static_cast<double>(view.window), 1e-6);
  cv::Mat grey;
  image_.convertTo(grey, CV_8U, gain, 127.5 - gain * static_cast<double>(view.level));
  cv::Mat rgba;
  cv::cvtColor(grey, rgba, grey.channels() == 3 ? cv::COLOR_RGB2RGBA : cv::COLOR_GRAY2RGBA);
  texture_.upload(rgba);
  shown_level_ = view.level;
  shown_window_ = view.window;
}

void ReviewPane::place_image(Session& session, ImVec2 low, ImVec2 size) {
  ViewState& view = session.view;
  const RecordingHeader& header = *session.header();
  const double aspect = session.pixel_aspect();
  const Eigen::Vector2d pane(size.x, size.y);
  const Eigen::Vector2d image(header.width, header.height * aspect);
  const Eigen::Vector2d whole(0.5 * (header.width - 1), 0.5 * (header.height - 1));
  const double fit = std::min(pane.x() / image.x(), pane.y() / image.y());
  const double zoom = view.zoom > 0.0F ? static_cast<double>(view.zoom) : fit;
  place_.scale = {zoom, zoom * aspect};
  const Eigen::Vector2d middle = view.zoom > 0.0F ? view.middle_px : whole;
  place_.origin = Eigen::Vector2d(low.x, low.y) + 0.5 * pane - middle.cwiseProduct(place_.scale);
  placed_ = true;
}

void ReviewPane::navigate(Session& session) {
  ViewState& view = session.view;
  const ImGuiIO& io = ImGui::GetIO();
  const Eigen::Vector2d mouse(io.MousePos.x, io.MousePos.y);
  const ImVec2 low = ImGui::GetItemRectMin();
  const ImVec2 high = ImGui::GetItemRectMax();
  const Eigen::Vector2d pane_middle(0.5 * (low.x + high.x), 0.5 * (low.y + high.y));
  const auto start_zoom = [&] {
    if (view.zoom > 0.0F) return;
    view.middle_px = place_.to_image(pane_middle);
    view.zoom = static_cast<float>(place_.scale.x());
  };
  if (ImGui::IsItemHovered() && io.MouseWheel != 0.0F) {
    if (io.KeyCtrl) {
      start_zoom();
      const Eigen::Vector2d under = place_.to_image(mouse);
      const double before = static_cast<double>(view.zoom);
      const double zoom = std::clamp(before * std::pow(kZoomStep, io.MouseWheel), kFarthest, kNearest);
      view.middle_px = under + (view.middle_px - under) * (before / zoom);
      view.zoom = static_cast<float>(zoom);
    } else {
      session.show_frame(view.frame - static_cast<int>(std::lround(io.MouseWheel)));
    }
  }
  const bool pans = ImGui::IsMouseDown(ImGuiMouseButton_Middle) ||
                    (view.tool == Tool::kBrowse && ImGui::IsMouseDown(ImGuiMouseButton_Left));
  const bool moved = io.MouseDelta.x != 0.0F || io.MouseDelta.y != 0.0F;
  if (ImGui::IsItemActive() && moved && pans) {
    start_zoom();
    view.middle_px -= Eigen::Vector2d(io.MouseDelta.x, io.MouseDelta.y).cwiseQuotient(place_.scale);
  } else if (ImGui::IsItemActive() && moved && ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
    view.window = std::max(view.window * std::exp(0.005F * io.MouseDelta.x), 1e-3F);
    view.level += 0.0025F * view.window * io.MouseDelta.y;
  }
}

void ReviewPane::draw(Session& session, const std::vector<Eigen::Vector2d>& path) {
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 size = ImGui::GetContentRegionAvail();
  if (size.x < 2.0F || size.y < 2.0F) return;
  placed_ = false;
  const RecordingHeader* header = session.header();
  if (header == nullptr) return;
  if (!header->has_images() || header->frame_count() == 0) {
    ImGui::TextWrapped("This recording has no images.");
    return;
  }
  ask_for_frame(session);
  take_frame(session);
  show_grey_values(session.view);
  ImGui::InvisibleButton(
      "image", size,
      ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
  place_image(session, low, size);
  navigate(session);
  place_image(session, low, size);

  ToolInput input;
  for (const Eigen::Vector2d& at : path) input.path_px.push_back(place_.to_image(at));
  const ImGuiIO& io = ImGui::GetIO();
  input.at_px = place_.to_image({io.MousePos.x, io.MousePos.y});
  input.hovered = ImGui::IsItemHovered();
  input.pressed = input.hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left);
  input.twice = input.pressed && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  input.released = ImGui::IsItemDeactivated() || (ImGui::IsItemActive() && ImGui::IsMouseReleased(0));
  input.held = ImGui::IsItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Left);
  input.ctrl = io.KeyCtrl;
  input.shift = io.KeyShift;
  input.reach_px = kReach * static_cast<double>(ui::em()) / 15.0 / place_.scale.x();
  if (settled(session)) {
    tools_.handle(session, input);
    if (session.view.tool == Tool::kWire && !image_.empty()) wire_.handle(session, input, image_);
  }

  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 high(low.x + size.x, low.y + size.y);
  list.PushClipRect(low, high, true);
  list.AddRectFilled(low, high, IM_COL32(0, 0, 0, 255));
  if (!image_.empty() && image_frame_ >= 0) {
    list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(texture_.id())), place_.at({-0.5, -0.5}),
                  place_.at({image_.cols - 0.5, image_.rows - 0.5}));
  }
  draw_overlays(session, list);
  draw_corner_text(session, list, low, size);
  list.PopClipRect();
  ui::note("pane:Review", low, high);
}

void ReviewPane::draw_overlays(Session& session, ImDrawList& list) {
  draw_hatching(session, list);
  if (session.view.show_outlines) draw_outlines(session, place_, list);
  draw_line_and_ruler(session, place_, list);
  if (session.view.tool == Tool::kBrush && session.active_structure()) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    list.AddCircle(mouse, session.view.brush_px * static_cast<float>(place_.scale.x()), IM_COL32(255, 255, 255, 160),
                   48);
  }
}

void ReviewPane::draw_hatching(Session& session, ImDrawList& list) {
  const Document& document = *session.document();
  if (!session.view.show_hatching) return;
  const std::array<std::uint64_t, 4> now{document.division_revision(), document.placement_revision(),
                                         static_cast<std::uint64_t>(session.view.recording),
                                         static_cast<std::uint64_t>(session.view.frame)};
  if (now != hatched_of_) {
    hatched_of_ = now;
    hatched_px_ = hatched_parts(session);
  }
  for (const auto& polygon : hatched_px_) draw_hatched(polygon, place_, list);
}

void ReviewPane::draw_corner_text(Session& session, ImDrawList& list, ImVec2 low, ImVec2 size) {
  const ViewState& view = session.view;
  char text[160];
  std::snprintf(text, sizeof text, "frame %d of %d   level %.0f   window %.0f", view.frame, session.frame_count(),
                static_cast<double>(view.level), static_cast<double>(view.window));
  const float line = ui::em() * 1.2F;
  const ImU32 color = IM_COL32(255, 220, 120, 255);
  list.AddText({low.x + 4.0F, low.y + size.y - line}, color, text);
  const FrameHeader& frame = session.header()->frames[static_cast<std::size_t>(view.frame)];
  std::string doubt = error_;
  if (doubt.empty() && !frame.image_valid()) doubt = "image marked invalid";
  if (doubt.empty() && session.document()->is_calibrated() && !session.reference_from_image()) doubt = "no pose";
  if (!doubt.empty()) list.AddText({low.x + 4.0F, low.y + 4.0F}, IM_COL32(255, 90, 90, 255), doubt.c_str());
}

std::optional<Eigen::Vector2d> ReviewPane::find(const Eigen::Vector2d& px) const {
  if (!placed_) return std::nullopt;
  return place_.to_window(px);
}

}  // namespace fathom
