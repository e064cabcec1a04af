#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "sim/studies/bladder_patient.h"
#include "sim/studies/outlining_study.h"
#include "sim/studies/study.h"

namespace fathom {

/// Study "bladder": the partial voiding of Treece 2000, section 2.4.2 in simulation. A case is one scan: the ten of
/// table 2.3 of one patient after the other; there is a patient for every five samples.
const Study& bladder_study();

/// Which methods measure, as numbers in kVolumeMethods.
inline constexpr std::array<std::size_t, 4> kBladderMethods = {0, 1, 3, 7};

/// A scan of a patient's bladder in one fill state: the sweep, of which some frames are outlined.
struct BladderScan {
  SimulatedScan scan;
  Structure true_outlines;
};

/// `number` is that of the scan in kBladderScans_min. Throws Error when the images do not show all of the bladder.
BladderScan scan_bladder(const BladderPatient& patient, std::size_t number, std::uint64_t seed);

/// The outlines that a person makes with the live-wire on the same frames; `trials`, if given, gets one for each.
Structure assisted_outlines(const BladderScan& scan, std::vector<OutliningTrial>* trials);

/// One of them: what the user makes of a frame's image, following its true outline.
OutliningTrial live_wire_outline(const cv::Mat& image, const Contour& truth);

/// Volumes in the order of kBladderMethods.
std::vector<std::optional<double>> bladder_volumes_ml(const BladderScan& scan, const Structure& outlines);

/// What one patient's ten volumes say about what was voided.
struct VoidingExperiment {
  std::vector<double> measured_ml;           ///< ten volumes
  std::array<double, kBladderPairs> rate{};  ///< of filling, ml/min, estimated from each pair
  /// Differences between pairs, adjusted for filling: by a cubic spline through the estimated rates, as published, and
  /// by what really filled the bladder.
  std::array<double, kBladderVoids> estimated_ml{};
  std::array<double, kBladderVoids> known_ml{};
};

/// `measured_ml` are the ten volumes.
VoidingExperiment evaluate_voiding(const BladderPatient& patient, std::vector<double> measured_ml);

/// A line through points, by least squares in y.
struct Regression {
  double slope = 0.0;
  double intercept = 0.0;
  double r = 0.0;
};
Regression regression_of(const std::vector<std::pair<double, double>>& points);

/// Everything that the report is made of, for each patient: volumes by [true, assisted][method][scan]; not a number
/// where there is none.
struct BladderResults {
  BladderPatient patient;
  std::array<std::array<std::vector<double>, kBladderMethods.size()>, 2> volume_ml;
  std::vector<double> true_ml;
  double clicks = 0.0;  ///< for an outline, mean
  double dice = 0.0;    ///< mean
};

StudyReport bladder_report(const std::vector<BladderResults>& patients);

}  // namespace fathom
