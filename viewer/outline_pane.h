#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <imgui.h>

#include "viewer/camera.h"
#include "viewer/gl_objects.h"
#include "viewer/session.h"

namespace fathom {

/// Everything in space: frames as goal posts, outlines, surfaces, dividing planes; seen as one likes.
class OutlinePane {
 public:
  void draw(Session& session);
  /// Looks at everything from where reports do.
  void look_at_all(const Session& session);
  /// Looks along an axis of the reference coordinates, 0 to 2.
  void look_along(int axis);

  /// Where a point of space is in the window; empty where the pane is not shown.
  std::optional<Eigen::Vector2d> find(const Eigen::Vector3d& point_mm) const;
  const Camera& camera() const { return camera_; }

 private:
  void update_posts(const Session& session);
  void update_current(const Session& session);
  void update_outlines(const Session& session);
  void update_surfaces(const Session& session);
  void update_planes(const Session& session);
  void navigate(Session& session);
  void drag_planes(Session& session, ImDrawList& list);
  /// Draws what has changed since the last time.
  void render(const Session& session, cv::Size size);
  std::vector<double> picture_of(const Session& session, cv::Size size) const;
  void draw_axes(ImDrawList& list) const;
  void draw_scale_bar(ImDrawList& list) const;
  ImVec2 at(const Eigen::Vector3d& point_mm) const;

  struct Surface {
    VertexList vertices;
    std::uint64_t number = 0;
  };
  struct PlaneHandle {
    Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();
  };

  Camera camera_;
  Canvas canvas_;
  SceneProgram program_;
  VertexList posts_;
  VertexList current_;
  VertexList outlines_;
  VertexList discs_;        // where they separate sweeps
  VertexList faint_discs_;  // all of them
  std::map<std::uint64_t, std::unique_ptr<Surface>> surfaces_;
  std::vector<PlaneHandle> handles_;
  std::array<std::uint64_t, 4> posts_of_{};
  std::array<std::uint64_t, 4> current_of_{};
  std::array<std::uint64_t, 4> outlines_of_{};
  std::array<std::uint64_t, 4> planes_of_{};
  std::vector<double> rendered_;  // all that the picture depends on
  const Document* looked_at_ = nullptr;
  std::uint64_t placement_looked_at_ = 0;
  std::optional<std::size_t> dragged_plane_;
  ImVec2 low_;
  ImVec2 size_;
  bool shown_ = false;
};

}  // namespace fathom
