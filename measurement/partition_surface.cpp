#include "measurement/partition_surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/numbers.h"
#include "measurement/cross_section.h"
#include "measurement/section_outline.h"
#include "measurement/short_ends.h"
#include "registration/convex_parts.h"
#include "surface/mesh_measure.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
// Share of a cut that may be inside on one side only before it is worth a word: interpolation does as much. Where it is
// most of the cut, what one side lacks is in no part, or in two.
constexpr double kMismatch = 0.05;
constexpr double kNoSum = 0.5;
// Shares of the volume below which what such an area bounds, as deep as wide, is neither: the plane grazes.
constexpr double kGrazing = 1e-3;
constexpr double kGrazingNoSum = 0.02;
constexpr int kClosingSteps = 32;  // at which the line that closes a contour is looked at

std::string numbered(const char* what, std::size_t index) { return what + (" " + std::to_string(index + 1)); }

int frames_with_marks(const Structure& structure) {
  std::set<int> frames;
  for (const Contour& contour : structure.contours) frames.insert(contour.frame);
  for (const Extremity& extremity : structure.extremities) frames.insert(extremity.frame);
  return static_cast<int>(frames.size());
}

// An open contour's ends must be joined where another sweep is used; else the line is taken for the structure's border.
void check_closing_lines(const Structure& structure, const FrameLocator& locator, const Sweep& sweep, std::size_t index,
                         const SpacePartition& partition, std::vector<std::string>& warnings) {
  for (const Contour& contour : structure.contours) {
    if (contour.closed || contour.points_px.empty() || !contains(sweep, contour.frame) ||
        contour.recording != static_cast<int>(sweep.recording)) {
      continue;
    }
    const auto reference_from_image = locator.reference_from_image(contour.frame);
    if (!reference_from_image) continue;
    int inside = 0;
    for (int i = 0; i <= kClosingSteps; ++i) {
      const Eigen::Vector2d at = contour.points_px.back() + static_cast<double>(i) / kClosingSteps *
                                                                (contour.points_px.front() - contour.points_px.back());
      inside += partition.sweep_at(*reference_from_image * Eigen::Vector3d(at.x(), at.y(), 0.0)) == index;
    }
    if (inside == 0) continue;
    warnings.push_back("frame " + std::to_string(contour.frame) +
                       ": the open contour is closed by a straight line, of which " +
                       format_real(std::round(100.0 * inside / (kClosingSteps + 1))) + " % lies where " +
                       numbered("sweep", index) + " is used; draw the contour on to beyond the plane");
  }
}

void measure(PartSurface& part, const ClippedMesh& closed, const std::vector<DividingPlane>& planes,
             const std::optional<double>& sweep_volume_ml, Caps caps) {
  if (!sweep_volume_ml) {
    part.no_volume = "the sweep turns so that volumes have no meaning; `fathom measure` says why";
    return;
  }
  if (caps == Caps::kClosed) {
    part.volume_ml = volume_mm3(closed.mesh) / kMm3PerMl;
    return;
  }
  if (part.planes.size() > 2) {
    part.no_volume = "it is open where " + std::to_string(part.planes.size()) +
                     " planes cut it, and has a volume where no more than two do; close it";
    return;
  }
  std::vector<Eigen::Vector3d> normals;
  for (const std::size_t plane : part.planes) normals.push_back(planes[plane].normal());
  part.volume_ml = projected_volume_mm3(part.surface.mesh, normals) / kMm3PerMl;
}

void name_planes(ClippedMesh& surface, const std::vector<std::size_t>& planes) {
  for (int& plane : surface.plane_of) {
    if (plane != ClippedMesh::kSurface) plane = static_cast<int>(planes[static_cast<std::size_t>(plane)]);
  }
}

// Cuts one sweep's surface to a part of space. The second is the part with caps, whatever `caps`.
std::pair<PartSurface, ClippedMesh> cut_part(const ContourSurface& whole, const ConvexPart& space,
                                             const SpacePartition& partition, Caps caps) {
  ClippedMesh closed = clip_mesh(whole.mesh(), space.bounds);
  PartSurface part;
  part.sweep = space.sweep;
  part.region = space.region;
  name_planes(closed, space.planes);
  if (closed.mesh.triangles.empty()) return {std::move(part), std::move(closed)};
  for (const std::size_t plane : space.planes) {
    const auto caps_plane = static_cast<int>(plane);
    if (std::find(closed.plane_of.begin(), closed.plane_of.end(), caps_plane) != closed.plane_of.end()) {
      part.planes.push_back(plane);
    }
  }
  part.surface = caps == Caps::kClosed ? closed : clip_mesh(whole.mesh(), space.bounds, Caps::kOpen);
  measure(part, closed, partition.planes(), whole.volume_ml(), caps);
  return {std::move(part), std::move(closed)};
}

double parts_ml(const PartitionedSurface& surface) {
  double sum_ml = 0.0;
  for (const PartSurface& part : surface.parts) sum_ml += part.volume_ml.value_or(0.0);
  return sum_ml;
}

bool is_apart(const PlaneMatch& match, double volume_ml, double share, double grazing) {
  return match.mismatch_share() > share &&
         std::pow(match.mismatch_mm2, 1.5) / kMm3PerMl > grazing * std::abs(volume_ml);
}

// Why the sum of all parts is not the structure's volume; empty where it is.
std::string missing_part(const PartitionedSurface& surface, std::span<const FilledPart> parts,
                         const std::vector<bool>& outlined, const SpacePartition& partition) {
  for (const PartSurface& part : surface.parts) {
    if (!part.volume_ml) return "there is no sum: the part of " + numbered("sweep", part.sweep) + " has no volume";
  }
  for (const PlaneMatch& match : surface.planes) {
    if (match.above_mm2 != 0.0 && match.below_mm2 != 0.0) continue;
    for (const FilledPart& part : parts) {
      const bool borders =
          std::find(part.space.planes.begin(), part.space.planes.end(), match.plane) != part.space.planes.end();
      if (!borders || outlined[part.space.sweep]) continue;
      const bool on_empty_side = is_above(part.space, match.plane, partition) == (match.above_mm2 == 0.0);
      if (!on_empty_side) continue;
      return "there is no sum: the structure goes on beyond " + numbered("dividing plane", match.plane) + ", where " +
             numbered("sweep", part.space.sweep) + " is used, which has no outlines; outline it there too";
    }
  }
  for (const PlaneMatch& match : surface.planes) {
    if (is_apart(match, parts_ml(surface), kNoSum, kGrazingNoSum)) {
      return "there is no sum: most of the cut at " + numbered("dividing plane", match.plane) +
             " lies in one part only; outline both sweeps on to beyond it, or move it";
    }
  }
  return {};
}

std::string mismatch_warning(const PlaneMatch& match) {
  char text[200];
  std::snprintf(text, sizeof text,
                "the parts do not meet at dividing plane %zu: it cuts %.0f mm2 of one and %.0f mm2 of the other, and "
                "%.0f mm2 lie in one only",
                match.plane + 1, match.above_mm2, match.below_mm2, match.mismatch_mm2);
  return text;
}

// Makes the surfaces of all sweeps that have outlines and are used somewhere; nothing for others.
std::vector<std::optional<ContourSurface>> sweep_surfaces(const Structure& structure,
                                                          std::span<const FrameLocator> locators,
                                                          const Division& division, const std::vector<bool>& used,
                                                          const ContourSurfaceOptions& options,
                                                          const Progress& progress,
                                                          std::vector<std::string>& warnings) {
  std::vector<std::optional<ContourSurface>> surfaces(division.sweeps.size());
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const FrameLocator& locator = locators[division.sweeps[i].recording];
    const Structure marked = part_in_sweep(structure, division.sweeps[i]);
    if (!used[i] || marked.contours.empty()) continue;
    if (frames_with_marks(marked) < 2) {
      throw Error(locator.recording_name() + ": structure " + structure.name + ": " + numbered("sweep", i) +
                  " has one outlined frame, and a surface takes two; outline more of its frames, or none");
    }
    const double count = static_cast<double>(surfaces.size());
    const double done = static_cast<double>(i) / count;
    surfaces[i].emplace(locator, options);
    surfaces[i]->update(marked, part_of(progress, done, done + 1.0 / count));
    for (const std::string& warning : surfaces[i]->warnings())
      warnings.push_back(numbered("sweep", i) + ": " + warning);
    for (const ShortEnd& end :
         short_ends(cross_sections(marked, locator, nullptr), marked.absent, i, division.partition)) {
      warnings.push_back(warning_of(end, i));
    }
  }
  return surfaces;
}

void append(const Mesh& part, Mesh& whole) {
  const auto first = static_cast<std::int32_t>(whole.vertices.size());
  const bool any_signs = !part.sweep_signs.empty() || !whole.sweep_signs.empty();
  if (any_signs) {
    whole.sweep_signs.resize(whole.triangles.size(), 1);
    whole.sweep_signs.insert(whole.sweep_signs.end(), part.sweep_signs.begin(), part.sweep_signs.end());
    whole.sweep_signs.resize(whole.triangles.size() + part.triangles.size(), 1);
  }
  whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
  whole.normals.insert(whole.normals.end(), part.normals.begin(), part.normals.end());
  for (const auto& [a, b, c] : part.triangles) whole.triangles.push_back({first + a, first + b, first + c});
}

// A single sweep has all of space, which no plane need tell.
Division with_space(Division division, std::span<const FrameLocator> locators) {
  if (division.sweeps.size() == 1 && division.partition.planes().empty()) {
    const Sweep& sweep = division.sweeps.front();
    division.partition = SpacePartition({sweep_shape(sweep, locators[sweep.recording], 1, 1)});
  }
  return division;
}

}  // namespace

Mesh PartitionedSurface::mesh() const {
  Mesh whole;
  for (const PartSurface& part : parts) append(part.surface.mesh, whole);
  return whole;
}

double PartitionedSurface::surface_area_mm2() const {
  double sum_mm2 = 0.0;
  for (const PartSurface& part : parts) {
    Mesh outer = part.surface.mesh;
    outer.triangles.clear();
    for (std::size_t t = 0; t < part.surface.plane_of.size(); ++t) {
      if (part.surface.plane_of[t] == ClippedMesh::kSurface) outer.triangles.push_back(part.surface.mesh.triangles[t]);
    }
    sum_mm2 += area_mm2(outer);
  }
  return sum_mm2;
}

PartitionedSurface partition_surface(const Structure& structure, std::span<const FrameLocator> locators,
                                     const Division& asked, const ContourSurfaceOptions& options, Caps caps,
                                     const Progress& progress) {
  const Division division = with_space(asked, locators);
  const std::vector<Sweep>& sweeps = division.sweeps;
  const SpacePartition& partition = division.partition;
  if (sweeps.size() > 1 && partition.planes().empty()) {
    throw Error(locators.front().recording_name() + ": has " + std::to_string(sweeps.size()) +
                " sweeps and no dividing planes, so that their surfaces overlap; add a plane");
  }
  assert(sweeps.size() == partition.sweeps().size());
  PartitionedSurface result;
  const std::vector<ConvexPart> spaces = convex_parts(partition);
  std::vector<bool> used(sweeps.size(), false);
  for (const ConvexPart& space : spaces) used[space.sweep] = true;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    check_closing_lines(structure, locators[sweeps[i].recording], sweeps[i], i, partition, result.warnings);
  }
  const auto surfaces =
      sweep_surfaces(structure, locators, division, used, options, part_of(progress, 0.0, 0.9), result.warnings);

  std::vector<FilledPart> filled;
  std::vector<bool> outlined(sweeps.size(), false);
  for (const ConvexPart& space : spaces) {
    filled.push_back({space, {}});
    if (!surfaces[space.sweep]) continue;
    outlined[space.sweep] = true;
    auto [part, closed] = cut_part(*surfaces[space.sweep], space, partition, caps);
    filled.back().closed = std::move(closed);
    if (!part.surface.mesh.triangles.empty()) result.parts.push_back(std::move(part));
  }
  if (result.parts.empty()) {
    throw Error(locators.front().recording_name() + ": structure " + structure.name +
                ": nothing of it lies where the sweep that it was outlined in is used; outline it in the other sweeps");
  }
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    const bool has_part =
        std::any_of(result.parts.begin(), result.parts.end(), [i](const PartSurface& part) { return part.sweep == i; });
    if (outlined[i] && !has_part) {
      result.warnings.push_back("nothing that was outlined in " + numbered("sweep", i) +
                                " lies where that sweep is used");
    }
  }
  result.planes = match_planes(filled, partition);
  for (const PlaneMatch& match : result.planes) {
    if (is_apart(match, parts_ml(result), kMismatch, kGrazing)) result.warnings.push_back(mismatch_warning(match));
  }
  const std::string missing = missing_part(result, filled, outlined, partition);
  if (missing.empty()) {
    result.volume_ml = parts_ml(result);
  } else {
    result.warnings.push_back(missing);
  }
  report(progress, 1.0);
  return result;
}

}  // namespace fathom
