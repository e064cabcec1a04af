#pragma once

#include <cstdint>
#include <string>

#include "viewer/gl_objects.h"
#include "viewer/live_view.h"
#include "viewer/session.h"
#include "viewer/settings.h"

namespace fathom {

/// Sources, the image that comes in, and recording.
class LivePane {
 public:
  explicit LivePane(std::function<void()> wake) : live_(std::move(wake)) {}

  /// Returns true when what was recorded shall be reviewed.
  bool draw(Session& session, Settings& settings);
  LiveView& live() { return live_; }
  const LiveView& live() const { return live_; }

 private:
  void draw_sources(Session& session, Settings& settings);
  void draw_statistics();
  void draw_recorder(Session& session);
  bool draw_verdict(Session& session);
  void draw_image();

  LiveView live_;
  Texture texture_;
  SharedFrame shown_;
  std::string folder_;
  bool gated_ = false;
  bool looked_ = false;
};

}  // namespace fathom
