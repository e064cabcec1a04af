#pragma once

#include <string>
#include <vector>

#include "core/progress.h"
#include "exam/document.h"
#include "exam/results.h"

namespace fathom {

/// Measures a document as `fathom measure` does its exam, with intervals also where the options do not ask for them.
/// Throws Error as measure_structures does, for outlines that
/// cross themselves or are open where they must not be, and without a calibration; Cancelled.
std::vector<StructureResult> measure_document(const DocumentSnapshot& document, const MeasureOptions& options = {},
                                              const Progress& progress = {});

/// A line for each structure and, below it, for each part of space: structure, sweep (from 1, empty for the whole),
/// sections, the volumes in ml under the names of results_json, the ends of their interval, and the warnings. Values
/// that are not known are empty. RFC 4180, with a head line; the decimal point is a point.
std::string results_csv(const std::vector<StructureResult>& results);

/// One cross-section for people: where and how large.
struct SectionRow {
  std::size_t sweep = 0;
  int recording = 0;
  int frame = 0;
  double area_cm2 = 0.0;
  double along_mm = 0.0;  ///< way of the centroids from the sweep's first section
};

/// The cross-sections of a structure in the order of sweeps and frames. Throws Error as cross_sections.
std::vector<SectionRow> section_rows(const Structure& structure, const Scan& scan,
                                     const std::optional<Division>& division);

}  // namespace fathom
