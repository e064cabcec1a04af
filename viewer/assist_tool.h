#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "viewer/assist_preview.h"
#include "viewer/review_tools.h"
#include "viewer/session.h"
#include "viewer/step_tool.h"

namespace fathom {

/// Region, Threshold and Refine on the shown frame: outlines found in the image are shown while seeds and settings
/// change, and become part of the exam on request. They are looked for beside the frame.
class AssistTool : public StepTool {
 public:
  /// Offers anew what was dropped or taken on this frame.
  void begin(Session& session) { move_to(session, {}); }
  /// `image` is that of the shown frame.
  void handle(Session& session, const ToolInput& input, const cv::Mat& image);
  /// Takes back the last seed.
  bool undo(Session& session) override;
  /// Takes what is shown, or what is being looked for as soon as it is there.
  void finish(Session& session) override;
  /// Shows nothing on this frame until a seed or a setting changes.
  void give_up(Session& session) override;

 private:
  // What a preview is of.
  struct Place {
    std::weak_ptr<const Scan> scan;
    int recording = -1;
    int frame = -1;
    Tool tool = Tool::kBrowse;
    std::uint64_t structure = 0;  // that Refine moves, by its id; 0: none
    bool operator==(const Place& other) const;
  };
  struct Question {
    std::vector<Eigen::Vector2d> seeds_px;
    AssistOptions options;
    std::uint64_t revision = 0;  // of the outlines that Refine moves, and those beside them
    bool operator==(const Question&) const = default;
  };

  static Place place_of(const Session& session);
  static Question question_of(const Session& session);
  void move_to(Session& session, Place place);
  void ask(Session& session, Question question, const cv::Mat& image, bool finishes);
  // Whether no answer will come, as the user cancelled the search.
  bool is_lost(const Session& session) const;
  void answer(Session& session, std::uint64_t number, std::vector<Polygon> outlines);
  void forget(Session& session);

  Place place_;
  Question asked_;
  std::uint64_t number_ = 0;  // of the question; grows also where its answer is not wanted any more
  bool asked_any_ = false;
  bool answered_ = false;
  bool finish_when_answered_ = false;
  bool dropped_ = false;  // until seeds or settings change
};

}  // namespace fathom
