#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "registration/reconstruct.h"
#include "registration/reconstruct_rows.h"

namespace fathom {

/// What the voxels of a reconstruction have added up to, whatever their type.
class Reconstruction::Cells {
 public:
  virtual ~Cells() = default;
  virtual void insert(std::span<const PlacedImage> images) = 0;
  virtual void write(Reconstructed& to, const CellBox& box) const = 0;

  VoxelGrid grid;
  int pixel_type = 0;
  cv::Size image_size;
  cv::Rect used;
  PixelArea area;
  bool latest = false;
  CellBox touched;  // since the last update
};

/// Cells for a grid, all without a value. Throws Error for images that are not grey integers of 8 or 16 bits;
/// std::bad_alloc.
std::unique_ptr<Reconstruction::Cells> make_cells(int pixel_type, const VoxelGrid& grid,
                                                  const ReconstructOptions& options);

/// Bytes that such a cell takes.
std::size_t cell_bytes(const ReconstructOptions& options);

}  // namespace fathom
