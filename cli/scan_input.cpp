#include "cli/scan_input.h"

#include <algorithm>
#include <set>

#include "core/error.h"

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

std::string chosen_file(const std::string& typed, const std::optional<Exam>& exam, std::string Exam::*member,
                        const std::string& option, const std::string& what) {
  if (!typed.empty()) return typed;
  if (!exam) throw CLI::RequiredError(option);
  if (((*exam).*member).empty()) {
    throw Error(exam_json(*exam).string() + ": names no " + what + "; give it by " + option +
                ", or put it in by `fathom exam update`");
  }
  return file_of(*exam, (*exam).*member).string();
}

}  // namespace

void add_recording(CLI::App& command, std::string& recording) {
  command.add_option("RECORDING", recording, "A .mha, .mhd or .nrrd sequence, a recording folder, or an exam")->required();
}

void add_calibration(CLI::App& command, ScanInput& input) {
  command.add_option("--calibration", input.calibration, "Fathom's JSON, or a PLUS XML (default: the exam's)");
}

void add_contours(CLI::App& command, ScanInput& input) {
  command.add_option("--contours", input.contours, "The contours file (default: the exam's)");
}

std::optional<Exam> read_if_exam(const std::string& recording) {
  return is_exam(recording) ? std::optional(read_exam(recording)) : std::nullopt;
}

std::unique_ptr<Recording> open_only_recording(const std::string& recording, const std::string& command) {
  const auto exam = read_if_exam(recording);
  if (!exam) return open_recording(recording);
  if (exam->recordings.size() > 1) {
    throw Error(exam_json(*exam).string() + ": has " + std::to_string(exam->recordings.size()) +
                " recordings, and `fathom " + command + "` works on one; name its file, such as " +
                (exam->folder / exam->recordings.front()).string());
  }
  return open_recording(file_of(*exam, exam->recordings.front()));
}

std::string calibration_file(const ScanInput& input, const std::optional<Exam>& exam) {
  return chosen_file(input.calibration, exam, &Exam::calibration, "--calibration", "calibration");
}

std::string contours_file(const ScanInput& input, const std::optional<Exam>& exam) {
  return chosen_file(input.contours, exam, &Exam::structures, "--contours", "contours");
}

Scan open_scan(const ScanInput& input, const std::optional<Exam>& exam) {
  const Calibration calibration = read_calibration(calibration_file(input, exam), input.names.probe);
  return exam ? open_scan(*exam, calibration, input.names) : open_scan(input.recording, calibration, input.names);
}

PlanesFile asked_planes(const ScanInput& input, const std::optional<Exam>& exam) {
  PlanesFile planes;
  if (exam) planes = {exam->sweeps, exam->dividing_planes};
  if (input.planes.empty()) return planes;
  PlanesFile typed = read_planes(input.planes);
  if (!typed.sweeps.empty()) planes.sweeps = std::move(typed.sweeps);
  planes.planes = std::move(typed.planes);
  return planes;
}

std::optional<Division> division_of(const ScanInput& input, const std::optional<Exam>& exam, const Scan& scan,
                                    const std::vector<Structure>& structures) {
  PlanesFile file = asked_planes(input, exam);
  if (!input.planes.empty()) require_sweeps(file.sweeps, scan, input.planes);
  const bool stated = !file.sweeps.empty() || !file.planes.empty() || scan.recordings.size() > 1;
  if (file.sweeps.empty() && stated) file.sweeps = find_sweeps(scan);
  if (!stated) {
    file.sweeps = find_sweeps(*scan.recordings.front(), scan.locators.front());
    if (file.sweeps.size() < 2 || !are_several(structures, scan, file.sweeps)) return std::nullopt;
  }
  // Without planes nobody asks where the sweeps lie, which needs images.
  SpacePartition partition;
  if (!file.planes.empty()) partition = SpacePartition(sweep_shapes(file.sweeps, scan), std::move(file.planes));
  return Division{std::move(file.sweeps), std::move(partition)};
}

void require_exam_to_save(const std::optional<Exam>& exam) {
  if (!exam) throw CLI::ValidationError("--save", "RECORDING is no exam to save to; `fathom exam create` makes one");
}

}  // namespace fathom
