#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/progress.h"
#include "core/volume.h"
#include "registration/fan_mask.h"
#include "registration/voxel_grid.h"

namespace fathom {

/// How a pixel gets into the voxel array.
enum class Insertion {
  kNearest,  ///< whole, into the voxel that holds it
  kLinear,   ///< shared among the eight voxels around it, by trilinear weights in steps of 1/256 of the spacing
};

/// What becomes of several pixels of one voxel.
enum class Compounding {
  kMean,    ///< (weighted) mean of all, from sums of integers: exact, rounded once
  kLatest,  ///< (weighted) mean of the pixels of the last frame that reached the voxel
  kMax,     ///< nearest: the largest pixel; linear: the largest of the frames' weighted means
};

struct ReconstructOptions {
  double spacing_mm = 1.0;  ///< side of a voxel; above 0
  Insertion insertion = Insertion::kNearest;
  Compounding compounding = Compounding::kMean;
  std::optional<cv::Rect> clip;        ///< the part of the images that is used; all of it where empty
  std::optional<Fan> fan;              ///< of that, what a curved probe shows; all of it where empty
  double max_bytes = 4.0 * (1 << 30);  ///< memory allowed for sums, voxels and marks

  /// Throws Error when a number is out of its range.
  void check() const;
};

/// A voxel array, and which of its voxels have a value. The others are 0.
struct Reconstructed {
  Volume volume;   ///< voxels of the recording's pixel type
  cv::Mat filled;  ///< CV_8U, of the same size: 255 where there is a value, else 0
};

/// An image (CV_8U, CV_8S, CV_16U or CV_16S, one channel) and its place.
struct PlacedImage {
  cv::Mat image;
  Eigen::Affine3d reference_from_image;
};

/// A voxel array that grows frame by frame, for live use. Its voxels are what all frames inserted so far give, however
/// they were grouped and on any number of threads.
class Reconstruction {
 public:
  /// Takes memory for the sums (pages that no frame touches are not used). Throws Error when the options or the type
  /// are not as said, the clip rectangle is empty, or the memory is not allowed: then it names a spacing that fits.
  Reconstruction(const VoxelGrid& grid, int pixel_type, cv::Size image_size, const ReconstructOptions& options);
  ~Reconstruction();
  Reconstruction(Reconstruction&&) noexcept;

  /// Adds frames, in order. Pixels outside the grid are left out. Throws Error for images of another size or type, or
  /// when more pixels fell into one voxel than can be summed exactly (2^24).
  void insert(std::span<const PlacedImage> images);

  /// All voxels.
  Reconstructed result() const;
  /// Brings voxels up to date where frames were inserted since the last call for `kept`, which came from result() or
  /// an earlier update().
  void update(Reconstructed& kept);

  const VoxelGrid& grid() const;
  /// Bytes per voxel of sums, voxel and mark.
  static double bytes_per_voxel(int pixel_type, const ReconstructOptions& options);

  class Cells;

 private:
  std::unique_ptr<Cells> cells_;
};

/// The valid frames of a recording as a voxel array on the grid around them. Throws Error where no frame has a place,
/// for images that are not grey integers of 8 or 16 bits, and as Reconstruction; Cancelled.
Reconstructed reconstruct(const Recording& recording, const FrameLocator& locator, const ReconstructOptions& options,
                          const Progress& progress = {});

}  // namespace fathom
