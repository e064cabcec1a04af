#pragma once

#include <optional>
#include <vector>

#include "exam/scan.h"
#include "registration/dividing_planes.h"
#include "registration/division.h"
#include "segmentation/contours.h"

namespace fathom {

/// How the sweeps of a scan share space, where these sweeps and planes are stated: without sweeps those that are found
/// are meant. Empty where nothing is stated and the scan can be taken as one sweep. Throws Error as find_sweeps,
/// cross_sections and SpacePartition do.
std::optional<Division> division_of(PlanesFile stated, const Scan& scan, const std::vector<Structure>& structures);

}  // namespace fathom
