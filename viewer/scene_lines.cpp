#include "viewer/scene_lines.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <imgui.h>

#include "core/error.h"
#include "viewer/look.h"
#include "viewer/session.h"

namespace fathom {

namespace {

using Color = std::array<unsigned char, 4>;

constexpr int kMostPosts = 150;
constexpr Color kPost{130, 140, 150, 110};
constexpr Color kCurrent{255, 235, 60, 255};
constexpr Color kSeparating{255, 160, 40, 150};
constexpr Color kWholeDisc{255, 160, 40, 28};
constexpr double kCross_mm = 2.0;
constexpr int kDiscCorners = 48;

Color color_of(const std::string& text) {
  const unsigned packed = packed_color(text.c_str());
  return {static_cast<unsigned char>(packed >> IM_COL32_R_SHIFT),
          static_cast<unsigned char>(packed >> IM_COL32_G_SHIFT),
          static_cast<unsigned char>(packed >> IM_COL32_B_SHIFT), 255};
}

SceneVertex vertex(const Eigen::Vector3d& place, const Color& color) {
  return {place.cast<float>(), Eigen::Vector3f::Zero(), color};
}

void add_line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Color& color,
              std::vector<SceneVertex>& lines) {
  lines.push_back(vertex(from, color));
  lines.push_back(vertex(to, color));
}

// Top left, top right, bottom right, bottom left.
std::array<Eigen::Vector3d, 4> corners_of(const Eigen::Affine3d& reference_from_image, const RecordingHeader& header) {
  const double right = std::max(header.width - 1, 1);
  const double down = std::max(header.height - 1, 1);
  return {
      reference_from_image * Eigen::Vector3d(0.0, 0.0, 0.0), reference_from_image * Eigen::Vector3d(right, 0.0, 0.0),
      reference_from_image * Eigen::Vector3d(right, down, 0.0), reference_from_image * Eigen::Vector3d(0.0, down, 0.0)};
}

template <typename Visit>
void for_some_frames(const Session& session, int most, const Visit& visit) {
  const Scan& scan = *session.document()->scan();
  for (std::size_t r = 0; r < scan.locators.size(); ++r) {
    const int count = scan.locators[r].frame_count();
    const int step = std::max(1, (count + most - 1) / most);
    for (int frame = 0; frame < count; frame += step) {
      if (const auto place = scan.locators[r].reference_from_image(frame)) {
        visit(*place, scan.recordings[r]->header());
      }
    }
  }
}

void add_polygon(const std::vector<Eigen::Vector3d>& polygon, const Color& color, std::vector<SceneVertex>& triangles) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    for (const std::size_t corner : {std::size_t{0}, i - 1, i}) triangles.push_back(vertex(polygon[corner], color));
  }
}

std::vector<Eigen::Vector3d> disc(const DividingPlane& plane, const Eigen::Vector3d& centre, double radius) {
  const Eigen::Vector3d across = plane.normal().unitOrthogonal();
  const Eigen::Vector3d other = plane.normal().cross(across);
  std::vector<Eigen::Vector3d> corners;
  for (int k = 0; k < kDiscCorners; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kDiscCorners;
    corners.push_back(centre + radius * (std::cos(angle) * across + std::sin(angle) * other));
  }
  return corners;
}

}  // namespace

std::vector<Eigen::Vector3d> all_corners(const Session& session) {
  std::vector<Eigen::Vector3d> corners;
  for_some_frames(session, 40, [&](const Eigen::Affine3d& place, const RecordingHeader& header) {
    for (const Eigen::Vector3d& corner : corners_of(place, header)) corners.push_back(corner);
  });
  return corners;
}

Eigen::Vector3d mean_image_depth(const Session& session) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for_some_frames(session, 40, [&](const Eigen::Affine3d& place, const RecordingHeader&) {
    sum += place.linear().col(1).normalized();
  });
  return sum.norm() > 1e-9 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

std::vector<SceneVertex> post_lines(const Session& session) {
  std::vector<SceneVertex> lines;
  for_some_frames(session, kMostPosts, [&](const Eigen::Affine3d& place, const RecordingHeader& header) {
    const auto corners = corners_of(place, header);
    add_line(corners[3], corners[0], kPost, lines);
    add_line(corners[0], corners[1], kPost, lines);
    add_line(corners[1], corners[2], kPost, lines);
  });
  return lines;
}

std::vector<SceneVertex> current_post_lines(const Session& session) {
  std::vector<SceneVertex> lines;
  const auto place = session.reference_from_image();
  if (!place) return lines;
  const auto corners = corners_of(*place, *session.header());
  for (std::size_t i = 0; i < corners.size(); ++i) add_line(corners[i], corners[(i + 1) % 4], kCurrent, lines);
  return lines;
}

std::vector<SceneVertex> outline_lines(const Session& session) {
  std::vector<SceneVertex> lines;
  const Scan& scan = *session.document()->scan();
  const auto place_of = [&](int recording, int frame) {
    return scan.locators.at(static_cast<std::size_t>(recording)).reference_from_image(frame);
  };
  for (const Structure& structure : session.document()->structures()) {
    const Color color = color_of(structure.color);
    for (const Contour& contour : structure.contours) {
      const auto place = place_of(contour.recording, contour.frame);
      if (!place) continue;
      const Polygon& points = contour.points_px;
      for (std::size_t i = contour.closed ? 0 : 1; i < points.size(); ++i) {
        const Eigen::Vector2d& from = points[(i + points.size() - 1) % points.size()];
        add_line(*place * Eigen::Vector3d(from.x(), from.y(), 0.0),
                 *place * Eigen::Vector3d(points[i].x(), points[i].y(), 0.0), color, lines);
      }
    }
    for (const Extremity& extremity : structure.extremities) {
      const auto place = place_of(extremity.recording, extremity.frame);
      if (!place) continue;
      const Eigen::Vector3d at = *place * Eigen::Vector3d(extremity.point_px.x(), extremity.point_px.y(), 0.0);
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d half = kCross_mm * Eigen::Vector3d::Unit(axis);
        add_line(at - half, at + half, color, lines);
      }
    }
  }
  return lines;
}

PlaneScene plane_scene(const Session& session) {
  PlaneScene scene;
  try {
    const std::optional<Division>& division = session.document()->division();
    if (!division) return scene;
    const SpacePartition& partition = division->partition;
    Eigen::AlignedBox3d box;
    for (const SweepShape& sweep : partition.sweeps()) {
      for (const Eigen::Vector3d& centre : sweep.centres_mm) box.extend(centre);
      for (const Eigen::Vector3d& corner : sweep.first_corners_mm) box.extend(corner);
      for (const Eigen::Vector3d& corner : sweep.last_corners_mm) box.extend(corner);
    }
    for (std::size_t i = 0; i < partition.planes().size(); ++i) {
      const DividingPlane& plane = partition.planes()[i];
      const Eigen::Vector3d centre = plane.projection(box.center());
      const double away = plane.absDistance(box.center());
      const double radius = std::sqrt(std::max(std::pow(0.5 * box.diagonal().norm(), 2) - away * away, 1.0));
      scene.centres_mm.push_back(centre);
      add_polygon(disc(plane, centre, radius), kWholeDisc, scene.whole);
      for (const Polygon3& part : partition.visible_disc(i)) add_polygon(part, kSeparating, scene.separating);
    }
  } catch (const Error&) {
    // Said where the volume is.
  }
  return scene;
}

}  // namespace fathom
