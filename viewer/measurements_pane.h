#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "measurement/ellipsoid_volume.h"
#include "viewer/session.h"

namespace fathom {

/// What was measured of every structure, what keeps it from being measured, and areas along the sweep; structures are
/// named, coloured, added and removed here.
class MeasurementsPane {
 public:
  void draw(Session& session);

 private:
  void draw_structure(Session& session, std::size_t index);
  void draw_style(Session& session, std::size_t index);
  void draw_opacity(Session& session, std::size_t index);
  void draw_volumes(Session& session, std::size_t index);
  void draw_confidence(Session& session, const StructureView& view, bool active);
  void draw_graph(Session& session, std::size_t index);
  void draw_planes(Session& session);
  void draw_texts(Session& session);
  void update_ellipsoid(const Session& session, std::size_t index);

  std::uint64_t named_ = 0;  // id of the structure whose name is being typed
  std::string name_;
  int text_edited_ = -1;
  std::string text_;
  struct Ellipsoid {
    std::uint64_t revision = 0;
    std::optional<EllipsoidVolume> volume;
  };
  std::map<std::uint64_t, Ellipsoid> ellipsoids_;
};

}  // namespace fathom
