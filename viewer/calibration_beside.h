#pragma once

#include <filesystem>

namespace fathom {

/// The calibration that lies beside a recording under its name: "scan.calibration.json" for "scan.mha" and
/// "scan.igs.mha", calibration.json in the folder that `fathom record` made. Empty where there is none.
std::filesystem::path find_calibration_beside(const std::filesystem::path& recording);

}  // namespace fathom
