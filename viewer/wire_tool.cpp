#include "viewer/wire_tool.h"

#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/error.h"

namespace fathom {

namespace {

// Parts of the mouse's reach. A hand points about as well as kSnap says: clicks are moved no farther, so that who
// clicks with care is not led astray by an edge nearby.
constexpr double kSnap = 0.4;
constexpr double kOnLine = 0.5;

}  // namespace

bool WireTool::is_of_shown_frame(const Session& session) const {
  const Document* document = session.document();
  return document != nullptr && scan_.lock() == document->scan() && recording_ == session.view.recording &&
         frame_ == session.view.frame;
}

void WireTool::prepare(Session& session, const cv::Mat& image, bool again) {
  const ViewState& view = session.view;
  if (is_of_shown_frame(session) && !(again && is_lost(session))) return;
  scan_ = session.document()->scan();
  recording_ = view.recording;
  frame_ = view.frame;
  wire_ = nullptr;
  const std::uint64_t number = ++number_;
  const auto work = [this, number, copy = image.clone()](const Progress&) -> std::function<void()> {
    cv::Mat grey = copy;
    if (copy.channels() == 3) cv::cvtColor(copy, grey, cv::COLOR_RGB2GRAY);
    auto wire = std::make_shared<LiveWire>(grey);
    return [this, number, wire] {
      if (number == number_) wire_ = wire;
    };
  };
  session.worker().start(
      {"edges", "Looking for edges", work, [&session](const std::string& error) { session.say("wire", error); }});
}

void WireTool::show(Session& session) {
  Polygon line = wire_->line();
  for (const Eigen::Vector2d& point : wire_->wire_to(pointer_px_)) line.push_back(point);
  session.view.line_px = std::move(line);
}

void WireTool::handle(Session& session, const ToolInput& input, const cv::Mat& image) {
  prepare(session, image, input.pressed);
  if (!wire_) return;
  const bool moved = (input.at_px - pointer_px_).squaredNorm() > 0.0;
  pointer_px_ = input.at_px;
  if (input.pressed) {
    const auto& seeds = wire_->seeds();
    const bool on_first = seeds.size() >= 2 && (seeds.front() - input.at_px).norm() <= 1.5 * input.reach_px;
    if (on_first || (input.twice && seeds.size() >= 2)) return finish(session);
    // On what is drawn, but not where it is about to be closed or goes on: the line is taken back to there.
    const auto near = [&](const Eigen::Vector2d& seed) { return (seed - input.at_px).norm() <= 3.0 * input.reach_px; };
    const bool at_ends = seeds.empty() || near(seeds.front()) || near(seeds.back());
    if (at_ends || !wire_->reseed(input.at_px, kOnLine * input.reach_px)) {
      session.attempt("wire", [&] { wire_->add_seed(wire_->snapped(input.at_px, kSnap * input.reach_px)); });
    }
    show(session);
  } else if (moved && input.hovered && !wire_->seeds().empty()) {
    show(session);
  }
}

bool WireTool::undo(Session& session) {
  if (!wire_ || !is_of_shown_frame(session) || wire_->seeds().empty() || !wire_->undo()) return false;
  show(session);
  return true;
}

void WireTool::give_up(Session& session) {
  if (is_lost(session)) scan_.reset();  // looks again when the tool is taken up
  while (wire_ && !wire_->seeds().empty() && wire_->undo()) {
  }
  session.view.line_px.clear();
}

void WireTool::finish(Session& session) {
  if (!wire_ || !is_of_shown_frame(session) || wire_->seeds().size() < 2) return;
  const bool closed = session.attempt("wire", [&] { wire_->close(); });
  if (!closed) return;
  session.view.line_px = wire_->line();
  ReviewTools::finish_line(session);
  give_up(session);
}

}  // namespace fathom
