#include "registration/reconstruct.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/error.h"
#include "registration/reconstruct_cells.h"

namespace fathom {

namespace {

constexpr std::size_t kBatch = 8;  // frames whose pixels are held at once

}  // namespace

void ReconstructOptions::check() const {
  if (!(spacing_mm > 0.0) || !std::isfinite(spacing_mm)) throw Error("the voxels' spacing must be positive, in mm");
  if (!(max_bytes > 0.0)) throw Error("the memory allowed must be positive");
  if (fan) fan->check();
}

double Reconstruction::bytes_per_voxel(int pixel_type, const ReconstructOptions& options) {
  return static_cast<double>(cell_bytes(options) + CV_ELEM_SIZE(pixel_type) + 1);
}

Reconstruction::Reconstruction(const VoxelGrid& grid, int pixel_type, cv::Size image_size,
                               const ReconstructOptions& options) {
  options.check();
  require_fits(grid, bytes_per_voxel(pixel_type, options), options.max_bytes, "the voxel array");
  const cv::Rect used = clipped(image_size, options.clip);
  PixelArea area = pixel_area(image_size, used, options.fan);
  cells_ = make_cells(pixel_type, grid, options);
  cells_->pixel_type = pixel_type;
  cells_->image_size = image_size;
  cells_->used = used;
  cells_->area = std::move(area);
  cells_->latest = options.compounding == Compounding::kLatest;
}

Reconstruction::~Reconstruction() = default;
Reconstruction::Reconstruction(Reconstruction&&) noexcept = default;

const VoxelGrid& Reconstruction::grid() const { return cells_->grid; }

void Reconstruction::insert(std::span<const PlacedImage> images) {
  const VoxelGrid& grid = cells_->grid;
  for (const PlacedImage& image : images) {
    if (image.image.size() != cells_->image_size || image.image.type() != cells_->pixel_type) {
      throw Error("a frame has another size or type of pixels than the first; give frames of one recording");
    }
    if (!image.reference_from_image.matrix().allFinite()) throw Error("a frame's place is not finite; leave it out");
  }
  cells_->insert(images);
  Eigen::AlignedBox3d box;
  for (const PlacedImage& image : images) {
    box.extend(box_around({{0, image.reference_from_image}}, cells_->used.tl(), cells_->used.br()));
  }
  if (images.empty()) return;
  CellBox& touched = cells_->touched;
  const bool first = touched.high[0] <= touched.low[0];
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    const auto limit = static_cast<double>(grid.size[k]);
    const auto cell = [&](double mm, double margin) {
      const double at = (mm - grid.origin_mm[axis]) / grid.spacing_mm + margin;
      return static_cast<std::int64_t>(std::clamp(std::floor(at), 0.0, limit));
    };
    const std::int64_t low = cell(box.min()[axis], -1.0);
    const std::int64_t high = cell(box.max()[axis], 2.0);
    touched.low[k] = first ? low : std::min(touched.low[k], low);
    touched.high[k] = first ? high : std::max(touched.high[k], high);
  }
}

Reconstructed Reconstruction::result() const {
  const VoxelGrid& grid = cells_->grid;
  const int sizes[3] = {static_cast<int>(grid.size[2]), static_cast<int>(grid.size[1]), static_cast<int>(grid.size[0])};
  Reconstructed result;
  result.volume.voxels = cv::Mat::zeros(3, sizes, cells_->pixel_type);
  result.volume.reference_from_voxel = grid.reference_from_voxel();
  result.filled = cv::Mat::zeros(3, sizes, CV_8U);
  cells_->write(result, {{0, 0, 0}, grid.size});
  return result;
}

void Reconstruction::update(Reconstructed& kept) {
  assert(kept.volume.voxels.dims == 3 && kept.volume.voxels.type() == cells_->pixel_type);
  cells_->write(kept, cells_->touched);
  cells_->touched = {};
}

Reconstructed reconstruct(const Recording& recording, const FrameLocator& locator, const ReconstructOptions& options,
                          const Progress& progress) {
  options.check();
  require_grey_integers(recording);
  const RecordingHeader& header = recording.header();
  const std::vector<PlacedFrame> frames = placed_frames(recording, locator);
  if (frames.empty()) {
    throw Error(recording.name() + ": no frame has a valid image and pose; nothing can be placed in space");
  }
  const cv::Size size(header.width, header.height);
  const VoxelGrid grid = grid_around(frames, size, options.clip, options.spacing_mm);
  require_fits(grid, Reconstruction::bytes_per_voxel(header.pixel_type, options), options.max_bytes, recording.name());
  Reconstruction reconstruction(grid, header.pixel_type, size, options);
  std::vector<PlacedImage> batch;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    report(progress, 0.9 * static_cast<double>(i) / static_cast<double>(frames.size()));
    batch.push_back({recording.image(frames[i].frame), frames[i].reference_from_image});
    if (batch.size() < kBatch && i + 1 < frames.size()) continue;
    reconstruction.insert(batch);
    batch.clear();
  }
  Reconstructed result = reconstruction.result();
  report(progress, 1.0);
  return result;
}

}  // namespace fathom
