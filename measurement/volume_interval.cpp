#include "measurement/volume_interval.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "measurement/frame_marks.h"
#include "measurement/planimetry.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
constexpr double k95 = 1.96;  // standard deviations on either side that hold 95 %

// What the true error of quadric planimetry is of the root sum of squares of the changes by leaving sections out.
constexpr double kSpacingShare = 0.25;
// The same where the changes come from scatter of the outlines: a section that is left out takes its own error along
// and those of its neighbours at half weight, so that the squares add up to one and a half times the variance.
constexpr double kScatterSquares = 1.5;
// Of the volume: below that, rounding of contours and poses decides.
constexpr double kFloor = 2e-4;

// What the volume changes by, in mm3, with the place of a section and with its vector area, by equation (2.2).
struct Weights {
  Eigen::Vector3d place;
  Eigen::Vector3d area;
};

std::vector<Weights> weights_of(std::span<const CrossSection> sections) {
  std::vector<Weights> weights;
  const std::size_t last = sections.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    const CrossSection& before = sections[i > 0 ? i - 1 : 0];
    const CrossSection& after = sections[std::min(i + 1, last)];
    Weights weight;
    weight.area = 0.5 * (after.centroid_mm - before.centroid_mm);
    weight.place = 0.5 * (before.vector_area_mm2 - after.vector_area_mm2);
    if (i == 0) weight.place = -0.5 * (sections[0].vector_area_mm2 + after.vector_area_mm2);
    if (i == last) weight.place = 0.5 * (before.vector_area_mm2 + sections[last].vector_area_mm2);
    weights.push_back(weight);
  }
  return weights;
}

double quadric_mm3(std::span<const CrossSection> sections) {
  double sum = 0.0;
  for (const GapVolumes& gap : gap_volumes(sections)) sum += gap.quadric_mm3;
  return sum;
}

// The squares of the changes, in mm6, when each inner section in turn is left out.
double squares_of_leaving_out(std::span<const CrossSection> sections) {
  const double whole = quadric_mm3(sections);
  double squares = 0.0;
  std::vector<CrossSection> rest(sections.begin() + 1, sections.end());
  rest.front() = sections.front();
  for (std::size_t left_out = 1; left_out + 1 < sections.size(); ++left_out) {
    const double change = quadric_mm3(rest) - whole;
    squares += change * change;
    rest[left_out] = sections[left_out];
  }
  return squares;
}

double perimeter_mm(const std::vector<const Polygon*>& outlines, const Eigen::Affine3d& reference_from_image) {
  double sum = 0.0;
  const Eigen::Matrix<double, 3, 2> axes = reference_from_image.linear().leftCols<2>();
  for (const Polygon* outline : outlines) {
    for (std::size_t i = 0; i < outline->size(); ++i) {
      sum += (axes * ((*outline)[(i + 1) % outline->size()] - (*outline)[i])).norm();
    }
  }
  return sum;
}

}  // namespace

void MeasurementErrors::check() const {
  const auto right = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!right(outline_mm.value_or(0.0)) || !right(tracker_mm) || !right(tracker_deg)) {
    throw Error("standard deviations of outlines and tracker must be finite and not negative");
  }
}

VolumeInterval interval_about(double volume_ml, const VolumeVariances& found, bool outline_known,
                              double calibration_ml) {
  const double left_out =
      std::max(0.0, found.left_out_mm6 - kScatterSquares * (found.outlining_mm6 + found.tracker_mm6));
  const double spacing = outline_known ? kSpacingShare * kSpacingShare * left_out : left_out / kScatterSquares;
  VolumeInterval interval;
  interval.spacing_ml = std::hypot(std::sqrt(spacing) / kMm3PerMl, kFloor * volume_ml);
  interval.outlining_ml = std::sqrt(found.outlining_mm6) / kMm3PerMl;
  interval.tracker_ml = std::sqrt(found.tracker_mm6) / kMm3PerMl;
  interval.calibration_ml = calibration_ml;
  const double sd_ml = std::hypot(std::hypot(interval.spacing_ml, interval.outlining_ml),
                                  std::hypot(interval.tracker_ml, interval.calibration_ml));
  interval.low_ml = std::max(0.0, volume_ml - k95 * sd_ml);
  interval.high_ml = volume_ml + k95 * sd_ml;
  return interval;
}

std::optional<VolumeInterval> volume_interval(std::span<const CrossSection> sections,
                                              std::span<const SectionPlace> places, const MeasurementErrors& errors,
                                              double calibration_ml) {
  assert(sections.size() == places.size());
  if (sections.size() < kFewestForInterval || !measure_planimetry(sections).volumes.quadric_ml) return std::nullopt;
  const double turn_rad = errors.tracker_deg * std::numbers::pi / 180.0;
  double outlining = 0.0;  // variances in mm6
  double tracker = 0.0;
  const std::vector<Weights> weights = weights_of(sections);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const CrossSection& section = sections[i];
    const Weights& weight = weights[i];
    const double by_outline =
        weight.area.dot(section.normal) * places[i].perimeter_mm * errors.outline_mm.value_or(0.0);
    outlining += by_outline * by_outline;
    const Eigen::Vector3d by_turn =
        (section.centroid_mm - places[i].probe_mm).cross(weight.place) + section.vector_area_mm2.cross(weight.area);
    // Root mean squares in space are shared by three axes.
    tracker += (weight.place.squaredNorm() * errors.tracker_mm * errors.tracker_mm +
                by_turn.squaredNorm() * turn_rad * turn_rad) /
               3.0;
  }
  return interval_about(std::abs(quadric_mm3(sections)) / kMm3PerMl,
                        {squares_of_leaving_out(sections), outlining, tracker}, errors.outline_mm.has_value(),
                        calibration_ml);
}

std::vector<SectionPlace> section_places(const Structure& structure, std::span<const CrossSection> sections,
                                         const FrameLocator& locator, const Calibration& calibration) {
  std::vector<SectionPlace> places;
  const Eigen::Affine3d image_from_probe = calibration.probe_from_image.inverse();
  std::size_t next = 0;
  for (const FrameMarks& marks : frame_marks(structure, locator)) {
    if (next == sections.size()) break;
    if (marks.frame != sections[next].frame) continue;
    const Eigen::Affine3d reference_from_image = *locator.reference_from_image(marks.frame);
    places.push_back(
        {perimeter_mm(marks.outlines, reference_from_image), (reference_from_image * image_from_probe).translation()});
    ++next;
  }
  assert(places.size() == sections.size());
  return places;
}

}  // namespace fathom
