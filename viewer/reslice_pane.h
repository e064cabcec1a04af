#pragma once

#include <array>
#include <cstdint>

#include <imgui.h>

#include "viewer/gl_objects.h"
#include "viewer/reslice_views.h"
#include "viewer/session.h"

namespace fathom {

/// Two planes through the recording, each with the line in which it is cut by the other and by the shown frame. The
/// line moves the other plane, its ends turn it.
class ReslicePane {
 public:
  void draw(Session& session);
  const ResliceViews& views() const { return views_; }

 private:
  struct Place {
    ImVec2 middle;
    double scale = 1.0;  ///< window's pixels a millimetre

    ImVec2 at(const Eigen::Vector2d& mm) const {
      return {middle.x + static_cast<float>(scale * mm.x()), middle.y + static_cast<float>(scale * mm.y())};
    }
  };
  void draw_view(Session& session, std::size_t index, ImVec2 low, ImVec2 size);
  void draw_handles(std::size_t index, const Place& place, ImDrawList& list);

  ResliceViews views_;
  std::array<Texture, ResliceViews::kCount> textures_;
  std::array<std::uint64_t, ResliceViews::kCount> uploaded_{};
};

}  // namespace fathom
