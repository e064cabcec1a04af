#pragma once

#include <memory>
#include <string>
#include <vector>

#include "acquisition/live/live_source.h"

namespace fathom {

/// A transform and its value for one frame.
struct NamedPose {
  std::string transform;  ///< as RecordingHeader::transforms: "ProbeToTracker"
  Pose pose;
};

/// A B-scan with the poses at its own time stamp, no latency applied.
struct TrackedFrame {
  LiveFrame frame;
  /// One for each transform that the tracker has ever reported, in the order in which they first came. Where the pose
  /// is not known the status says why and the matrix is the identity.
  std::vector<NamedPose> poses;
  /// Whether every pose that tells where the probe was is valid: see SessionOptions::required_transforms.
  bool tracked = false;

  /// Whether both the picture and its place can be used.
  bool valid() const { return tracked && (frame.status.empty() || frame.status == "OK"); }
};

/// Shared by everybody who listens; nobody changes it, so nobody copies it.
using SharedFrame = std::shared_ptr<const TrackedFrame>;

}  // namespace fathom
