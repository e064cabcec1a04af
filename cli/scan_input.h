#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "acquisition/recording.h"
#include "exam/exam.h"
#include "exam/results.h"
#include "exam/scan.h"
#include "registration/dividing_planes.h"
#include "registration/pose_chain.h"

namespace fathom {

/// RECORDING and what belongs to it, as typed.
struct ScanInput {
  std::string recording;
  std::string calibration;
  std::string contours;
  std::string planes;
  FrameNames names;
};

/// Adds RECORDING: a recording or an exam.
void add_recording(CLI::App& command, std::string& recording);
/// Adds `--calibration`, which an exam makes unnecessary.
void add_calibration(CLI::App& command, ScanInput& input);
/// Adds `--contours`, which an exam makes unnecessary.
void add_contours(CLI::App& command, ScanInput& input);

/// The exam that RECORDING is, if it is one.
std::optional<Exam> read_if_exam(const std::string& recording);

/// The one recording that `command` works on. Throws Error for an exam of several, with how to name one of them.
std::unique_ptr<Recording> open_only_recording(const std::string& recording, const std::string& command);

/// Files as typed, else the exam's. Throw CLI::RequiredError where there is no exam, Error where the exam has none.
std::string calibration_file(const ScanInput& input, const std::optional<Exam>& exam);
std::string contours_file(const ScanInput& input, const std::optional<Exam>& exam);

/// All recordings, placed by the calibration.
Scan open_scan(const ScanInput& input, const std::optional<Exam>& exam);

/// The sweeps and planes that are asked for: those of `--planes`, where it names them, else the exam's. Empty where
/// there are none. Throws Error as read_planes.
PlanesFile asked_planes(const ScanInput& input, const std::optional<Exam>& exam);

/// The sweeps and planes to measure with: those of `--planes`, else of the exam, else the sweeps that are found where
/// the scan cannot be taken as one. Empty where it can.
std::optional<Division> division_of(const ScanInput& input, const std::optional<Exam>& exam, const Scan& scan,
                                    const std::vector<Structure>& structures);

/// Throws CLI::ValidationError where `--save` was given without an exam to save to.
void require_exam_to_save(const std::optional<Exam>& exam);

}  // namespace fathom
