#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "segmentation/live_wire.h"
#include "viewer/review_tools.h"
#include "viewer/session.h"
#include "viewer/step_tool.h"

namespace fathom {

/// Outlining by clicks between which the line follows the edges of the shown frame (live-wire).
class WireTool : public StepTool {
 public:
  /// `image` is that of the shown frame. Edges are looked for beside the frame; until then clicks are passed over.
  void handle(Session& session, const ToolInput& input, const cv::Mat& image);
  /// Takes back the last click. False where there is none.
  bool undo(Session& session) override;
  /// Closes the line and puts it into the document.
  void finish(Session& session) override;
  void give_up(Session& session) override;

 private:
  // While another frame is shown and its image not yet there, the line is of the one before.
  bool is_of_shown_frame(const Session& session) const;
  void prepare(Session& session, const cv::Mat& image, bool again);
  // Whether edges were not found and are not looked for: the user cancelled that.
  bool is_lost(const Session& session) const { return !wire_ && !session.is_under_way("edges"); }
  void show(Session& session);

  std::shared_ptr<LiveWire> wire_;  // of the frame below; null while it is made
  std::weak_ptr<const Scan> scan_;
  int recording_ = -1;
  int frame_ = -1;
  std::uint64_t number_ = 0;  // grows with every frame that edges were asked for
  Eigen::Vector2d pointer_px_ = Eigen::Vector2d::Zero();
};

}  // namespace fathom
