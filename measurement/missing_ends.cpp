#include "measurement/missing_ends.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "measurement/sweep_path.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
constexpr double kSmall = 0.02;      // of the largest section: the cap beyond it is less than 0.02 % of an ellipsoid
constexpr double kPart = 1.0 / 6.0;  // of the scan, between the three places that the parabola is laid through
constexpr double kFarthest = 0.5;    // of the scan: a zero beyond that is a guess

// Areas over the way along the normals, from the end inwards.
struct Profile {
  std::vector<double> at_mm;
  std::vector<double> area_mm2;
};

Profile profile_from(std::span<const CrossSection> sections, bool first) {
  Profile profile;
  double at_mm = 0.0;
  const std::size_t n = sections.size();
  for (std::size_t k = 0; k < n; ++k) {
    const CrossSection& section = sections[first ? k : n - 1 - k];
    if (k > 0) {
      const CrossSection& before = sections[first ? k - 1 : n - k];
      const Eigen::Vector3d normal = (facing(section) + facing(before)).normalized();
      at_mm += std::abs(normal.dot(section.centroid_mm - before.centroid_mm));
    }
    profile.at_mm.push_back(at_mm);
    profile.area_mm2.push_back(section.vector_area_mm2.norm());
  }
  return profile;
}

double area_at(const Profile& profile, double at_mm) {
  std::size_t i = 1;
  while (i + 1 < profile.at_mm.size() && profile.at_mm[i] < at_mm) ++i;
  const double step = profile.at_mm[i] - profile.at_mm[i - 1];
  const double share = step > 0.0 ? (at_mm - profile.at_mm[i - 1]) / step : 0.0;
  return profile.area_mm2[i - 1] + share * (profile.area_mm2[i] - profile.area_mm2[i - 1]);
}

struct Cap {
  double volume_mm3 = 0.0;
  double length_mm = 0.0;
};

// The integral of c2 x^2 + c1 x + c0 over x from -length to 0.
Cap parabola_cap(double c0, double c1, double c2, double length) {
  return {length * (c0 - length * (0.5 * c1 - length * c2 / 3.0)), length};
}

std::optional<Cap> cap_of(const Profile& profile, double limit_mm) {
  const double scan = profile.at_mm.back();
  const double step = kPart * scan;
  const double a0 = profile.area_mm2.front();
  const double a1 = area_at(profile, step);
  const double a2 = area_at(profile, 2.0 * step);
  if (!(step > 0.0) || a1 <= a0) return std::nullopt;
  const double c2 = (a0 - 2.0 * a1 + a2) / (2.0 * step * step);
  const double c1 = (4.0 * a1 - 3.0 * a0 - a2) / (2.0 * step);
  // The zero nearest to the end, beyond it: c0 and the slope inwards are positive there.
  const double root = c1 * c1 - 4.0 * c2 * a0;
  if (root >= 0.0 && c1 > 0.0) {
    const double length = 2.0 * a0 / (c1 + std::sqrt(root));
    if (length <= kFarthest * scan) return parabola_cap(a0, c1, c2, std::min(length, limit_mm));
  }
  // A tip: the square root of the area, that is the width, shrinks evenly.
  const double slope = (std::sqrt(a1) - std::sqrt(a0)) / step;
  const double length = std::sqrt(a0) / slope;
  if (length > kFarthest * scan) return std::nullopt;
  const double left = std::max(0.0, 1.0 - limit_mm / length);
  return Cap{a0 * length / 3.0 * (1.0 - left * left * left), std::min(length, limit_mm)};
}

// How far beyond a section the nearest frame lies on which the structure is not there.
double way_to_absent(const CrossSection& end, bool first, std::span<const AbsentMark> absent,
                     const FrameLocator& locator) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const AbsentMark& mark : absent) {
    if (first ? mark.frame >= end.frame : mark.frame <= end.frame) continue;
    const auto pose = locator.reference_from_image(mark.frame);
    if (!pose) continue;
    const Eigen::Vector3d normal = pose->linear().col(0).cross(pose->linear().col(1)).normalized();
    nearest = std::min(nearest, std::abs(normal.dot(end.centroid_mm - pose->translation())));
  }
  return nearest;
}

}  // namespace

std::vector<MissingEnd> missing_ends(std::span<const CrossSection> sections, std::span<const AbsentMark> absent,
                                     const FrameLocator& locator) {
  std::vector<MissingEnd> ends;
  if (sections.size() < 3) return ends;
  double largest = 0.0;
  for (const CrossSection& section : sections) largest = std::max(largest, section.vector_area_mm2.norm());
  for (const bool first : {true, false}) {
    const CrossSection& section = first ? sections.front() : sections.back();
    if (section.vector_area_mm2.norm() <= kSmall * largest) continue;
    MissingEnd end;
    end.frame = section.frame;
    end.first = first;
    const auto cap = cap_of(profile_from(sections, first), way_to_absent(section, first, absent, locator));
    if (cap) {
      end.volume_ml = cap->volume_mm3 / kMm3PerMl;
      end.length_mm = cap->length_mm;
      end.high_ml = 2.0 * *end.volume_ml;
    }
    ends.push_back(end);
  }
  return ends;
}

std::string warning_of(const MissingEnd& end) {
  char text[200];
  const char* where = end.first ? "before" : "after";
  if (end.volume_ml) {
    std::snprintf(text, sizeof text,
                  "about %.2g ml (0 to %.2g) of it may lie %s frame %d, up to %.2g mm from it, and are not measured: "
                  "outline further, or mark the extremity",
                  *end.volume_ml, end.high_ml, where, end.frame, end.length_mm);
  } else {
    std::snprintf(text, sizeof text,
                  "its sections do not shrink towards frame %d: how much of it lies %s that frame cannot be told",
                  end.frame, where);
  }
  return text;
}

}  // namespace fathom
