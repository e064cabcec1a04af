#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <imgui.h>

#include "viewer/assist_tool.h"
#include "viewer/gl_objects.h"
#include "viewer/review_tools.h"
#include "viewer/session.h"
#include "viewer/wire_tool.h"

namespace fathom {

/// How the image lies in the window.
struct ImagePlace {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< of pixel (0, 0)'s centre
  Eigen::Vector2d scale = Eigen::Vector2d::Ones();   ///< window's pixels a pixel

  Eigen::Vector2d to_window(const Eigen::Vector2d& px) const { return origin + px.cwiseProduct(scale); }
  Eigen::Vector2d to_image(const Eigen::Vector2d& window) const { return (window - origin).cwiseQuotient(scale); }
  ImVec2 at(const Eigen::Vector2d& px) const {
    const Eigen::Vector2d place = to_window(px);
    return {static_cast<float>(place.x()), static_cast<float>(place.y())};
  }
};

/// The B-scan with everything drawn on it, and the tools.
class ReviewPane {
 public:
  /// `path` is where the pointer was since the last frame, in the window.
  void draw(Session& session, const std::vector<Eigen::Vector2d>& path);

  /// Where a pixel of the shown frame is in the window; empty where no frame is shown.
  std::optional<Eigen::Vector2d> find(const Eigen::Vector2d& px) const;
  /// Whether the image is that of the frame asked for.
  bool settled(const Session& session) const;

  /// Drops what other tools were about to draw.
  void choose(Session& session, Tool tool);
  /// Takes back the last point, click or seed of the tool in hand. False where there is none.
  bool step_back(Session& session);
  /// Puts what the tool in hand was about to draw into the exam.
  void finish(Session& session);
  void give_up(Session& session);

 private:
  StepTool* stepping(Tool tool);
  void ask_for_frame(Session& session);
  void take_frame(Session& session);
  void show_grey_values(const ViewState& view);
  void place_image(Session& session, ImVec2 low, ImVec2 size);
  void navigate(Session& session);
  void draw_overlays(Session& session, ImDrawList& list);
  void draw_hatching(Session& session, ImDrawList& list);
  void draw_corner_text(Session& session, ImDrawList& list, ImVec2 low, ImVec2 size);

  Texture texture_;
  cv::Mat image_;  // as recorded
  std::string error_;
  std::size_t image_recording_ = 0;
  int image_frame_ = -1;
  std::size_t asked_recording_ = 0;
  int asked_frame_ = -1;
  std::weak_ptr<const Scan> asked_scan_;
  float shown_level_ = 0.0F;
  float shown_window_ = 0.0F;
  bool placed_ = false;
  ImagePlace place_;
  ReviewTools tools_;
  WireTool wire_;
  AssistTool assist_;
  std::vector<std::vector<Eigen::Vector2d>> hatched_px_;
  std::array<std::uint64_t, 4> hatched_of_{};
};

}  // namespace fathom
