#pragma once

#include "exam/confidence.h"
#include "exam/scan.h"
#include "registration/division.h"

namespace fathom {

/// The interval of a structure's volume over the parts of space of a division with planes; where to outline next and
/// missing ends are told of single sweeps only. Throws Error as measure_partitions; Cancelled.
Confidence divided_confidence(const Structure& structure, const Scan& scan, const Division& division,
                              const MeasurementErrors& errors, const Progress& progress = {});

}  // namespace fathom
