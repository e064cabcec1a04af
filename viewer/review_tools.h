#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "viewer/session.h"

namespace fathom {

/// What the mouse did over the image since the last frame; places in pixels of the image.
struct ToolInput {
  std::vector<Eigen::Vector2d> path_px;  ///< newest last
  Eigen::Vector2d at_px = Eigen::Vector2d::Zero();
  bool hovered = false;
  bool pressed = false;  ///< the left button, over the image
  bool released = false;
  bool held = false;   ///< and it was pressed over the image
  bool twice = false;  ///< `pressed` is the second of a double click
  bool ctrl = false;
  bool shift = false;
  double reach_px = 6.0;  ///< how near to a point the mouse takes it
};

/// The tools of the Review pane: they turn what the mouse does into commands for the document.
class ReviewTools {
 public:
  void handle(Session& session, const ToolInput& input);
  /// Ends the line that is being drawn as a contour of the active structure, if it has three points.
  static void finish_line(Session& session);
  /// Takes the last point of the line or ruler being drawn away. False where there is none.
  static bool remove_last_point(Session& session);
  /// Removes the chosen point, and its contour where no three are left.
  static void remove_chosen(Session& session);
  /// Removes every contour and mark of the active structure on the shown frame.
  static void clear_frame(Session& session);

 private:
  void draw(Session& session, const ToolInput& input);
  void edit_points(Session& session, const ToolInput& input);
  void push(Session& session, const ToolInput& input);
  void mark_extremity(Session& session, const ToolInput& input);
  void measure(Session& session, const ToolInput& input, std::size_t points);

  bool dragging_ = false;
  Eigen::Vector2d last_px_ = Eigen::Vector2d::Zero();
};

/// The text beside a ruler, once it has its points: "12.3 mm"; in pixels where nothing is known of millimetres.
std::string ruler_text(const Session& session);

}  // namespace fathom
