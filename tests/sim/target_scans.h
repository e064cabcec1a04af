#pragma once

#include <map>
#include <string>
#include <utility>

#include "sim/studies/seen_target.h"

namespace fathom {

/// True places by frame and name.
using TruePlaces = std::map<std::pair<int, std::string>, Eigen::Vector2d>;
inline TruePlaces places_of(const SimulatedTargetScan& scan) {
  TruePlaces places;
  for (const TruePoint& point : scan.points) places[{point.frame, point.name}] = point.position_px;
  return places;
}

}  // namespace fathom
