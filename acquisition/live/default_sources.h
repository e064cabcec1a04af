#pragma once

#include "acquisition/live/source_registry.h"

namespace fathom {

/// All kinds of sources that the acquisition knows; sim/ adds its own (add_simulated_sources).
SourceRegistry default_sources();

}  // namespace fathom
