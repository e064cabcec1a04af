#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "segmentation/contours.h"
#include "segmentation/edge_map.h"
#include "segmentation/edge_preference.h"
#include "segmentation/wire_search.h"

namespace fathom {

/// How the wire clings to edges.
struct LiveWireOptions {
  EdgeMapOptions edges;
  bool train = true;  ///< prefer the kind of edge that the part drawn so far shows: strength, bright side, and
                      ///< how far beside the steepest place the seeds are
  /// Throws Error as EdgeMapOptions::check.
  void check() const;
};

/// Outlining by seeds: between them the line follows the edges of one image by itself (Mortensen and Barrett 1998).
/// Points are in pixels and may lie between them; so do the points of the line. Every change can be undone.
///
/// Edges three times as coarse as asked for are searched, since where an edge leads is seen from afar, and large images
/// on a coarser lattice, so that a line to anywhere takes no longer than a display frame. The line is then put where
/// the edge is in the image itself.
///
/// A viewer calls `add_seed` on a click, `wire_to` while the pointer moves, `reseed` on a click near the drawn part,
/// `close` on a double click and `undo` on a key.
class LiveWire {
 public:
  /// Throws Error as `edge_map` and LiveWireOptions::check.
  explicit LiveWire(const cv::Mat& image, const LiveWireOptions& options = {});
  LiveWire(const LiveWire&) = delete;
  LiveWire& operator=(const LiveWire&) = delete;

  /// Fixes the line as far as this point. Throws Error when the point is not in the image (half a pixel beyond the
  /// outermost centres), is where the last seed is, or the line is closed.
  void add_seed(const Eigen::Vector2d& point_px);

  /// The line from the last seed to a pointer, which may be outside of the image. Empty before the first seed and
  /// after closing.
  Polygon wire_to(const Eigen::Vector2d& pointer_px);

  /// Joins the last seed to the first. Throws Error with fewer than two seeds, or when what is enclosed has no area.
  void close();

  /// Takes the line back to its point nearest to `point_px` and goes on from there; a closed line is opened. Returns
  /// false, and changes nothing, where the drawn line is not within `reach_px`, or the point is the end of it.
  bool reseed(const Eigen::Vector2d& point_px, double reach_px);

  /// Takes back the last change: seed, closing or re-seeding. Returns false where there is none.
  bool undo();

  bool closed() const { return state_.closed; }
  const std::vector<Eigen::Vector2d>& seeds() const { return state_.seeds; }
  /// What is drawn: open from the first seed to the last, or a closed outline that does not cross itself.
  Polygon line() const;
  /// Where the seed nearest to `point_px` on an edge would be, within `reach_px`; the point itself where there is none.
  Eigen::Vector2d snapped(const Eigen::Vector2d& point_px, double reach_px) const;
  const EdgeMap& edges() const { return edges_; }

 private:
  struct State {
    std::vector<Eigen::Vector2d> seeds;
    std::vector<Polygon> pieces;  ///< between seeds, both ends included; the last one closes
    bool closed = false;
  };

  Polygon wire_between(const Eigen::Vector2d& to);
  void learn_place_of_line(const Polygon& line);
  cv::Point node_at(const Eigen::Vector2d& point_px) const;
  Eigen::Vector2d place_of(const cv::Point& node) const;
  Polygon open_line() const;
  void change(State next);
  void prepare_search();
  bool inside(const Eigen::Vector2d& point_px) const;

  LiveWireOptions options_;
  EdgeMap edges_;
  cv::Size size_;
  int factor_;          ///< pixels between the nodes of the search
  EdgeMap far_edges_;   ///< what is searched, pixel by pixel
  EdgeMap node_edges_;  ///< the same at the nodes
  EdgePreference preference_;
  WireCosts costs_;
  WireSearch search_;
  bool search_ready_ = false;
  State state_;
  std::vector<State> history_;
};

}  // namespace fathom
