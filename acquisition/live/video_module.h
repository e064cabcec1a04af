#pragma once

#include "acquisition/live/video_capture.h"

namespace fathom {

/// The function of the module: null, with the reason in `why`, where it cannot be opened. Does not throw.
using OpenVideo = VideoCapture*(const std::string& address, const VideoOptions& options, std::string& why);

inline constexpr const char* kOpenVideo = "fathom_open_video";

}  // namespace fathom

extern "C" fathom::OpenVideo fathom_open_video;
