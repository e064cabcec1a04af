#include "viewer/outline_pane.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "viewer/gl.h"
#include "viewer/look.h"
#include "viewer/scene_lines.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr double kZoomStep = 1.15;

Eigen::Vector4f tint_of(const std::string& color, float alpha) {
  const ImVec4 tint = ImGui::ColorConvertU32ToFloat4(packed_color(color.c_str()));
  return {tint.x, tint.y, tint.z, alpha};
}

}  // namespace

void OutlinePane::update_posts(const Session& session) {
  const std::array<std::uint64_t, 4> now{session.document()->placement_revision(),
                                         reinterpret_cast<std::uintptr_t>(session.document()->scan().get())};
  if (now == posts_of_) return;
  posts_of_ = now;
  posts_.upload(post_lines(session));
}

void OutlinePane::update_current(const Session& session) {
  const std::array<std::uint64_t, 4> now{posts_of_[0], posts_of_[1], static_cast<std::uint64_t>(session.view.recording),
                                         static_cast<std::uint64_t>(session.view.frame)};
  if (now == current_of_) return;
  current_of_ = now;
  current_.upload(current_post_lines(session));
}

void OutlinePane::update_outlines(const Session& session) {
  const std::array<std::uint64_t, 4> now{posts_of_[0], posts_of_[1], session.document()->revision()};
  if (now == outlines_of_) return;
  outlines_of_ = now;
  outlines_.upload(outline_lines(session));
}

void OutlinePane::update_surfaces(const Session& session) {
  const std::vector<std::uint64_t>& ids = session.document()->content().ids;
  std::erase_if(surfaces_,
                [&](const auto& item) { return std::find(ids.begin(), ids.end(), item.first) == ids.end(); });
  for (const std::uint64_t id : ids) {
    const StructureView* view = session.find_structure(id);
    auto& surface = surfaces_[id];
    if (!surface) surface = std::make_unique<Surface>();
    if (view == nullptr || view->triangles_number == surface->number) continue;
    surface->number = view->triangles_number;
    if (view->triangles) {
      surface->vertices.upload(*view->triangles);
    } else {
      surface->vertices.upload({});
    }
  }
}

void OutlinePane::update_planes(const Session& session) {
  const std::array<std::uint64_t, 4> now{posts_of_[0], posts_of_[1], session.document()->division_revision()};
  if (now == planes_of_) return;
  planes_of_ = now;
  const PlaneScene scene = plane_scene(session);
  discs_.upload(scene.separating);
  faint_discs_.upload(scene.whole);
  handles_.clear();
  for (const Eigen::Vector3d& centre_mm : scene.centres_mm) handles_.push_back({centre_mm});
}

void OutlinePane::draw(Session& session) {
  low_ = ImGui::GetCursorScreenPos();
  size_ = ImGui::GetContentRegionAvail();
  shown_ = false;
  if (size_.x < 8.0F || size_.y < 8.0F) return;
  const Document* document = session.document();
  if (document == nullptr) return;
  if (!document->is_calibrated()) return;
  shown_ = true;
  update_posts(session);
  update_current(session);
  update_outlines(session);
  update_surfaces(session);
  update_planes(session);
  if (looked_at_ != document || placement_looked_at_ != document->placement_revision()) {
    looked_at_ = document;
    placement_looked_at_ = document->placement_revision();
    look_at_all(session);
  }
  const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
  render(session, {static_cast<int>(size_.x * scale.x), static_cast<int>(size_.y * scale.y)});
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(canvas_.texture())), low_,
                {low_.x + size_.x, low_.y + size_.y}, {0.0F, 1.0F}, {1.0F, 0.0F});
  list.PushClipRect(low_, {low_.x + size_.x, low_.y + size_.y}, true);
  drag_planes(session, list);
  ImGui::SetCursorScreenPos(low_);
  ImGui::InvisibleButton(
      "space", size_,
      ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
  navigate(session);
  draw_axes(list);
  draw_scale_bar(list);
  list.PopClipRect();
  ui::note("pane:Outline", low_, {low_.x + size_.x, low_.y + size_.y});
}

void OutlinePane::navigate(Session& session) {
  const ImGuiIO& io = ImGui::GetIO();
  const Eigen::Vector2d moved(io.MouseDelta.x, io.MouseDelta.y);
  if (ImGui::IsItemActive() && moved.squaredNorm() > 0.0) {
    const bool pans =
        ImGui::IsMouseDown(ImGuiMouseButton_Middle) || ImGui::IsMouseDown(ImGuiMouseButton_Right) || io.KeyShift;
    if (pans) {
      camera_.pan(moved.x(), moved.y());
    } else {
      camera_.turn(moved.x(), moved.y());
    }
  }
  if (ImGui::IsItemHovered() && io.MouseWheel != 0.0F) camera_.mm_per_pixel *= std::pow(kZoomStep, -io.MouseWheel);
  if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) look_at_all(session);
}

// A plane's handle moves it along its normal, with Shift it tilts it.
void OutlinePane::drag_planes(Session& session, ImDrawList& list) {
  Document& document = *session.document();
  if (!session.view.show_planes) return;
  const ImGuiIO& io = ImGui::GetIO();
  for (std::size_t i = 0; i < handles_.size() && i < document.content().planes.size(); ++i) {
    const ImVec2 centre = at(handles_[i].centre_mm);
    const float half = 0.5F * ui::em();
    const std::string name = "plane " + std::to_string(i + 1);
    ImGui::SetCursorScreenPos({centre.x - half, centre.y - half});
    ImGui::InvisibleButton(name.c_str(), {2.0F * half, 2.0F * half});
    ui::note_last(name);
    list.AddCircleFilled(centre, half,
                         ImGui::IsItemHovered() ? IM_COL32(255, 200, 80, 255) : IM_COL32(255, 160, 40, 200));
    if (ImGui::IsItemActivated()) {
      document.begin_action("Move dividing plane");
      dragged_plane_ = i;
    }
    const Eigen::Vector2d moved(io.MouseDelta.x, io.MouseDelta.y);
    if (ImGui::IsItemActive() && dragged_plane_ == i && moved.squaredNorm() > 0.0) {
      const DividingPlane plane = document.content().planes[i];
      const Eigen::Vector3d way = camera_.to_space(moved);
      session.attempt(name, [&] {
        if (io.KeyShift) {
          const Eigen::Vector3d away = camera_.view_from_reference.conjugate() * Eigen::Vector3d::UnitZ();
          const Eigen::Vector3d axis = away.cross(way);
          const double angle = moved.norm() * 0.005;
          const Eigen::Vector3d normal = Eigen::AngleAxisd(angle, axis.normalized()) * plane.normal();
          document.move_plane(i, DividingPlane(normal, plane.projection(handles_[i].centre_mm)));
        } else {
          // Seen from the end of its normal a plane hardly moves; it follows as far as it is seen to.
          const Eigen::Vector3d normal = plane.normal();
          const Eigen::Vector3d away = camera_.view_from_reference.conjugate() * Eigen::Vector3d::UnitZ();
          const double seen = std::max(1.0 - std::pow(normal.dot(away), 2), 0.1);
          DividingPlane to = plane;
          to.offset() -= normal.dot(way) / seen;
          document.move_plane(i, to);
        }
      });
    }
    if (ImGui::IsItemDeactivated() && dragged_plane_ == i) {
      dragged_plane_.reset();
      if (document.in_action()) document.end_action();
    }
  }
}

std::vector<double> OutlinePane::picture_of(const Session& session, cv::Size size) const {
  const ViewState& view = session.view;
  const Eigen::Vector4d turn = camera_.view_from_reference.coeffs();
  std::vector<double> state{static_cast<double>(size.width),
                            static_cast<double>(size.height),
                            static_cast<double>(ImGui::GetStyleColorVec4(ImGuiCol_WindowBg).x),
                            static_cast<double>(view.surface_alpha),
                            (view.show_posts ? 1.0 : 0.0) + (view.show_outlines ? 2.0 : 0.0) +
                                (view.show_planes ? 4.0 : 0.0) + (view.show_surfaces ? 8.0 : 0.0),
                            camera_.mm_per_pixel,
                            camera_.depth_mm};
  state.insert(state.end(), turn.begin(), turn.end());
  state.insert(state.end(), camera_.centre_mm.begin(), camera_.centre_mm.end());
  for (const auto* of : {&posts_of_, &current_of_, &outlines_of_, &planes_of_}) {
    for (const std::uint64_t number : *of) state.push_back(static_cast<double>(number));
  }
  for (const auto& [id, surface] : surfaces_) state.push_back(static_cast<double>(surface->number));
  return state;
}

void OutlinePane::render(const Session& session, cv::Size size) {
  const ViewState& view = session.view;
  std::vector<double> now = picture_of(session, size);
  if (now == rendered_) return;
  rendered_ = std::move(now);
  canvas_.begin(size);
  const ImVec4 back = ImGui::GetStyleColorVec4(ImGuiCol_WindowBg);
  gl::ClearColor(0.6F * back.x, 0.6F * back.y, 0.62F * back.z, 1.0F);
  gl::Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl::Enable(GL_DEPTH_TEST);
  gl::Disable(GL_SCISSOR_TEST);
  gl::Enable(GL_BLEND);
  gl::BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const Eigen::Matrix4f clip = camera_.clip(static_cast<double>(size_.x), static_cast<double>(size_.y)).cast<float>();
  const Eigen::Matrix4f eye = camera_.view().matrix().cast<float>();
  const Eigen::Vector4f white = Eigen::Vector4f::Ones();
  program_.use(clip, eye, white);
  if (view.show_posts) posts_.draw_lines();
  current_.draw_lines();
  if (view.show_outlines) outlines_.draw_lines();
  if (view.show_planes) discs_.draw_triangles();

  gl::DepthMask(GL_FALSE);
  if (view.show_planes) faint_discs_.draw_triangles();
  // Far sides first, so that near ones lie over them; within a side the order hardly shows on organs.
  const std::vector<std::uint64_t>& ids = session.document()->content().ids;
  for (const unsigned side : {GL_FRONT, GL_BACK}) {
    gl::Enable(GL_CULL_FACE);
    gl::CullFace(side);
    for (std::size_t i = 0; view.show_surfaces && i < ids.size(); ++i) {
      program_.use(clip, eye, tint_of(session.document()->structures()[i].color, view.surface_alpha));
      surfaces_.at(ids[i])->vertices.draw_triangles();
    }
    gl::Disable(GL_CULL_FACE);
  }
  gl::DepthMask(GL_TRUE);
  gl::Disable(GL_DEPTH_TEST);
  canvas_.finish();
}

ImVec2 OutlinePane::at(const Eigen::Vector3d& point_mm) const {
  const Eigen::Vector2d place = camera_.project(point_mm);
  return {low_.x + 0.5F * size_.x + static_cast<float>(place.x()),
          low_.y + 0.5F * size_.y + static_cast<float>(place.y())};
}

std::optional<Eigen::Vector2d> OutlinePane::find(const Eigen::Vector3d& point_mm) const {
  if (!shown_) return std::nullopt;
  const ImVec2 place = at(point_mm);
  return Eigen::Vector2d(place.x, place.y);
}

}  // namespace fathom
