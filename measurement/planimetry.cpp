#include "measurement/planimetry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/error.h"
#include "measurement/cubic_spline.h"
#include "measurement/planar_representation.h"
#include "measurement/sweep_path.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;

// Of the path's length. A sweep whose ends lie nearer to each other has come back to where it began.
constexpr double kClosedPath = 1e-6;

// Cosine. An end plane that holds the chord of the sweep to within this faces neither way.
constexpr double kEdgeOn = 1e-9;

// Sine of the angle between the end planes below which they count as parallel and have no line in common.
constexpr double kCrossingPlanes = 0.17;  // 10 degrees: below that a sweep is no rotation

// Of the radius of the largest section, as a disc. End planes that cross nearer than this to its centre cross in the
// object; those of a fan cross at the probe, outside of it.
constexpr double kInsideObject = 0.5;

// A part that is swept backwards is worth a warning from this share of the volume on: with outlines on every frame,
// tracker noise alone makes steps back.
constexpr double kWorthTelling = 1e-3;

// Of the largest section's area. An ellipsoid that goes on beyond a section of this size has 1.3 % of its volume there.
constexpr double kLargeEnd = 0.25;

constexpr std::size_t kTurnsToName = 3;  // turns back beyond these are counted, not listed

std::string frames(const CrossSection& from, const CrossSection& to) {
  return "frames " + std::to_string(from.frame) + " and " + std::to_string(to.frame);
}

// Signed volume of the slab that ends at section i, in mm3. Treece 2000, one term of equation (2.2).
double slab_mm3(std::span<const CrossSection> sections, std::size_t i) {
  return 0.5 * (sections[i].vector_area_mm2 + sections[i - 1].vector_area_mm2)
                   .dot(sections[i].centroid_mm - sections[i - 1].centroid_mm);
}

bool ends_where_it_began(std::span<const CrossSection> sections) {
  const double chord = (sections.back().centroid_mm - sections.front().centroid_mm).norm();
  return chord <= kClosedPath * path_length_mm(sections);
}

// Whether the line that the end planes have in common passes through the middle of the largest section, as it does
// when the probe was turned about an axis inside the organ.
bool end_planes_cross_inside(std::span<const CrossSection> sections) {
  const Eigen::Vector3d first = facing(sections.front());
  const Eigen::Vector3d last = facing(sections.back());
  const Eigen::Vector3d along = first.cross(last);
  const double sine = along.norm();
  if (sine < kCrossingPlanes) return false;
  const CrossSection& largest =
      *std::max_element(sections.begin(), sections.end(), [](const CrossSection& a, const CrossSection& b) {
        return a.vector_area_mm2.squaredNorm() < b.vector_area_mm2.squaredNorm();
      });
  const double radius = std::sqrt(largest.vector_area_mm2.norm() / std::numbers::pi);
  // Distances of the centre from the two planes; those from their common line follow from the angle between them.
  const double a = first.dot(largest.centroid_mm - sections.front().centroid_mm);
  const double b = last.dot(largest.centroid_mm - sections.back().centroid_mm);
  const double distance = std::sqrt(std::max(0.0, a * a + b * b - 2.0 * a * b * first.dot(last))) / sine;
  return distance < kInsideObject * radius;
}

// Why there is no volume, for the user; empty where there is one.
std::string reason_for_no_volume(std::span<const CrossSection> sections) {
  if (sections.empty()) return "no outlined frames: no volume; outline the organ on at least two frames";
  if (sections.size() == 1) {
    return "only frame " + std::to_string(sections.front().frame) +
           " is outlined: no volume; outline the organ on at least two frames";
  }
  bool area = false;
  for (const CrossSection& section : sections) {
    if (!section.vector_area_mm2.allFinite() || !section.centroid_mm.allFinite() || !section.normal.allFinite()) {
      return "frame " + std::to_string(section.frame) +
             ": its outline has no finite position: no volume; check the calibration and the pose of this frame";
    }
    area |= section.vector_area_mm2.squaredNorm() > 0.0;
  }
  if (!area) return "no outline encloses an area: no volume; outline the organ on frames that cut through it";
  if (same_sense(sections)) return {};
  if (ends_where_it_began(sections)) {
    return frames(sections.front(), sections.back()) +
           ": the sweep ends where it began (turned on the spot, or there and back; a rotational sweep): no volume; "
           "sweep along the organ once, from one end to the other";
  }
  return frames(sections.front(), sections.back()) +
         ": the first and last planes do not face the organ from opposite ends (a rotational sweep): no volume; sweep "
         "along the organ, from one end to the other";
}

void require_volume(std::span<const CrossSection> sections) {
  const std::string reason = reason_for_no_volume(sections);
  if (!reason.empty()) throw Error(reason);
}

double linear_mm3(std::span<const CrossSection> sections) {
  double sum = 0.0;
  for (std::size_t i = 1; i < sections.size(); ++i) sum += slab_mm3(sections, i);
  return sum;
}

double cubic_mm3(std::span<const CrossSection> sections, SplineEnd end) {
  const PlanarRepresentation plane = planar_representation(sections);
  const double volume = std::abs(swept_volume<2>(plane.normals, plane.centres, end));
  if (!plane.ambiguous) return volume;
  // Open turns keep the sense of the one before, so the other end may give another drawing, just as good: taking the
  // mean makes the volume the same whichever way the probe went.
  const std::vector<CrossSection> reversed(sections.rbegin(), sections.rend());
  const PlanarRepresentation other = planar_representation(reversed);
  return 0.5 * (volume + std::abs(swept_volume<2>(other.normals, other.centres, end)));
}

double cubic_3d_mm3(std::span<const CrossSection> sections, SplineEnd end) {
  std::vector<Eigen::Vector3d> s;
  std::vector<Eigen::Vector3d> omega;
  s.reserve(sections.size());
  omega.reserve(sections.size());
  for (const CrossSection& section : sections) {
    s.push_back(section.vector_area_mm2);
    omega.push_back(section.centroid_mm - sections.front().centroid_mm);  // near the origin, for precision
  }
  return std::abs(swept_volume<3>(s, omega, end));
}

double quadric_mm3(std::span<const CrossSection> sections) {
  double sum = 0.0;
  for (const GapVolumes& gap : gap_volumes(sections)) sum += gap.quadric_mm3;
  return std::abs(sum);
}

// One warning for each stretch on which the sweep goes back over what it has passed.
std::vector<std::string> turns_back(std::span<const CrossSection> sections) {
  const double total = linear_mm3(sections);
  std::vector<std::string> warnings;
  std::size_t turns = 0;
  for (std::size_t i = 1; i < sections.size();) {
    const std::size_t first = i - 1;
    double back = 0.0;
    for (; i < sections.size() && slab_mm3(sections, i) * total < 0.0; ++i) back += std::abs(slab_mm3(sections, i));
    if (i == first + 1) {
      ++i;
    } else if (back > kWorthTelling * std::abs(total) && ++turns <= kTurnsToName) {
      warnings.push_back("the sweep turns back between " + frames(sections[first], sections[i - 1]) +
                         ": that part is subtracted");
    }
  }
  if (turns > kTurnsToName) {
    warnings.push_back("the sweep turns back in " + std::to_string(turns - kTurnsToName) +
                       " more places: those parts are subtracted");
  }
  return warnings;
}

// A warning where the outlines stop short of the organ's ends, as far as can be told: an end may be a flat face.
std::optional<std::string> large_end(std::span<const CrossSection> sections, const CutEnds& cut) {
  double largest = 0.0;
  for (const CrossSection& section : sections) largest = std::max(largest, section.vector_area_mm2.norm());
  const auto percent = [&](const CrossSection& section) {
    return static_cast<int>(std::lround(100.0 * section.vector_area_mm2.norm() / largest));
  };
  std::string where;
  for (const auto& [section, known] :
       {std::pair(&sections.front(), cut.first), std::pair(&sections.back(), cut.last)}) {
    if (known || section->vector_area_mm2.norm() <= kLargeEnd * largest) continue;
    where += (where.empty() ? "" : " and ") + std::to_string(percent(*section)) + " % on frame " +
             std::to_string(section->frame);
  }
  if (where.empty()) return std::nullopt;
  return "the outlines end where the sections are still large (" + where +
         " of the largest): what lies beyond is not measured";
}

}  // namespace

bool same_sense(std::span<const CrossSection> sections) {
  if (ends_where_it_began(sections)) return false;
  const Eigen::Vector3d chord = (sections.back().centroid_mm - sections.front().centroid_mm).normalized();
  const double first = facing(sections.front()).dot(chord);
  const double last = facing(sections.back()).dot(chord);
  return std::min(std::abs(first), std::abs(last)) >= kEdgeOn && (first < 0.0) == (last < 0.0);
}

double linear_planimetry_ml(std::span<const CrossSection> sections) {
  require_volume(sections);
  return std::abs(linear_mm3(sections)) / kMm3PerMl;
}

double cubic_planimetry_ml(std::span<const CrossSection> sections, SplineEnd end) {
  require_volume(sections);
  return cubic_mm3(sections, end) / kMm3PerMl;
}

double cubic_planimetry_3d_ml(std::span<const CrossSection> sections, SplineEnd end) {
  require_volume(sections);
  return cubic_3d_mm3(sections, end) / kMm3PerMl;
}

double quadric_planimetry_ml(std::span<const CrossSection> sections) {
  require_volume(sections);
  return quadric_mm3(sections) / kMm3PerMl;
}

VolumeMeasurement measure_planimetry(std::span<const CrossSection> sections, const CutEnds& cut) {
  VolumeMeasurement measurement;
  measurement.sections = static_cast<int>(sections.size());
  std::string reason = reason_for_no_volume(sections);
  // A turn by less than half a circle can pass the test of equation (2.1) and give a number, but a meaningless one.
  if (reason.empty() && end_planes_cross_inside(sections)) {
    reason = frames(sections.front(), sections.back()) +
             ": the first and last planes cross inside the organ (a rotational sweep): no volume; sweep along the "
             "organ, from one end to the other";
  }
  if (!reason.empty()) {
    measurement.warnings.push_back(reason);
    return measurement;
  }
  measurement.volumes.linear_ml = std::abs(linear_mm3(sections)) / kMm3PerMl;
  measurement.volumes.cubic_ml = cubic_mm3(sections, SplineEnd::kRepeat) / kMm3PerMl;
  measurement.volumes.cubic_3d_ml = cubic_3d_mm3(sections, SplineEnd::kRepeat) / kMm3PerMl;
  measurement.volumes.quadric_ml = quadric_mm3(sections) / kMm3PerMl;
  if (sections.size() == 2) {
    measurement.warnings.push_back("only " + frames(sections.front(), sections.back()) +
                                   " are outlined: the volume is the trapezoid between them; outline more frames");
  } else if (const auto warning = large_end(sections, cut)) {
    measurement.warnings.push_back(*warning);
  }
  for (std::string& warning : turns_back(sections)) measurement.warnings.push_back(std::move(warning));
  return measurement;
}

}  // namespace fathom
