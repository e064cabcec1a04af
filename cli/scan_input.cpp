#include "cli/scan_input.h"

#include <utility>

#include "core/error.h"
#include "exam/scan_division.h"

namespace fathom {

namespace {

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
  command.add_option("RECORDING", recording, "A .mha, .mhd or .nrrd sequence, a recording folder, or an exam")
      ->required();
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
  return division_of(std::move(file), scan, structures);
}

void require_exam_to_save(const std::optional<Exam>& exam) {
  if (!exam) throw CLI::ValidationError("--save", "RECORDING is no exam to save to; `fathom exam create` makes one");
}

}  // namespace fathom
