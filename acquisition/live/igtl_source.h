#pragma once

#include "acquisition/live/source_registry.h"

namespace fathom {

/// Adds "igtl://host[:port][?image=NAME][&orientation=MF]": a client of an OpenIGTLink server (PLUS, 3D Slicer,
/// devices).
///
/// IMAGE becomes frames; where the peer sends images of several names, those of `image`, else of the first that comes.
/// Pixels are taken to be in MF orientation, as PLUS sends them, unless `orientation` says how they lie. TRANSFORM,
/// TDATA, QTDATA, POSITION and QTRANS become samples, named as transform_name() says, with the status that the
/// metadata of PLUS states. A STATUS that is not well becomes an event. Checksums are verified.
///
/// Stamps are mapped to live_clock_s() by one ClockMapping of the connection. A peer that is not there or goes away is
/// waited for; frames that must have been lost meanwhile, by the stamps and the usual frame rate, are a gap in the
/// numbers and said in an event. Messages that cannot be used are counted, and said now and then; a damaged image is a
/// gap of one frame. No message takes more memory than igtl_reader.h allows, and a peer that sends anything else than
/// OpenIGTLink, or stops in the middle of a message, is left and tried again.
void add_igtl_sources(SourceRegistry& registry);

}  // namespace fathom
