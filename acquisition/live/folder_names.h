#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/live/tracked_frame.h"

namespace fathom {

// What devices call things, made fit for the header of a recording, which must be read back whatever they send.

inline constexpr const char* kSweepField = "Sweep";  ///< of a frame: which sweep of the recording it belongs to, from 0
inline constexpr const char* kGeometryFaultField = "GeometryFault";  ///< why frames have no place any more
inline constexpr const char* kReservedSpace = ".sweep.reserve";

/// The sweep that a frame of a recording belongs to, as stored; empty where the recorder was not told.
std::string_view sweep_of(const FrameHeader& frame);

/// A status without blanks around it; one that is not that of a valid pose or image never becomes so.
std::string plain_status(const std::string& status);

/// A pose as it may be stored: finite, and where valid rigid, or else marked invalid.
Pose storable(const NamedPose& pose);

/// The fields that a header can hold: plain names that mean nothing else there, each once, in lines
/// below 1000 characters, as PLUS reads them.
std::vector<std::pair<std::string, std::string>> usable_fields(
    const std::vector<std::pair<std::string, std::string>>& fields);

/// The names of transforms as stored, in the order in which they came.
class UsableTransforms {
 public:
  void add(const std::string& device_name);
  /// Of a name that was added; empty where it cannot be stored, as another has its name.
  std::optional<std::size_t> index(const std::string& device_name) const;
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::map<std::string, std::optional<std::size_t>> indices_;  ///< by the device's name
};

}  // namespace fathom
