#pragma once

#include <string>
#include <string_view>

#include "acquisition/recording.h"

namespace fathom {

// What every tracker's driver does with what its device says.

/// A pose as TrackerSample wants it: one that is stated to be valid, but is not finite or not rigid to 1e-3, gets the
/// status NOT_FINITE or NOT_RIGID. Numbers that are not finite, which no recording can hold, become the identity.
Pose tracker_pose(const Eigen::Matrix4d& matrix, std::string status);

/// The name of a transform in a recording for what a device calls it: "ProbeToTracker" as it is, without a suffix
/// "Transform"; a tool's bare name, "Probe", gets "ToTracker". What is neither letter nor digit becomes '_'. Empty
/// where nothing is left.
std::string transform_name(std::string_view device);

}  // namespace fathom
