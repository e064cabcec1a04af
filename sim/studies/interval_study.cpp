#include "sim/studies/interval_study.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/random.h"
#include "measurement/planimetry.h"
#include "measurement/volume_interval.h"
#include "sim/simulated_tracker.h"
#include "sim/studies/planimetry_study.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kFewest = 5;
constexpr int kMost = 20;
constexpr double kMostNoise_mm = 0.3;
constexpr int kOracleSamples = 200;
constexpr double k95 = 1.96;

// An exam without errors: sections of true outlines, and what errors act on.
struct Exam {
  std::vector<CrossSection> sections;
  std::vector<SectionPlace> places;
  double truth_ml = 0.0;
};

Exam true_exam(const IntervalCase& of) {
  SimulateOptions options;
  options.object = of.object;
  options.pattern = of.pattern;
  options.frames = of.sections;
  const SimulatedScan scan = simulate(options);
  const FrameLocator locator(*scan.recording, scan.calibration);
  const Structure& outlines = scan.outlines.front();
  Exam exam;
  exam.sections = cross_sections(outlines, locator, nullptr);
  exam.places = section_places(outlines, exam.sections, locator, scan.calibration);
  exam.truth_ml = scan.truth.volume_ml;
  return exam;
}

// The same sections as a tracker with noise and an outliner with scatter would have made them.
std::vector<CrossSection> disturbed(const Exam& exam, const MeasurementErrors& errors, Random& random) {
  std::vector<CrossSection> sections = exam.sections;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    CrossSection& section = sections[i];
    const Eigen::Vector3d turn =
        gaussian_vector(random, errors.tracker_deg * std::numbers::pi / 180.0 / std::sqrt(3.0));
    const Eigen::Vector3d shift = gaussian_vector(random, errors.tracker_mm / std::sqrt(3.0));
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

// Draws an exam and adds it; false where noise has turned an end plane away.
bool add_exam(const Exam& exam, Random& random, IntervalCounts& counts) {
  MeasurementErrors errors;
  errors.tracker_mm = kMostNoise_mm * random.uniform();
  errors.tracker_deg = kTurnOfNoise_deg_per_mm * errors.tracker_mm;
  errors.outline_mm = kMostNoise_mm * random.uniform();
  const std::vector<CrossSection> sections = disturbed(exam, errors, random);
  MeasurementErrors judged = errors;
  judged.outline_mm.reset();
  const auto given = volume_interval(sections, exam.places, errors);
  const auto told = volume_interval(sections, exam.places, judged);
  if (!given || !told) return false;
  const auto holds = [&](const VolumeInterval& interval) {
    return interval.low_ml <= exam.truth_ml && exam.truth_ml <= interval.high_ml ? 1 : 0;
  };
  const double percent = 100.0 / exam.truth_ml;
  counts += {.exams = 1,
             .redrawn = 0,
             .covered = holds(*given),
             .width_percent = percent * (given->high_ml - given->low_ml),
             .judged_covered = holds(*told),
             .judged_width_percent = percent * (told->high_ml - told->low_ml),
             .oracle_width_percent = percent * 2.0 * k95 * rms_error_ml(exam, errors, random)};
  return true;
}

struct Count {
  const char* name;
  int IntervalCounts::*value;
};
struct Sum {
  const char* name;
  double IntervalCounts::*value;
};
constexpr Count kCounts[] = {{"exams", &IntervalCounts::exams},
                             {"redrawn", &IntervalCounts::redrawn},
                             {"covered", &IntervalCounts::covered},
                             {"judged_covered", &IntervalCounts::judged_covered}};
constexpr Sum kSums[] = {{"width_percent", &IntervalCounts::width_percent},
                         {"judged_width_percent", &IntervalCounts::judged_width_percent},
                         {"oracle_width_percent", &IntervalCounts::oracle_width_percent}};

Json json_of(const IntervalCounts& counts) {
  Json json;
  for (const Count& count : kCounts) json[count.name] = counts.*count.value;
  for (const Sum& sum : kSums) json[sum.name] = counts.*sum.value;
  return json;
}

std::vector<IntervalCounts> counts_of(const std::vector<Json>& results) {
  std::vector<IntervalCounts> all;
  for (const Json& json : results) {
    IntervalCounts& counts = all.emplace_back();
    for (const Count& count : kCounts) counts.*count.value = json.at(count.name).get<int>();
    for (const Sum& sum : kSums) counts.*sum.value = json.at(sum.name).get<double>();
  }
  return all;
}

class IntervalStudy final : public Study {
 public:
  std::string name() const override { return "interval"; }
  std::string title() const override { return "how often 95 % intervals hold the true volume"; }
  int cases(const StudyOptions&) const override { return static_cast<int>(interval_cases().size()); }

  std::string case_name(const StudyOptions&, int index) const override {
    const IntervalCase of = interval_cases().at(static_cast<std::size_t>(index));
    return of.object + " " + of.pattern + ", " + std::to_string(of.sections) + " sections";
  }

  Json run_case(const StudyOptions& options, int index) const override {
    const IntervalCase of = interval_cases().at(static_cast<std::size_t>(index));
    return json_of(measure_intervals(of, options.samples, case_seed(options, index)));
  }

  Json rows(const StudyOptions&, const std::vector<Json>& results) const override {
    Json json = Json::array();
    const std::vector<IntervalCase> cases = interval_cases();
    for (std::size_t i = 0; i < cases.size(); ++i) {
      Json row = {{"object", cases[i].object}, {"pattern", cases[i].pattern}, {"sections", cases[i].sections}};
      row.update(results.at(i));
      json.push_back(std::move(row));
    }
    return json;
  }

  StudyReport report(const StudyOptions&, const std::vector<Json>& results) const override {
    return interval_report(counts_of(results));
  }
};

}  // namespace

const Study& interval_study() {
  static const IntervalStudy study;
  return study;
}

std::vector<IntervalCase> interval_cases() {
  std::vector<IntervalCase> cases;
  for (const PlanimetryRow& row : published_planimetry_rows()) {
    for (int frames = kFewest; frames <= kMost; ++frames) cases.push_back({row.object, row.pattern, frames});
  }
  return cases;
}

IntervalCounts& IntervalCounts::operator+=(const IntervalCounts& other) {
  for (const Count& count : kCounts) this->*count.value += other.*count.value;
  for (const Sum& sum : kSums) this->*sum.value += other.*sum.value;
  return *this;
}

IntervalCounts measure_intervals(const IntervalCase& of, int exams, std::uint64_t seed) {
  constexpr int kMostRedrawn = 1000;  // far more than ever: the exams of such a scan would all be refused
  Random random(seed);
  const Exam exam = true_exam(of);
  IntervalCounts counts;
  while (counts.exams < exams) {
    if (!add_exam(exam, random, counts) && ++counts.redrawn > kMostRedrawn) {
      throw Error("intervals of " + of.object + " " + of.pattern + ": noise leaves no volume to measure");
    }
  }
  return counts;
}

}  // namespace fathom
