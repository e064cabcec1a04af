#include "viewer/review_tools.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/numbers.h"
#include "measurement/partition_volume.h"
#include "segmentation/push_contour.h"

namespace fathom {

namespace {

constexpr double kLineStep = 0.3;  // of the mouse's reach: points of a line drawn free-hand

bool is_here(const Session& session, const Contour& contour) {
  return contour.frame == session.view.frame && contour.recording == session.view.recording;
}

// The point of the active structure nearest to the mouse, within its reach.
std::optional<PointChoice> nearest_point(const Session& session, const Eigen::Vector2d& at_px, double reach_px) {
  const auto active = session.active_structure();
  if (!active) return std::nullopt;
  std::optional<PointChoice> best;
  double best_px = reach_px;
  const std::vector<Contour>& contours = session.document()->structures()[*active].contours;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (!is_here(session, contours[i])) continue;
    for (std::size_t k = 0; k < contours[i].points_px.size(); ++k) {
      const double distance_px = (contours[i].points_px[k] - at_px).norm();
      if (distance_px > best_px) continue;
      best_px = distance_px;
      best = PointChoice{i, k};
    }
  }
  return best;
}

// The point before which a new one would lie on the line nearest to the mouse.
std::optional<PointChoice> nearest_edge(const Session& session, const Eigen::Vector2d& at_px, double reach_px) {
  const auto active = session.active_structure();
  if (!active) return std::nullopt;
  std::optional<PointChoice> best;
  double best_px = reach_px;
  const std::vector<Contour>& contours = session.document()->structures()[*active].contours;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const Polygon& points = contours[i].points_px;
    if (!is_here(session, contours[i])) continue;
    for (std::size_t k = contours[i].closed ? 0 : 1; k < points.size(); ++k) {
      const Eigen::Vector2d& a = points[(k + points.size() - 1) % points.size()];
      const Eigen::Vector2d way = points[k] - a;
      const double length2 = std::max(way.squaredNorm(), std::numeric_limits<double>::min());
      const double along = std::clamp((at_px - a).dot(way) / length2, 0.0, 1.0);
      const double distance_px = (a + along * way - at_px).norm();
      if (distance_px > best_px) continue;
      best_px = distance_px;
      best = PointChoice{i, k == 0 ? points.size() : k};
    }
  }
  return best;
}

// Closed, unless both ends lie where another sweep is used. Treece 2000, section 4.2.3.
bool is_closed(const Session& session, const Polygon& line_px) {
  const auto placed = session.reference_from_image();
  const std::optional<Division>& division = session.document()->division();
  if (!placed || !division || division->partition.planes().empty()) return true;
  for (std::size_t s = 0; s < division->sweeps.size(); ++s) {
    const Sweep& sweep = division->sweeps[s];
    if (sweep.recording != static_cast<std::size_t>(session.view.recording)) continue;
    if (contains(sweep, session.view.frame)) return !stays_open(line_px, *placed, s, division->partition);
  }
  return true;
}

}  // namespace

void ReviewTools::handle(Session& session, const ToolInput& input) {
  if (input.pressed) last_px_ = input.at_px;
  switch (session.view.tool) {
    case Tool::kBrowse:
    case Tool::kWire:  // these have tools of their own
    case Tool::kRegion:
    case Tool::kThreshold:
    case Tool::kRefine:
      break;
    case Tool::kDraw:
      draw(session, input);
      break;
    case Tool::kPoints:
      edit_points(session, input);
      break;
    case Tool::kBrush:
      push(session, input);
      break;
    case Tool::kExtremity:
      mark_extremity(session, input);
      break;
    case Tool::kDistance:
      measure(session, input, 2);
      break;
    case Tool::kAngle:
      measure(session, input, 3);
      break;
    case Tool::kArea:
      measure(session, input, std::numeric_limits<std::size_t>::max());
      break;
  }
}

// A drag draws free-hand and ends the line when it is let go; clicks set point by point, and one on the first point
// ends it.
void ReviewTools::draw(Session& session, const ToolInput& input) {
  Polygon& line = session.view.line_px;
  if (input.pressed) {
    const bool on_first = line.size() >= 3 && (line.front() - input.at_px).norm() <= input.reach_px;
    if (on_first || (input.twice && line.size() >= 3)) {
      finish_line(session);
      dragging_ = false;
      return;
    }
    line.push_back(input.at_px);
    dragging_ = false;
    return;
  }
  if ((input.held || input.released) && !line.empty()) {
    for (const Eigen::Vector2d& at : input.path_px) {
      if (!dragging_ && (at - line.back()).norm() > input.reach_px) dragging_ = true;
      if (dragging_ && (at - line.back()).norm() >= kLineStep * input.reach_px) line.push_back(at);
    }
  }
  if (input.released && dragging_) {
    dragging_ = false;
    finish_line(session);
  }
}

void ReviewTools::finish_line(Session& session) {
  if (session.view.line_px.size() < 3 || session.document() == nullptr) return;
  const Polygon line = std::move(session.view.line_px);
  session.view.line_px.clear();
  session.attempt("outline", [&] {
    Document& document = *session.document();
    document.begin_action("Draw outline");
    const std::size_t structure = session.require_structure();
    Contour contour;
    contour.frame = session.view.frame;
    contour.recording = session.view.recording;
    contour.points_px = line;
    contour.closed = is_closed(session, line);
    document.add_contour(structure, std::move(contour));
    document.end_action();
  });
}

void ReviewTools::edit_points(Session& session, const ToolInput& input) {
  ViewState& view = session.view;
  const auto active = session.active_structure();
  if (!active) return;
  Document& document = *session.document();
  if (input.pressed) {
    view.chosen = nearest_point(session, input.at_px, input.reach_px);
    if (view.chosen) {
      document.begin_action("Move point");
      dragging_ = true;
    } else if (const auto edge = nearest_edge(session, input.at_px, input.reach_px)) {
      document.begin_action("Insert point");
      dragging_ = session.attempt("outline", [&] {
        document.insert_point(*active, edge->contour, edge->point, input.at_px);
        view.chosen = edge;
      });
    }
  }
  if (dragging_ && view.chosen && input.held && !input.path_px.empty() && !input.pressed) {
    const Eigen::Vector2d to = input.path_px.back();
    session.attempt("outline", [&] { document.move_point(*active, view.chosen->contour, view.chosen->point, to); });
  }
  if (input.released && dragging_) {
    dragging_ = false;
    if (document.in_action()) document.end_action();
  }
}

// What the brush touches on the way gives way. Long ways are cut into steps, so that it cannot jump across a line.
void ReviewTools::push(Session& session, const ToolInput& input) {
  const auto active = session.active_structure();
  if (!active) return;
  Document& document = *session.document();
  if (input.pressed) {
    document.begin_action("Push outline");
    dragging_ = true;
  }
  if (dragging_ && input.held) {
    const double radius = static_cast<double>(session.view.brush_px);
    std::vector<Eigen::Vector2d> way = input.path_px;
    if (input.pressed) way.push_back(input.at_px);
    session.attempt("outline", [&] {
      const std::vector<Contour> contours = document.structures()[*active].contours;
      for (std::size_t i = 0; i < contours.size(); ++i) {
        if (!is_here(session, contours[i])) continue;
        Contour pushed = contours[i];
        bool touched = false;
        Eigen::Vector2d from = last_px_;
        for (const Eigen::Vector2d& to : way) {
          const auto steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / (0.3 * radius))));
          for (int k = 1; k <= steps; ++k) {
            const Eigen::Vector2d at = from + (to - from) * (static_cast<double>(k) / steps);
            touched = push_contour(at, radius, pushed.closed, pushed.points_px) || touched;
          }
          from = to;
        }
        pushed.confidence.reset();
        if (touched) document.replace_contour(*active, i, std::move(pushed));
      }
    });
    if (!way.empty()) last_px_ = way.back();
  }
  if (input.released && dragging_) {
    dragging_ = false;
    if (document.in_action()) document.end_action();
  }
}

void ReviewTools::mark_extremity(Session& session, const ToolInput& input) {
  if (!input.pressed) return;
  session.attempt("extremity", [&] {
    Document& document = *session.document();
    document.begin_action("Mark extremity");
    document.set_extremity(session.require_structure(), session.view.recording, session.view.frame, input.at_px);
    document.end_action();
  });
}

void ReviewTools::measure(Session& session, const ToolInput& input, std::size_t points) {
  std::vector<Eigen::Vector2d>& ruler = session.view.ruler_px;
  if (input.pressed) {
    if (ruler.size() >= points) ruler.clear();
    ruler.push_back(input.at_px);
    dragging_ = false;
  } else if (input.held && !ruler.empty() && !input.path_px.empty()) {
    const Eigen::Vector2d to = input.path_px.back();
    if (!dragging_ && ruler.size() < points && (to - ruler.back()).norm() > input.reach_px) {
      ruler.push_back(to);
      dragging_ = true;
    } else if (dragging_) {
      ruler.back() = to;
    }
  }
}

}  // namespace fathom
