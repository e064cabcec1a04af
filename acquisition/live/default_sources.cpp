#include "acquisition/live/default_sources.h"

#include "acquisition/live/igtl_source.h"
#include "acquisition/live/polhemus_source.h"
#include "acquisition/live/replay_source.h"
#include "acquisition/live/video_source.h"

namespace fathom {

SourceRegistry default_sources() {
  SourceRegistry registry;
  add_igtl_sources(registry);
  add_polhemus_sources(registry);
  add_replay_sources(registry);
  add_video_sources(registry);
  return registry;
}

}  // namespace fathom
