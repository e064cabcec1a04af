#pragma once

#include <filesystem>

#include "registration/sweep_verdict.h"

namespace fathom {

/// The verdict on a finished recording folder, with the probe's raw samples out of it. Throws Error as open_recording,
/// for_each_sample and judge_sweep do.
SweepVerdict judge_folder(const std::filesystem::path& folder, const Calibration* calibration, const FrameNames& names,
                          const VerdictOptions& options = {});

}  // namespace fathom
