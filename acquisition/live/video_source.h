#pragma once

#include "acquisition/live/source_registry.h"

namespace fathom {

/// Adds "video:/dev/video0", "video:clip.avi" and "video:rtsp://...", with the options width, height, rate (of devices)
/// and color=1 (RGB; else grey).
///
/// A device's frames are stamped with the driver's stamp, mapped (ClockMapping), a stream's when they arrive. A device
/// or stream that goes away is waited for; frames that must have been lost meanwhile are a gap in the numbers. A clip
/// is played in its own time and ends with kEnded. Pixels are taken to be in MF orientation. start() throws Error when
/// the device, file or stream is not there.
void add_video_sources(SourceRegistry& registry);

}  // namespace fathom
