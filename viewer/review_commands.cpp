#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers.h"
#include "measurement/cross_section.h"
#include "viewer/review_tools.h"

namespace fathom {

bool ReviewTools::remove_last_point(Session& session) {
  Polygon& points = session.view.line_px.empty() ? session.view.ruler_px : session.view.line_px;
  if (points.empty()) return false;
  points.pop_back();
  return true;
}

void ReviewTools::remove_chosen(Session& session) {
  const auto active = session.active_structure();
  if (!active || !session.view.chosen) return;
  const PointChoice chosen = *session.view.chosen;
  session.view.chosen.reset();
  session.attempt("outline", [&] {
    Document& document = *session.document();
    const std::vector<Contour>& contours = document.structures()[*active].contours;
    if (chosen.contour >= contours.size()) return;
    if (contours[chosen.contour].points_px.size() <= 3) {
      document.remove_contour(*active, chosen.contour);
    } else {
      document.remove_point(*active, chosen.contour, chosen.point);
    }
  });
}

void ReviewTools::clear_frame(Session& session) {
  const auto active = session.active_structure();
  if (!active) return;
  session.view.chosen.reset();
  session.attempt("outline", [&] {
    Document& document = *session.document();
    const int frame = session.view.frame;
    const int recording = session.view.recording;
    document.begin_action("Clear frame");
    for (std::size_t i = document.structures()[*active].contours.size(); i-- > 0;) {
      const Contour& contour = document.structures()[*active].contours[i];
      if (contour.frame == frame && contour.recording == recording) document.remove_contour(*active, i);
    }
    document.set_extremity(*active, recording, frame, std::nullopt);
    document.set_absent(*active, recording, frame, false);
    document.end_action();
  });
}

std::string ruler_text(const Session& session) {
  const std::vector<Eigen::Vector2d>& points = session.view.ruler_px;
  if (points.size() < 2) return {};
  const auto placed = session.reference_from_image();
  const auto vector = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) -> Eigen::Vector3d {
    const Eigen::Vector3d way(to.x() - from.x(), to.y() - from.y(), 0.0);
    return placed ? Eigen::Vector3d(placed->linear() * way) : way;
  };
  switch (session.view.tool) {
    case Tool::kAngle: {
      if (points.size() < 3) return {};
      const Eigen::Vector3d a = vector(points[1], points[0]);
      const Eigen::Vector3d b = vector(points[1], points[2]);
      const double angle = std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
      return format_rounded(angle, 1) + "\xc2\xb0";
    }
    case Tool::kArea: {
      if (points.size() < 3) return {};
      const double pixels = even_odd_area({&points}).area_px2;
      if (!placed) return format_rounded(pixels, 0) + " px2";
      const double pixel_mm2 = placed->linear().col(0).cross(placed->linear().col(1)).norm();
      return format_rounded(pixels * pixel_mm2 / 100.0, 2) + " cm2";
    }
    default:
      return format_rounded(vector(points[0], points[1]).norm(), 1) + (placed ? " mm" : " px");
  }
}

}  // namespace fathom
