#include "viewer/assist_tool.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "segmentation/outline_mask.h"

namespace fathom {

namespace {

struct ToolWords {
  Tool tool;
  const char* action;  // in the history
  const char* about;   // of messages
};
constexpr std::array<ToolWords, 3> kWords{{{Tool::kRegion, "Fill region", "region"},
                                           {Tool::kThreshold, "Outline by threshold", "threshold"},
                                           {Tool::kRefine, "Refine outline", "refine"}}};

const ToolWords& words_of(Tool tool) {
  return *std::find_if(kWords.begin(), kWords.end(), [&](const ToolWords& words) { return words.tool == tool; });
}

bool is_moved(const Session& session, const Contour& contour) {
  return contour.closed && contour.frame == session.view.frame && contour.recording == session.view.recording;
}

// Closed ones on the shown frame: of the active structure, or of all others.
std::vector<Polygon> outlines_here(const Session& session, bool of_active) {
  std::vector<Polygon> outlines;
  const auto active = session.active_structure();
  const std::vector<Structure>& structures = session.document()->structures();
  for (std::size_t i = 0; i < structures.size(); ++i) {
    if ((i == active) != of_active) continue;
    for (const Contour& contour : structures[i].contours) {
      if (is_moved(session, contour)) outlines.push_back(contour.points_px);
    }
  }
  return outlines;
}

// Whether the outline encloses pixels that the proposed ones, by even-odd, enclose too.
bool shares_area(const Polygon& outline, const std::vector<Polygon>& proposed) {
  Eigen::AlignedBox2d box;
  for (const Polygon& line : proposed) {
    for (const Eigen::Vector2d& point : line) box.extend(point);
  }
  const Eigen::Vector2i low = box.min().array().floor().cast<int>();
  const Eigen::Vector2i high = box.max().array().ceil().cast<int>();
  const cv::Rect window(cv::Point(low.x(), low.y()), cv::Point(high.x() + 1, high.y() + 1));
  const cv::Mat both = outline_mask(proposed, window) & outline_mask(std::span(&outline, 1), window);
  return cv::countNonZero(both) > 0;
}

bool is_on(const cv::Mat& image, const Eigen::Vector2d& at_px) {
  return at_px.x() >= -0.5 && at_px.y() >= -0.5 && at_px.x() <= image.cols - 0.5 && at_px.y() <= image.rows - 0.5;
}

// A limit at the end of its slider is none: other frames may have darker and brighter places than the first one shown.
AssistOptions without_limits_at_ends(const ViewState& view, AssistOptions options) {
  if (options.low <= view.grey_low) options.low = std::numeric_limits<float>::lowest();
  if (options.high >= view.grey_high) options.high = std::numeric_limits<float>::infinity();
  return options;
}

}  // namespace

bool AssistTool::Place::operator==(const Place& other) const {
  return scan.lock() == other.scan.lock() && recording == other.recording && frame == other.frame &&
         tool == other.tool && structure == other.structure;
}

AssistTool::Place AssistTool::place_of(const Session& session) {
  const auto active = session.active_structure();
  const ViewState& view = session.view;
  const bool moves = view.tool == Tool::kRefine && active;
  const std::uint64_t structure = moves ? session.document()->content().ids[*active] : 0;
  return {session.document()->scan(), view.recording, view.frame, view.tool, structure};
}

AssistTool::Question AssistTool::question_of(const Session& session) {
  const Document& document = *session.document();
  std::uint64_t revision = 0;
  const std::size_t count = session.view.tool == Tool::kRefine ? document.structures().size() : 0;
  for (std::size_t i = 0; i < count; ++i) revision += document.structure_revision(i);
  return {session.view.seeds_px, session.view.assist, revision};
}

void AssistTool::forget(Session& session) {
  session.worker().cancel("preview");
  ++number_;
  asked_any_ = answered_ = finish_when_answered_ = false;
  session.view.preview_px.clear();
}

void AssistTool::move_to(Session& session, Place place) {
  forget(session);
  session.view.seeds_px.clear();
  place_ = std::move(place);
  dropped_ = false;
}

void AssistTool::handle(Session& session, const ToolInput& input, const cv::Mat& image) {
  if (Place place = place_of(session); !(place == place_)) move_to(session, std::move(place));
  if (input.pressed && place_.tool != Tool::kRefine && is_on(image, input.at_px)) {
    session.view.seeds_px.push_back(input.at_px);
  }
  Question question = question_of(session);
  if (dropped_) {
    // What was taken or dropped is not offered again; Refine's own result is no reason either.
    if (question.seeds_px == asked_.seeds_px && question.options == asked_.options) return;
    dropped_ = false;
  }
  if (input.pressed && is_lost(session)) asked_any_ = finish_when_answered_ = false;
  const bool finishes = finish_when_answered_ && !asked_any_ && question == asked_;
  if (!asked_any_ || question != asked_) ask(session, std::move(question), image, finishes);
}

bool AssistTool::is_lost(const Session& session) const {
  return asked_any_ && !answered_ && !session.is_under_way("preview");
}

void AssistTool::ask(Session& session, Question question, const cv::Mat& image, bool finishes) {
  forget(session);
  asked_any_ = true;
  finish_when_answered_ = finishes;
  asked_ = std::move(question);
  AssistInput input{place_.tool,
                    image.clone(),
                    without_limits_at_ends(session.view, asked_.options),
                    asked_.seeds_px,
                    outlines_here(session, true),
                    outlines_here(session, false)};
  const auto work = [this, &session, number = number_,
                     input = std::move(input)](const Progress&) -> std::function<void()> {
    std::vector<Polygon> outlines = assist_preview(input);
    return [this, &session, number, outlines = std::move(outlines)] { answer(session, number, outlines); };
  };
  const auto failed = [this, &session, number = number_,
                       about = words_of(place_.tool).about](const std::string& error) {
    if (number != number_) return;
    session.say(about, error);
    answer(session, number, {});
  };
  session.worker().start({"preview", "Looking for outlines", work, failed});
}

void AssistTool::answer(Session& session, std::uint64_t number, std::vector<Polygon> outlines) {
  if (number != number_ || session.document() == nullptr || !(place_of(session) == place_)) return;
  session.view.preview_px = std::move(outlines);
  answered_ = true;
  if (std::exchange(finish_when_answered_, false)) finish(session);
}

bool AssistTool::undo(Session& session) {
  if (session.view.seeds_px.empty()) return false;
  session.view.seeds_px.pop_back();
  return true;
}

void AssistTool::finish(Session& session) {
  if (!asked_any_ || !(place_of(session) == place_) || question_of(session) != asked_) return;
  if (!answered_) {
    finish_when_answered_ = true;
    if (!is_lost(session)) return;
    asked_any_ = false;  // looks again
    ++number_;
    return;
  }
  const std::vector<Polygon> outlines = std::exchange(session.view.preview_px, {});
  if (outlines.empty()) return;
  const ToolWords& words = words_of(place_.tool);
  const bool is_taken = session.attempt(words.about, [&] {
    Document& document = *session.document();
    document.begin_action(words.action);
    const std::size_t structure = session.require_structure();
    // Outlines combine by even-odd: over an older one the new one would make a ring of both.
    for (std::size_t i = document.structures()[structure].contours.size(); i-- > 0;) {
      const Contour& old = document.structures()[structure].contours[i];
      if (!is_moved(session, old)) continue;
      if (place_.tool == Tool::kRefine || shares_area(old.points_px, outlines)) document.remove_contour(structure, i);
    }
    for (const Polygon& outline : outlines) {
      Contour contour;
      contour.frame = place_.frame;
      contour.recording = place_.recording;
      contour.points_px = outline;
      document.add_contour(structure, std::move(contour));
    }
    document.end_action();
  });
  if (is_taken) give_up(session);
}

void AssistTool::give_up(Session& session) {
  if (session.document() == nullptr) return;
  forget(session);
  session.view.seeds_px.clear();
  asked_ = question_of(session);
  dropped_ = true;
}

}  // namespace fathom
