#pragma once

#include <array>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sim/studies/study.h"
#include "surface/layer_mesher.h"

namespace fathom {

/// A way to mesh, with its name in results and for readers.
struct MeshMethod {
  const char* name;
  const char* label;
  Mesher mesher;
  VertexPlacement placement;

  MesherOptions options() const {
    MesherOptions options;
    options.mesher = mesher;
    options.placement = placement;
    return options;
  }
};

inline constexpr std::array<MeshMethod, 4> kMeshMethods = {
    {{"mc", "MC", Mesher::kCubes, VertexPlacement::kAverage},
     {"mt", "MT", Mesher::kTetrahedra, VertexPlacement::kAverage},
     {"rmt", "RMT", Mesher::kRegularised, VertexPlacement::kAverage},
     {"rmt_curvature", "RMT, by curvature", Mesher::kRegularised, VertexPlacement::kCurvature}}};

/// `results` are those of study 3: as many in turn, in the order of kMeshMethods, of every object and lattice, then of
/// every way to shade.
StudyReport mesher_report(const std::vector<nlohmann::ordered_json>& results);

}  // namespace fathom
