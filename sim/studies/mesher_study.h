#pragma once

#include "sim/studies/study.h"

namespace fathom {

/// Study 3: marching cubes, marching tetrahedra and regularised marching tetrahedra beside each other: triangles,
/// volumes, areas, quality and variation of shading. Treece 2000, section 3.6, tables 3.2 to 3.4. A case is one mesh,
/// or one set of pictures of a sphere. Nothing is left to chance.
const Study& mesher_study();

}  // namespace fathom
