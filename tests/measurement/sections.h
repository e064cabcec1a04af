#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "core/random.h"
#include "measurement/cross_section.h"

// Cross-sections in closed form, to measure without outlines, poses or pixels between.
namespace fathom::sections {

using Sections = std::vector<CrossSection>;

inline CrossSection section(int frame, const Eigen::Vector3d& normal, double area_mm2,
                            const Eigen::Vector3d& centroid_mm) {
  CrossSection section;
  section.frame = frame;
  section.normal = normal.normalized();
  section.vector_area_mm2 = area_mm2 * section.normal;
  section.centroid_mm = centroid_mm;
  return section;
}

inline double sphere_ml(double radius_mm) {
  return 4.0 / 3.0 * std::numbers::pi * radius_mm * radius_mm * radius_mm / 1000.0;
}

/// A sphere about the origin cut by the plane of unit `normal` at `distance_mm`; no area where it only touches.
inline CrossSection sphere_section(int frame, double radius_mm, const Eigen::Vector3d& normal, double distance_mm) {
  const double squared = std::max(0.0, radius_mm * radius_mm - distance_mm * distance_mm);
  return section(frame, normal, std::numbers::pi * squared, distance_mm * normal);
}

/// `count` parallel planes from one tangent plane to the other.
inline Sections sphere_linear(double radius_mm, int count) {
  Sections sections;
  for (int i = 0; i < count; ++i) {
    sections.push_back(
        sphere_section(i, radius_mm, Eigen::Vector3d::UnitZ(), radius_mm * (2.0 * i / (count - 1) - 1.0)));
  }
  return sections;
}

/// Planes through an axis beside the sphere, from one tangent plane to the other.
inline Sections sphere_fan(double radius_mm, double axis_in_radii, int count) {
  const double end = std::asin(1.0 / axis_in_radii);
  Sections sections;
  for (int i = 0; i < count; ++i) {
    const double angle = end * (2.0 * i / (count - 1) - 1.0);
    const Eigen::Vector3d normal(0.0, -std::sin(angle), std::cos(angle));
    sections.push_back(sphere_section(i, radius_mm, normal, radius_mm * axis_in_radii * std::sin(angle)));
  }
  return sections;
}

/// Planes whose position and two angles all change along the way, from one tangent plane to the other.
inline Sections sphere_free(double radius_mm, double end_rad, int count) {
  Sections sections;
  const auto normal = [&](double u) {
    return Eigen::Vector3d(Eigen::AngleAxisd(end_rad * u, Eigen::Vector3d::UnitY()) *
                           (Eigen::AngleAxisd(end_rad * u, Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitZ()));
  };
  // A point of each tangent plane on the z axis; the points between follow in a straight line.
  const double end_z = radius_mm / normal(1.0).z();
  for (int i = 0; i < count; ++i) {
    const double u = 2.0 * i / (count - 1) - 1.0;
    const Eigen::Vector3d n = normal(u);
    sections.push_back(sphere_section(i, radius_mm, n, n.z() * end_z * u));
  }
  return sections;
}

inline Sections moved(Sections sections, const Eigen::Isometry3d& motion) {
  for (CrossSection& section : sections) {
    section.normal = motion.linear() * section.normal;
    section.vector_area_mm2 = motion.linear() * section.vector_area_mm2;
    section.centroid_mm = motion * section.centroid_mm;
  }
  return sections;
}

inline Sections reversed(Sections sections) {
  std::reverse(sections.begin(), sections.end());
  return sections;
}

inline Eigen::Vector3d random_direction(Random& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

/// Any rotation, and a translation by `metres`.
inline Eigen::Isometry3d random_motion(Random& random, double metres) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.rotate(Eigen::AngleAxisd(random.uniform(0.0, std::numbers::pi), random_direction(random)));
  motion.pretranslate(1000.0 * metres * random_direction(random));
  return motion;
}

}  // namespace fathom::sections
