#include "sim/studies/interval_study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <Eigen/Geometry>

#include "core/random.h"
#include "measurement/planimetry.h"
#include "measurement/volume_interval.h"
#include "sim/studies/planimetry_study.h"

namespace fathom {

namespace {

constexpr int kFewest = 5;
constexpr int kMost = 20;
constexpr double kMostNoise_mm = 0.3;
constexpr double kTurnOfNoise = 0.15 / 0.25;  // degrees for each mm: what "0.25 mm noise" means (Treece 2000)
constexpr int kOracleSamples = 200;
constexpr double k95 = 1.96;

// An exam without errors: sections of true outlines, and what errors act on.
struct Exam {
  std::vector<CrossSection> sections;
  std::vector<SectionPlace> places;
  double truth_ml = 0.0;
};

Exam true_exam(const PlanimetryRow& row, int frames) {
  SimulateOptions options;
  options.object = row.object;
  options.pattern = row.pattern;
  options.frames = frames;
  const SimulatedScan scan = simulate(options);
  const FrameLocator locator(*scan.recording, scan.calibration);
  const Structure& outlines = scan.outlines.front();
  Exam exam;
  exam.sections = cross_sections(outlines, locator, nullptr);
  exam.places = section_places(outlines, exam.sections, locator, scan.calibration);
  exam.truth_ml = scan.truth.volume_ml;
  return exam;
}

Eigen::Vector3d normal_vector(Random& random, double rms) {
  const double sd = rms / std::sqrt(3.0);
  const double x = random.normal();
  const double y = random.normal();
  return sd * Eigen::Vector3d(x, y, random.normal());
}

// The same sections as a tracker with noise and an outliner with scatter would have made them.
std::vector<CrossSection> disturbed(const Exam& exam, const MeasurementErrors& errors, Random& random) {
  std::vector<CrossSection> sections = exam.sections;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    CrossSection& section = sections[i];
    const Eigen::Vector3d turn = normal_vector(random, errors.tracker_deg * std::numbers::pi / 180.0);
    const Eigen::Vector3d shift = normal_vector(random, errors.tracker_mm);
    const double grown_mm = *errors.outline_mm * random.normal();
    const Eigen::AngleAxisd rotation(turn.norm(), turn.norm() > 0.0 ? turn.normalized() : Eigen::Vector3d::UnitX());
    const double area = section.vector_area_mm2.norm();
    // A border moved by d, to second order: the outline of a disc grows by 2 pi d.
    const double moved = area + exam.places[i].perimeter_mm * grown_mm + std::numbers::pi * grown_mm * grown_mm;
    if (area > 0.0) section.vector_area_mm2 *= std::max(0.0, moved) / area;
    section.vector_area_mm2 = rotation * section.vector_area_mm2;
    section.normal = rotation * section.normal;
    section.centroid_mm = exam.places[i].probe_mm + rotation * (section.centroid_mm - exam.places[i].probe_mm) + shift;
  }
  return sections;
}

double rms_error_ml(const Exam& exam, const MeasurementErrors& errors, Random& random) {
  double squares = 0.0;
  for (int i = 0; i < kOracleSamples; ++i) {
    // Not quadric_planimetry_ml, which refuses the few in which noise has turned an end plane away.
    double volume_mm3 = 0.0;
    for (const GapVolumes& gap : gap_volumes(disturbed(exam, errors, random))) volume_mm3 += gap.quadric_mm3;
    const double error = std::abs(volume_mm3) / 1000.0 - exam.truth_ml;
    squares += error * error;
  }
  return std::sqrt(squares / kOracleSamples);
}

}  // namespace

std::vector<IntervalStudyRow> interval_study(const IntervalStudyOptions& options, const Progress& progress) {
  Random random(options.seed);
  std::vector<std::vector<Exam>> exams;
  std::vector<IntervalStudyRow> rows;
  for (const PlanimetryRow& row : published_planimetry_rows()) {
    rows.push_back({row.object, row.pattern, 0, 0, 0.0, 0.0});
    exams.emplace_back();
    for (int frames = kFewest; frames <= kMost; ++frames) exams.back().push_back(true_exam(row, frames));
  }
  for (int done = 0; done < options.exams;) {
    report(progress, static_cast<double>(done) / options.exams);
    const auto choice = static_cast<std::size_t>(random.uniform() * static_cast<double>(rows.size()));
    const auto frames = static_cast<std::size_t>(random.uniform() * (kMost - kFewest + 1));
    const Exam& exam = exams[choice][frames];
    MeasurementErrors errors;
    errors.tracker_mm = kMostNoise_mm * random.uniform();
    errors.tracker_deg = kTurnOfNoise * errors.tracker_mm;
    errors.outline_mm = kMostNoise_mm * random.uniform();
    const std::vector<CrossSection> sections = disturbed(exam, errors, random);
    MeasurementErrors known = errors;
    if (!options.outline_known) known.outline_mm.reset();
    const auto interval = volume_interval(sections, exam.places, known);
    if (!interval) continue;  // noise has turned an end plane away: the program refuses, and another exam is drawn
    ++done;
    IntervalStudyRow& row = rows[choice];
    ++row.exams;
    if (interval->low_ml <= exam.truth_ml && exam.truth_ml <= interval->high_ml) ++row.covered;
    const double percent = 100.0 / exam.truth_ml;
    row.width_percent += percent * (interval->high_ml - interval->low_ml);
    row.oracle_width_percent += percent * 2.0 * k95 * rms_error_ml(exam, errors, random);
  }
  for (IntervalStudyRow& row : rows) {
    row.width_percent /= std::max(row.exams, 1);
    row.oracle_width_percent /= std::max(row.exams, 1);
  }
  report(progress, 1.0);
  return rows;
}

IntervalStudyRow pooled(const std::vector<IntervalStudyRow>& rows) {
  IntervalStudyRow all{"all", "", 0, 0, 0.0, 0.0};
  for (const IntervalStudyRow& row : rows) {
    all.exams += row.exams;
    all.covered += row.covered;
    all.width_percent += row.exams * row.width_percent;
    all.oracle_width_percent += row.exams * row.oracle_width_percent;
  }
  all.width_percent /= std::max(all.exams, 1);
  all.oracle_width_percent /= std::max(all.exams, 1);
  return all;
}

std::string interval_study_text(const std::vector<IntervalStudyRow>& rows) {
  std::string text =
      "| object | pattern | exams | covered, % | width, % of the volume | an oracle's | ratio |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  std::vector<IntervalStudyRow> lines = rows;
  lines.push_back(pooled(rows));
  for (const IntervalStudyRow& row : lines) {
    char line[200];
    std::snprintf(line, sizeof line, "| %s | %s | %d | %.1f | %.2f | %.2f | %.2f |\n", row.object.c_str(),
                  row.pattern.c_str(), row.exams, 100.0 * row.covered / std::max(row.exams, 1), row.width_percent,
                  row.oracle_width_percent, row.width_percent / row.oracle_width_percent);
    text += line;
  }
  return text;
}

}  // namespace fathom
