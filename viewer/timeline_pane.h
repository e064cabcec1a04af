#pragma once

#include "viewer/session.h"

namespace fathom {

/// Frames from first to last: sweeps, frames without image or pose, outlined frames of every structure; a drag shows
/// frames.
void draw_timeline(Session& session);

}  // namespace fathom
