#include "segmentation/live_wire.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>
#include <utility>

#include "core/error.h"
#include "segmentation/outline_loops.h"
#include "segmentation/wire_costs.h"
#include "segmentation/wire_line.h"

namespace fathom {

namespace {

constexpr std::size_t kTrainingPoints = 200;  // the latest: an outline may change its kind of edge on the way
constexpr double kSamePlace = 0.5;            // pixels: two seeds nearer than that are a double click
constexpr double kLeastArea = 1.0;            // square pixels
constexpr double kSearchScale = 3.0;          // of the scale that the line is placed by
constexpr double kMostNodes = 120000.0;       // are searched within a few milliseconds

std::span<const Eigen::Vector2d> latest(const Polygon& line) {
  return std::span(line).subspan(line.size() - std::min(line.size(), kTrainingPoints));
}

int nodes_apart(const cv::Size& size) {
  int factor = 1;
  while (static_cast<double>(size.width) * size.height > kMostNodes * factor * factor) ++factor;
  return factor;
}

}  // namespace

void LiveWireOptions::check() const { edges.check(); }

LiveWire::LiveWire(const cv::Mat& image, const LiveWireOptions& options)
    : options_(options),
      edges_((options.check(), edge_map(image, options.edges))),
      size_(edges_.gradient.size()),
      factor_(nodes_apart(size_)),
      far_edges_(edge_map(image, {std::min(kSearchScale * edges_.scale_px, EdgeMapOptions::kMostScale_px)})),
      node_edges_(coarser(far_edges_, factor_)),
      costs_(wire_costs(node_edges_, preference_)),
      search_(costs_) {}

bool LiveWire::inside(const Eigen::Vector2d& point) const {
  return point.allFinite() && point.minCoeff() >= -0.5 && point.x() <= size_.width - 0.5 &&
         point.y() <= size_.height - 0.5;
}

cv::Point LiveWire::node_at(const Eigen::Vector2d& point) const {
  const auto index = [this](double px, int count) {
    return static_cast<int>(std::clamp(std::floor((px + 0.5) / factor_), 0.0, count - 1.0));
  };
  return {index(point.x(), costs_.size.width), index(point.y(), costs_.size.height)};
}

Eigen::Vector2d LiveWire::place_of(const cv::Point& node) const {
  const Eigen::Vector2d place(factor_ * (node.x + 0.5) - 0.5, factor_ * (node.y + 0.5) - 0.5);
  return place.cwiseMin(Eigen::Vector2d(size_.width - 1.0, size_.height - 1.0));
}

void LiveWire::change(State next) {
  history_.push_back(std::exchange(state_, std::move(next)));
  search_ready_ = false;
}

bool LiveWire::undo() {
  if (history_.empty()) return false;
  state_ = std::move(history_.back());
  history_.pop_back();
  search_ready_ = false;
  return true;
}

Polygon LiveWire::open_line() const {
  Polygon line;
  for (const Polygon& piece : state_.pieces) line.insert(line.end(), piece.begin(), piece.end() - 1);
  if (!state_.closed && !state_.seeds.empty()) line.push_back(state_.seeds.back());
  return line;
}

Polygon LiveWire::line() const { return state_.closed ? without_loops(open_line()) : open_line(); }

// What the latest part of a line that starts at the first seed shows.
void LiveWire::learn_place_of_line(const Polygon& line) {
  preference_ = learn_edges(edges_, latest(line), false);
  Polygon along;
  Polygon edges;  // where the map should have the edges that the seeds are on
  std::size_t at = 0;
  for (std::size_t i = 0; i < state_.seeds.size(); ++i) {
    along.push_back(direction_at(line, at));
    edges.push_back(state_.seeds[i] + smoothed_aside_px(edges_, line, at) * right_of(along.back()));
    if (i < state_.pieces.size()) at += state_.pieces[i].size() - 1;
  }
  preference_.beside_px = learn_place(edges_, preference_, edges, along);
}

void LiveWire::prepare_search() {
  if (search_ready_) return;
  const Polygon drawn = open_line();
  if (options_.train) {
    learn_place_of_line(drawn);
    costs_ = wire_costs(node_edges_, learn_edges(far_edges_, latest(drawn), false));
  }
  // The line is not to run back along itself. Its first seed stays free, for closing.
  const cv::Point first = node_at(state_.seeds.front());
  std::vector<cv::Point> occupied;
  for (const Eigen::Vector2d& point : drawn) {
    const cv::Point node = node_at(point);
    if (std::max(std::abs(node.x - first.x), std::abs(node.y - first.y)) > 2) occupied.push_back(node);
  }
  search_.start(node_at(state_.seeds.back()), occupied);
  search_ready_ = true;
}

Polygon LiveWire::wire_between(const Eigen::Vector2d& to) {
  const Eigen::Vector2d& from = state_.seeds.back();
  if (edges_.flat) return {from, to};
  prepare_search();
  Polygon path;
  for (const cv::Point& node : search_.path_to(node_at(to))) path.push_back(place_of(node));
  // With the first seed only, what the wire follows is all there is to learn from.
  if (options_.train && state_.pieces.empty()) learn_place_of_line(path);
  const Polygon drawn = open_line();
  WireEnds ends{from, to, std::span(drawn).first(drawn.size() - 1), {}};
  if (to == state_.seeds.front()) ends.behind = std::span(drawn).subspan(1);
  return wire_line(edges_, preference_, path, factor_, ends);
}

void LiveWire::add_seed(const Eigen::Vector2d& point_px) {
  if (state_.closed) throw Error("live-wire: the outline is closed; undo that to go on with it");
  if (!inside(point_px)) throw Error("live-wire: a seed lies outside of the image; place it inside");
  State next = state_;
  if (!state_.seeds.empty()) {
    if ((point_px - state_.seeds.back()).norm() < kSamePlace) {
      throw Error("live-wire: a seed is where the one before is; place it farther along the outline");
    }
    next.pieces.push_back(wire_between(point_px));
  }
  next.seeds.push_back(point_px);
  change(std::move(next));
}

Polygon LiveWire::wire_to(const Eigen::Vector2d& pointer_px) {
  if (state_.seeds.empty() || state_.closed || !pointer_px.allFinite()) return {};
  const Eigen::Vector2d to(std::clamp(pointer_px.x(), -0.5, size_.width - 0.5),
                           std::clamp(pointer_px.y(), -0.5, size_.height - 0.5));
  return wire_between(to);
}

void LiveWire::close() {
  if (state_.closed) throw Error("live-wire: the outline is closed already");
  if (state_.seeds.size() < 2) throw Error("live-wire: an outline needs two seeds or more; add some");
  State next = state_;
  next.pieces.push_back(wire_between(state_.seeds.front()));
  next.closed = true;
  change(std::move(next));
  const Polygon outline = line();
  if (outline.size() < 3 || std::abs(signed_area(outline)) < kLeastArea) {
    undo();
    throw Error("live-wire: the outline encloses nothing; place the seeds around the structure");
  }
}

bool LiveWire::reseed(const Eigen::Vector2d& point_px, double reach_px) {
  double nearest = reach_px;
  std::optional<std::pair<std::size_t, std::size_t>> found;
  for (std::size_t piece = 0; piece < state_.pieces.size(); ++piece) {
    for (std::size_t i = 0; i < state_.pieces[piece].size(); ++i) {
      const double distance = (state_.pieces[piece][i] - point_px).norm();
      if (distance > nearest) continue;
      nearest = distance;
      found = {piece, i};
    }
  }
  if (!found) return false;
  const auto [piece, point] = *found;
  const bool at_end = piece + 1 == state_.pieces.size() && point + 1 == state_.pieces[piece].size();
  if (at_end && !state_.closed) return false;
  State next;
  next.seeds.assign(state_.seeds.begin(), state_.seeds.begin() + static_cast<std::ptrdiff_t>(piece) + 1);
  next.pieces.assign(state_.pieces.begin(), state_.pieces.begin() + static_cast<std::ptrdiff_t>(piece));
  // Closed and taken back to where it closes: only opened there.
  if (point > 0) {
    const Polygon& whole = state_.pieces[piece];
    next.pieces.emplace_back(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(point) + 1);
    next.seeds.push_back(whole[point]);
  }
  change(std::move(next));
  return true;
}

Eigen::Vector2d LiveWire::snapped(const Eigen::Vector2d& point_px, double reach_px) const {
  const int reach = static_cast<int>(std::clamp(reach_px, 0.0, 100.0));
  const int middle_x = static_cast<int>(std::lround(std::clamp(point_px.x(), 0.0, size_.width - 1.0)));
  const int middle_y = static_cast<int>(std::lround(std::clamp(point_px.y(), 0.0, size_.height - 1.0)));
  double best = 0.0;
  Eigen::Vector2d place = point_px;
  for (int y = std::max(0, middle_y - reach); y <= std::min(size_.height - 1, middle_y + reach); ++y) {
    for (int x = std::max(0, middle_x - reach); x <= std::min(size_.width - 1, middle_x + reach); ++x) {
      const Eigen::Vector2d here(x, y);
      const double far = (here - point_px).norm();
      if (edges_.ridge.at<std::uint8_t>(y, x) == 0 || far > reach_px) continue;
      const double strength = edges_.at(here).norm() * (1.0 - 0.5 * far / reach_px);
      if (strength <= best) continue;
      best = strength;
      place = here;
    }
  }
  return place;
}

}  // namespace fathom
