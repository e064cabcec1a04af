#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "registration/frame_locator.h"
#include "registration/sweep.h"
#include "surface/convex_clip.h"

namespace fathom {

using DividingPlane = Eigen::Hyperplane<double, 3>;  ///< unit normal; reference coordinates, mm

/// Where the frames of one sweep lie, in reference coordinates.
struct SweepShape {
  std::vector<Eigen::Vector3d> centres_mm;  ///< of the image of every frame whose pose is known, in their order
  /// Corners of the first and last of them: top left, top right, bottom right, bottom left.
  std::vector<Eigen::Vector3d> first_corners_mm;
  std::vector<Eigen::Vector3d> last_corners_mm;

  /// A further frame, of `width` by `height` pixels.
  void add(const Eigen::Affine3d& reference_from_image, int width, int height);
  Eigen::Vector3d centre_mm() const;
};

/// `width` and `height` in pixels. Throws Error when no frame of the sweep has a pose.
SweepShape sweep_shape(const Sweep& sweep, const FrameLocator& locator, int width, int height);

/// Planes that split space so that one sweep is used in each part. Sweeps are numbered from 0 as given. The assignment
/// of sweeps to parts always follows the planes. Treece 2000, section 4.2.2.
class SpacePartition {
 public:
  static constexpr std::size_t kMaxPlanes = 32;  ///< a bit for each in Cell::sides

  /// A part of space, which is convex.
  struct Cell {
    std::uint32_t sides = 0;  ///< bit i: on the side that the normal of plane i points to
    /// The one to use here; empty where there are several sweeps and no planes.
    std::optional<std::size_t> sweep;
    std::size_t region = 0;  ///< the same for cells that touch in a face and use the same sweep
    Eigen::Vector3d inside_mm = Eigen::Vector3d::Zero();  ///< a point of it
  };

  SpacePartition() = default;
  /// Throws Error for more than kMaxPlanes planes or one that is not finite or has no unit normal.
  explicit SpacePartition(std::vector<SweepShape> sweeps, std::vector<DividingPlane> planes = {});

  void add(const DividingPlane& plane);                   ///< throws Error as the constructor
  void move(std::size_t plane, const DividingPlane& to);  ///< throws Error as the constructor
  void remove(std::size_t plane);
  /// Removes planes that separate no two sweeps, one after another. Returns how many.
  std::size_t remove_redundant();

  const std::vector<SweepShape>& sweeps() const { return sweeps_; }
  const std::vector<DividingPlane>& planes() const { return planes_; }
  /// Those that exist within 20 times the extent of all sweeps, ascending by `sides`.
  const std::vector<Cell>& cells() const { return cells_; }
  std::size_t region_count() const { return regions_; }

  std::uint32_t sides_at(const Eigen::Vector3d& point_mm) const;
  /// The sweep to use at a point, by its cell; empty as Cell::sweep.
  std::optional<std::size_t> sweep_at(const Eigen::Vector3d& point_mm) const;
  /// The sweep to use in a region; empty as Cell::sweep, and where no cell has that region.
  std::optional<std::size_t> sweep_in(std::size_t region) const;
  /// Whether plane `plane` separates two sweeps anywhere.
  bool separates(std::size_t plane) const;

  /// The planes of a cell, turned so that the cell is on their positive side.
  std::vector<DividingPlane> bounds(const Cell& cell) const;

  /// Where a frame of sweep `sweep` is better covered by another sweep: convex polygons in pixels. The image's
  /// rectangle reaches from the outer edges of its first pixels to those of its last.
  std::vector<std::vector<Eigen::Vector2d>> hatched(std::size_t sweep, const Eigen::Affine3d& reference_from_image,
                                                    int width, int height) const;

  /// Convex parts of a plane's disc (in the sphere that holds all sweeps) that separate two sweeps.
  std::vector<Polygon3> visible_disc(std::size_t plane) const;

 private:
  void update();
  std::optional<std::size_t> best_sweep(std::uint32_t sides) const;
  const Cell* find_cell(std::uint32_t sides) const;

  std::vector<SweepShape> sweeps_;
  std::vector<DividingPlane> planes_;
  std::vector<Cell> cells_;
  std::size_t regions_ = 0;
  Eigen::Vector3d centre_mm_ = Eigen::Vector3d::Zero();
  double radius_mm_ = 0.0;                     ///< of the sphere that holds all sweeps
  std::vector<Eigen::ArrayXXd> distances_mm_;  ///< of each sweep: a row for each centre, a column for each plane
};

}  // namespace fathom
