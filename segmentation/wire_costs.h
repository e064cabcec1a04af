#pragma once

#include "segmentation/edge_map.h"
#include "segmentation/edge_preference.h"
#include "segmentation/wire_search.h"

namespace fathom {

/// What the steps of a live-wire cost on an image: little along edges that fit the preference, in their direction and
/// on their ridge. Those of two neighbours are judged between them, so that there is one price for both ways, save
/// that the bright side changes.
WireCosts wire_costs(const EdgeMap& map, const EdgePreference& preference);

}  // namespace fathom
