#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/recording.h"
#include "exam/exam.h"
#include "registration/find_sweeps.h"
#include "registration/frame_locator.h"
#include "registration/partition.h"
#include "registration/sweep.h"
#include "segmentation/contours.h"

namespace fathom {

/// Recordings of one examination, opened and placed in one space.
struct Scan {
  std::string name;  ///< of the recording, or of exam.json, for messages
  std::vector<std::unique_ptr<Recording>> recordings;
  std::vector<FrameLocator> locators;  ///< one for each recording
  Calibration calibration;             ///< the locators'; the identity where there is none
  FrameNames names;                    ///< the locators'
};

/// One recording; its calibration may be the identity where only the probe's way matters.
Scan open_scan(const std::filesystem::path& recording, const Calibration& calibration, const FrameNames& names);

/// All recordings of an exam. Throws Error as file_of and open_recording; when they are placed in different reference
/// coordinates, so that they have no space in common; when a sweep of the exam has frames that its recording lacks.
Scan open_scan(const Exam& exam, const Calibration& calibration, const FrameNames& names);

/// The sweeps of all recordings, in order.
std::vector<Sweep> find_sweeps(const Scan& scan, const FindSweepsOptions& options = {});

/// Throws Error, naming `file`, when a sweep is of a recording or frame that the scan does not have.
void require_sweeps(std::span<const Sweep> sweeps, const Scan& scan, const std::string& file);

/// Where each sweep lies. Throws Error as sweep_shape, and for a recording without images.
std::vector<SweepShape> sweep_shapes(std::span<const Sweep> sweeps, const Scan& scan);

/// Number of frames of each recording.
std::vector<int> frame_counts(const Scan& scan);

}  // namespace fathom
