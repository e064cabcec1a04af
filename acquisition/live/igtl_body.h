#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "acquisition/live/igtl_wire.h"
#include "acquisition/recording.h"

namespace fathom {

/// What the metadata of a message (header version 2) states, by key.
using IgtlMetadata = std::map<std::string, std::string>;

/// `header`: the index, `body`: keys and values. Throws Error when they do not fit together.
IgtlMetadata read_igtl_metadata(std::span<const std::byte> header, std::span<const std::byte> body);

/// A pose of a message, by the name that it has in a recording.
struct IgtlPose {
  std::string transform;
  Pose pose;  ///< as TrackerSample::pose
};

/// Whether a type of message states poses: TRANSFORM, TDATA, QTDATA, POSITION, QTRANS.
bool has_igtl_poses(const std::string& type);

/// The poses that the content of such a message states. Throws Error, saying why, when it has another size than its
/// type wants, or no name.
std::vector<IgtlPose> read_igtl_poses(const IgtlHeader& header, std::span<const std::byte> content,
                                      const IgtlMetadata& metadata);

/// What the content of a STATUS complains of, in one line; empty when it says that all is well. Throws Error when it is
/// too short.
std::string read_igtl_status(std::span<const std::byte> content);

}  // namespace fathom
