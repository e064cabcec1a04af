#include "exam/scan_division.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "measurement/cross_section.h"

namespace fathom {

namespace {

// What is passed between two sections, positive along their frames' normals, in mm3.
double slab_mm3(const CrossSection& from, const CrossSection& to) {
  return 0.5 * (to.vector_area_mm2 + from.vector_area_mm2).dot(to.centroid_mm - from.centroid_mm);
}

std::optional<std::size_t> sweep_of(int frame, const std::vector<Sweep>& sweeps) {
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    if (contains(sweeps[s], frame)) return s;
  }
  return std::nullopt;
}

// Whether sections, taken as those of one sweep, would go back over what they have passed.
bool goes_back(const std::vector<CrossSection>& sections) {
  double forward = 0.0;
  double backward = 0.0;
  for (std::size_t i = 1; i < sections.size(); ++i) {
    const double slab = slab_mm3(sections[i - 1], sections[i]);
    (slab > 0.0 ? forward : backward) += std::abs(slab);
  }
  constexpr double kNoise = 0.02;  // of the way there: tracker noise alone makes steps back
  return std::min(forward, backward) > kNoise * std::max(forward, backward);
}

// Whether a sweep begins behind where the one before it ended: what both passed would count once or not at all.
bool steps_back(const std::vector<CrossSection>& sections, const std::vector<Sweep>& sweeps) {
  constexpr double kNoise = 0.1;  // of a step within the sweep
  double passed = 0.0;
  int steps = 0;
  for (std::size_t i = 1; i < sections.size(); ++i) {
    const double slab = slab_mm3(sections[i - 1], sections[i]);
    if (sweep_of(sections[i].frame, sweeps) == sweep_of(sections[i - 1].frame, sweeps)) {
      passed += slab;
      ++steps;
      continue;
    }
    if (slab * passed < 0.0 && std::abs(slab) > kNoise * std::abs(passed) / steps) return true;
    passed = 0.0;
    steps = 0;
  }
  return false;
}

// Whether any structure has outlines in two of the sweeps and goes back in one or between them.
bool are_several(const std::vector<Structure>& structures, const Scan& scan, const std::vector<Sweep>& sweeps) {
  return std::any_of(structures.begin(), structures.end(), [&](const Structure& structure) {
    std::set<std::size_t> used;
    for (const Contour& contour : structure.contours) {
      if (const auto sweep = sweep_of(contour.frame, sweeps)) used.insert(*sweep);
    }
    if (used.size() < 2) return false;
    const std::vector<CrossSection> sections = cross_sections(structure, scan.locators.front(), nullptr);
    return goes_back(sections) || steps_back(sections, sweeps);
  });
}

}  // namespace

std::optional<Division> division_of(PlanesFile stated, const Scan& scan, const std::vector<Structure>& structures) {
  const bool divided = !stated.sweeps.empty() || !stated.planes.empty() || scan.recordings.size() > 1;
  if (stated.sweeps.empty() && divided) stated.sweeps = find_sweeps(scan);
  if (!divided) {
    stated.sweeps = find_sweeps(*scan.recordings.front(), scan.locators.front());
    if (stated.sweeps.size() < 2 || !are_several(structures, scan, stated.sweeps)) return std::nullopt;
  }
  // Without planes nobody asks where the sweeps lie, which needs images.
  SpacePartition partition;
  if (!stated.planes.empty()) partition = SpacePartition(sweep_shapes(stated.sweeps, scan), std::move(stated.planes));
  return Division{std::move(stated.sweeps), std::move(partition)};
}

}  // namespace fathom
