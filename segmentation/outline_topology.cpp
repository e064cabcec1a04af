#include "segmentation/outline_topology.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <utility>

#include "core/error.h"
#include "segmentation/box_columns.h"
#include "segmentation/outline_crossing.h"
#include "segmentation/outline_edges.h"
#include "segmentation/outline_loops.h"

namespace fathom {

namespace {

using Eigen::Vector2d;

// Comparisons of runs of edges on one frame, less than a second's work. Outlines of anything real need a hundredth.
constexpr std::int64_t kMostComparisons = 20'000'000;

// The same for comparisons of outlines with edges, which take less.
constexpr std::int64_t kMostNestingComparisons = 200'000'000;

constexpr double kLeastArea_px = 1e-6;  // in square pixels: what rounding leaves of points on one line

constexpr const char* kTangled = "is too tangled to check";

// So many runs are compared each with each faster than they are sorted.
constexpr std::size_t kFewRuns = 32;

std::string near(const Vector2d& place) {
  char text[64];
  std::snprintf(text, sizeof text, " near (%.1f, %.1f)", place.x(), place.y());
  return text;
}

// Edges that follow each other, going on in one sense along x and in one along y. Such a run does not cross itself,
// and its box is that of its ends, also for every part of it: so two runs are compared by halves.
struct Run {
  Box box;
  std::size_t first;
  std::size_t end;
};

std::vector<Run> runs_of(const OutlineEdges& edges) {
  std::vector<Run> runs;
  const auto sense = [&](std::size_t edge) {
    const Vector2d along = edges.end(edge) - edges.start(edge);
    return 2 * (along.x() < 0.0) + (along.y() < 0.0);
  };
  for (std::size_t outline = 0; outline < edges.outlines(); ++outline) {
    const std::size_t end = edges.end_of(outline);
    for (std::size_t first = edges.first_of(outline); first < end;) {
      std::size_t last = first + 1;
      const int here = sense(first);
      while (last < end && sense(last) == here) ++last;
      runs.push_back({edges.box_of_run(first, last), first, last});
      first = last;
    }
  }
  return runs;
}

// Looks for the first crossing among outlines.
class CrossingSearch {
 public:
  explicit CrossingSearch(const OutlineEdges& edges) : edges_(edges) {}

  std::optional<std::string> fault() {
    std::vector<Run> runs = runs_of(edges_);
    if (runs.size() <= kFewRuns) return fault_among(runs);
    std::vector<Box> boxes;
    boxes.reserve(runs.size());
    for (const Run& run : runs) boxes.push_back(run.box);
    const BoxColumns columns(boxes);
    std::vector<Run> here;
    for (std::size_t column = 0; column < columns.size(); ++column) {
      here.clear();
      for (const std::size_t i : columns[column]) here.push_back(runs[i]);
      if (const auto found = fault_among(here)) return found;
    }
    return std::nullopt;
  }

 private:
  std::optional<std::string> fault_among(std::vector<Run>& runs) {
    const bool sorted = runs.size() > kFewRuns;
    if (sorted) std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.box.top < b.box.top; });
    for (std::size_t a = 0; a < runs.size(); ++a) {
      for (std::size_t b = a + 1; b < runs.size(); ++b) {
        if (sorted && runs[b].box.top > runs[a].box.bottom) break;
        if (++comparisons_ > kMostComparisons) return kTangled;
        if (overlap(runs[a].box, runs[b].box) && cross_somewhere(runs[a], runs[b])) return what_;
      }
    }
    return std::nullopt;
  }

  // Whether two runs whose boxes overlap cross, or there were too many comparisons; `what_` tells.
  bool cross_somewhere(const Run& a, const Run& b) {
    if (++comparisons_ > kMostComparisons) {
      what_ = kTangled;
      return true;
    }
    if (a.end - a.first > 1 || b.end - b.first > 1) {
      const bool split_a = a.end - a.first >= b.end - b.first;
      const Run& longer = split_a ? a : b;
      const Run& other = split_a ? b : a;
      const std::size_t middle = longer.first + (longer.end - longer.first) / 2;
      for (const auto& [first, end] : {std::pair(longer.first, middle), std::pair(middle, longer.end)}) {
        const Run half = {edges_.box_of_run(first, end), first, end};
        if (overlap(half.box, other.box) && cross_somewhere(half, other)) return true;
      }
      return false;
    }
    if (edges_.next(a.first) == b.first || edges_.next(b.first) == a.first) return false;
    const auto place = crossing(edges_, a.first, b.first);
    if (!place) return false;
    const bool itself = edges_.outline_of(a.first) == edges_.outline_of(b.first);
    what_ = (itself ? "crosses itself" : "crosses another outline") + near(*place);
    return true;
  }

  const OutlineEdges& edges_;
  std::int64_t comparisons_ = 0;
  std::string what_;
};

// How outlines that do not cross lie in each other.
class NestingSearch {
 public:
  explicit NestingSearch(const OutlineEdges& edges) : edges_(edges), columns_(boxes_of(edges)) {}

  // Empty after `most` comparisons of an outline with an edge.
  std::optional<std::vector<Nesting>> nesting(std::int64_t most) {
    std::vector<Nesting> result;
    result.reserve(edges_.outlines());
    for (std::size_t i = 0; i < edges_.outlines(); ++i) {
      result.push_back(nesting_of(i));
      if (comparisons_ > most) return std::nullopt;
    }
    return result;
  }

 private:
  static std::vector<Box> boxes_of(const OutlineEdges& edges) {
    std::vector<Box> boxes;
    boxes.reserve(edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) boxes.push_back(edges.box_of_run(e, e + 1));
    return boxes;
  }

  // Whether the outline lies inside of an odd number of the others, by the lines of others that lie above the middle
  // of one of its edges. An edge that another outline touches there cannot tell.
  Nesting nesting_of(std::size_t outline) {
    for (std::size_t own = edges_.first_of(outline); own < edges_.end_of(outline); ++own) {
      const Vector2d middle = 0.5 * (edges_.start(own) + edges_.end(own));
      bool inside = false;
      bool touched = false;
      const auto beside = columns_[columns_.column_of(middle.x())];
      comparisons_ += static_cast<std::int64_t>(beside.size());
      for (const std::size_t e : beside) {
        if (edges_.outline_of(e) == outline) continue;
        const Vector2d& a = edges_.start(e);
        const Vector2d& b = edges_.end(e);
        if (std::min(a.y(), b.y()) > middle.y() + kTouchPx) continue;
        const int where = side_of_line(a, b, middle);
        if (where == 0 && between(a, b, middle)) {
          touched = true;
          break;
        }
        if ((a.x() <= middle.x()) != (b.x() <= middle.x()) && (where > 0) == (a.x() < b.x())) inside = !inside;
      }
      if (!touched) return inside ? Nesting::kHole : Nesting::kPart;
    }
    return Nesting::kCoincident;
  }

  const OutlineEdges& edges_;
  BoxColumns columns_;
  std::int64_t comparisons_ = 0;
};

// Enough for an outline not to cross itself, and fast: seen from one point, it goes round just once.
bool goes_round_once(const Polygon& outline) {
  Vector2d centre = Vector2d::Zero();
  for (const Vector2d& point : outline) centre += point;
  centre /= static_cast<double>(outline.size());
  Vector2d before = outline.back() - centre;
  int turns = 0;
  bool left = false;
  bool right = false;
  for (const Vector2d& point : outline) {
    const Vector2d now = point - centre;
    const double turn = before.x() * now.y() - before.y() * now.x();
    left |= turn > 0.0;
    right |= turn < 0.0;
    // Only a repeated point may turn by nothing: a step straight towards the centre could lead back along the outline.
    if (turn == 0.0 && now != before) return false;
    turns += (before.y() < 0.0) != (now.y() < 0.0);
    before = now;
  }
  return left != right && turns == 2;
}

std::vector<const Polygon*> pointers(std::span<const Polygon> outlines) {
  std::vector<const Polygon*> all;
  for (const Polygon& outline : outlines) all.push_back(&outline);
  return all;
}

}  // namespace

std::vector<Nesting> nesting(std::span<const Polygon* const> outlines) {
  if (outlines.size() == 1) return {Nesting::kPart};
  const OutlineEdges edges(outlines);
  return *NestingSearch(edges).nesting(std::numeric_limits<std::int64_t>::max());
}

std::optional<std::string> outline_fault(std::span<const Polygon* const> outlines) {
  if (outlines.size() == 1 && goes_round_once(*outlines.front())) return std::nullopt;
  const OutlineEdges edges(outlines);
  if (const auto fault = CrossingSearch(edges).fault()) return fault;
  if (outlines.size() == 1) return std::nullopt;
  const auto nested = NestingSearch(edges).nesting(kMostNestingComparisons);
  if (!nested) return kTangled;
  if (std::find(nested->begin(), nested->end(), Nesting::kCoincident) != nested->end()) return "is drawn twice";
  return std::nullopt;
}

std::vector<Nesting> nesting(std::span<const Polygon> outlines) { return nesting(pointers(outlines)); }

std::optional<std::string> outline_fault(std::span<const Polygon> outlines) {
  return outline_fault(pointers(outlines));
}

void require_simple_outlines(const std::vector<Structure>& structures, const std::string& file) {
  for (const Structure& structure : structures) {
    std::map<std::pair<int, int>, std::vector<const Polygon*>> outlines;
    for (const Contour& contour : structure.contours) {
      if (contour.closed) outlines[{contour.recording, contour.frame}].push_back(&contour.points_px);
    }
    for (const auto& [place, polygons] : outlines) {
      if (const auto fault = outline_fault(polygons)) {
        throw Error(file + ": structure " + structure.name + ", frame " + std::to_string(place.second) +
                    ": an outline " + *fault + "; draw it again");
      }
    }
  }
}

void require_enclosing_outlines(const std::vector<Structure>& structures, const std::string& file) {
  for (const Structure& structure : structures) {
    for (const Contour& contour : structure.contours) {
      if (!contour.closed || std::abs(signed_area(contour.points_px)) >= kLeastArea_px) continue;
      throw Error(file + ": structure " + structure.name + ", frame " + std::to_string(contour.frame) +
                  ": an outline encloses nothing; draw it again, or mark the frame as an extremity");
    }
  }
  require_simple_outlines(structures, file);
}

}  // namespace fathom
