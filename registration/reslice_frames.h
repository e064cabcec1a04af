#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "registration/fan_mask.h"
#include "registration/frame_geometry.h"
#include "registration/partition.h"
#include "registration/reslice_surface.h"

namespace fathom {

// Which frames show which pixels of a picture. Along a straight row the distance to a frame's plane and the projection
// onto it are linear in the column, so what two frames enclose are ranges of columns. No pixels are needed for this.

/// The frames of all sweeps, sweep after sweep, and what may be used of their images.
struct ResliceFrames {
  struct Frame {
    PlacedFrame placed;
    std::size_t sweep = 0;
  };
  std::vector<Frame> frames;
  std::vector<double> max_gap_mm;  ///< of every sweep: a wider gap between two frames stays a hole
  cv::Rect used;                   ///< the part of the images that is used
  cv::Mat mask;                    ///< CV_8U, of the size of `used`: 1 where a pixel is used; empty where all are

  /// Boxes of frames that may show something within `max_gap_mm` of their planes.
  Eigen::AlignedBox3d reach(std::size_t frame) const;
};

/// How far apart the frames of a sweep are: half of its way lies in gaps from one frame to the next that are no wider.
/// Gaps are perpendicular to the frames and the largest over their corners. Frames of a probe that rests do not count.
double typical_gap_mm(const std::vector<PlacedFrame>& frames, const cv::Rect& used);

/// The frames near a picture, by numbers: three linear functions of each (distance from its plane in mm, image x and y
/// in pixels from the used rectangle's first). Normals of a sweep's frames point to one side.
struct NearFrames {
  using Functions = Eigen::Matrix<double, Eigen::Dynamic, 4>;

  std::vector<std::size_t> index;  ///< in ResliceFrames, ascending
  Functions distance, x, y;        ///< a row for each frame
  std::vector<bool> linked;        ///< to the next one: both are of one sweep and follow each other

  int count() const { return static_cast<int>(index.size()); }
};

/// The frames that may show something of a surface, with the layers of a slab of `thickness_mm` about it.
NearFrames near_frames(const ResliceFrames& frames, const ResliceSurface& surface, double thickness_mm);

/// The linear functions of frames `first` to `end` - 1 along a row: value at column u is at + u * step.
class RowFunctions {
 public:
  void set(const NearFrames& near, const ResliceRow& row, int first, int end);

  double distance(int frame, int u) const { return value(0, frame, u); }
  double distance_at(int frame) const { return at_[0][frame - first_]; }
  double distance_step(int frame) const { return step_[0][frame - first_]; }
  double image_at(int axis, int frame) const { return at_[axis + 1][frame - first_]; }
  double image_step(int axis, int frame) const { return step_[axis + 1][frame - first_]; }

 private:
  double value(int which, int frame, int u) const {
    return at_[which][frame - first_] + u * step_[which][frame - first_];
  }

  int first_ = 0;
  int end_ = 0;
  Eigen::Vector3d row_step_ = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::VectorXd at_[3];
  Eigen::VectorXd step_[3];
};

/// Columns `first` to `end` - 1 that frame `frame` shows, alone or together with the next.
struct ResliceRun {
  int frame = 0;  ///< in NearFrames
  bool pair = false;
  int first = 0;
  int end = 0;
};

/// Finds the runs of one row after another. One for each thread.
class RowRuns {
 public:
  /// What is given is kept by reference. Without `partition`, or where it names no sweep, all sweeps are used.
  RowRuns(const ResliceFrames& frames, const NearFrames& near, int columns, double spacing_mm,
          const SpacePartition* partition);

  /// Appends the runs of a row, from left to right. Where several pairs of frames enclose a column, the pair with the
  /// smallest sum of distances is taken, and of equal ones the earliest. A column that no pair encloses and that lies
  /// within half a pixel of a frame's plane is shown by that frame alone.
  void find(const ResliceRow& row, std::vector<ResliceRun>& runs);

 private:
  struct Columns {
    int first = 0;
    int end = 0;
  };

  void divide_by_sweeps(const ResliceRow& row);
  void offer_pair(int frame, int first, int end);
  void offer_alone(int frame, int first, int end);
  bool shows(int frame, int column) const;
  void cut_to_image(int frame, Columns& columns) const;
  void change_columns();

  const ResliceFrames& frames_;
  const NearFrames& near_;
  const int columns_;
  const double half_pixel_mm_;
  const SpacePartition* const partition_;
  RowFunctions functions_;
  std::vector<int> change_;          // of each frame: the first column on the other side of its plane than column 0
  std::vector<std::uint8_t> front_;  // of each frame: whether column 0 is in front of it
  std::vector<double> least_mm_;     // of each column: sum of distances of the best pair
  std::vector<int> winner_;          // of each column: 2 * frame, + 1 for a pair
  std::vector<std::vector<Columns>> of_sweep_;  // of each sweep: where it may be used; all may be used if empty
};

}  // namespace fathom
