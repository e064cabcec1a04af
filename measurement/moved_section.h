#pragma once

#include <Eigen/Geometry>

#include "measurement/section_outline.h"

namespace fathom {

/// A section as if its frame lay elsewhere.
SectionOutline moved(SectionOutline section, const Eigen::Isometry3d& motion);

/// A section as if it had been outlined so many millimetres (far less than its size) farther out everywhere: holes get
/// smaller. Its area grows in proportion; its centroid stays.
SectionOutline grown(SectionOutline section, double by_mm);

}  // namespace fathom
