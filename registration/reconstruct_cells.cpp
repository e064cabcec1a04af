#include "registration/reconstruct_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "registration/reconstruct_sums.h"

namespace fathom {

namespace {

constexpr int kSlabs = 16;  // more than threads, so that none waits long for the last

// Pages of zeros that the system provides when they are first written to.
struct Free {
  void operator()(void* memory) const { std::free(memory); }
};

template <typename Pixel, typename Cell>
class TypedCells : public Reconstruction::Cells {
 public:
  // Linear insertion reaches one cell beyond the grid on every side; those margins are thrown away.
  static constexpr std::int64_t kMargin = kIsLinear<Cell> ? 1 : 0;
  static constexpr std::int64_t kOffset = -static_cast<std::int64_t>(std::numeric_limits<Pixel>::min());

  void allocate() {
    const std::int64_t columns = grid.size[0] + 2 * kMargin;
    const std::int64_t rows = grid.size[1] + 2 * kMargin;
    strides_ = {1, columns, columns * rows};
    count_ = static_cast<std::size_t>(strides_[2] * (grid.size[2] + 2 * kMargin));
    cells_.reset(static_cast<Cell*>(std::calloc(count_, sizeof(Cell))));
    if (!cells_) throw std::bad_alloc();
  }

  void insert(std::span<const PlacedImage> images) override {
    require_exact(images);
    const std::int64_t low = -kMargin;
    const std::int64_t cells = grid.size[2] + kMargin;
    // A slab of linear insertion writes into the first layer of the next: every second one is done first.
    const std::int64_t slabs = cv::getNumThreads() < 2 ? 1 : std::clamp<std::int64_t>(cells / 2, 1, kSlabs);
    const auto edge = [&](std::int64_t slab) { return low + cells * slab / slabs; };
    for (int phase = 0; phase < (kIsLinear<Cell> ? 2 : 1); ++phase) {
      const std::int64_t step = kIsLinear<Cell> ? 2 : 1;
      const auto in_phase = static_cast<int>((slabs - phase + step - 1) / step);
      if (in_phase < 1) continue;
      cv::parallel_for_(
          cv::Range(0, in_phase),
          [&](const cv::Range& range) {
            for (int i = range.start; i < range.end; ++i) {
              const std::int64_t slab = phase + step * i;
              CellBox box{{low, low, edge(slab)}, {grid.size[0], grid.size[1], edge(slab + 1)}};
              for (std::size_t f = 0; f < images.size(); ++f) insert_frame(images[f], frames_ + f + 1, box);
            }
          },
          in_phase);
    }
    frames_ += images.size();
  }

  void write(Reconstructed& to, const CellBox& box) const override {
    const auto first = static_cast<int>(box.low[2]);
    const auto last = static_cast<int>(box.high[2]);
    if (first >= last) return;
    cv::parallel_for_(cv::Range(first, last), [&](const cv::Range& slices) {
      for (int z = slices.start; z < slices.end; ++z) {
        for (auto y = static_cast<int>(box.low[1]); y < static_cast<int>(box.high[1]); ++y) {
          auto* values = to.volume.voxels.ptr<Pixel>(z, y);
          auto* filled = to.filled.ptr<std::uint8_t>(z, y);
          const Cell* cells = cells_.get() + (z + kMargin) * strides_[2] + (y + kMargin) * strides_[1] + kMargin;
          for (std::int64_t x = box.low[0]; x < box.high[0]; ++x) {
            const std::uint32_t value = above(cells[x]);
            if (value == 0) continue;
            values[x] = static_cast<Pixel>(static_cast<std::int64_t>(value) - 1 - kOffset);
            filled[x] = 255;
          }
        }
      }
    });
  }

 private:
  Eigen::Affine3d cell_from_image(const PlacedImage& image) const {
    Eigen::Affine3d map = grid.reference_from_voxel().inverse() * image.reference_from_image;
    if constexpr (!kIsLinear<Cell>) map.pretranslate(Eigen::Vector3d::Constant(0.5));
    return map;
  }

  // Throws where a voxel could have got more pixels than its sum can hold.
  void require_exact(std::span<const PlacedImage> images) {
    if constexpr (std::is_same_v<Cell, MaxCell>) return;
    for (const PlacedImage& image : images) {
      // Two pixels of one cell (or of two neighbours) are no farther apart than its diagonal.
      const Eigen::Matrix<double, 3, 2> steps = cell_from_image(image).linear().template leftCols<2>();
      const Eigen::Matrix2d squares = steps.transpose() * steps;
      const double mean = 0.5 * squares.trace();
      const double smallest =
          std::sqrt(std::max(0.0, mean - std::sqrt(std::max(0.0, mean * mean - squares.determinant()))));
      const double side = (kIsLinear<Cell> ? 2.0 : 1.0) * std::sqrt(3.0) / smallest + 1.0;
      possible_count_ += std::min(side * side, static_cast<double>(image_size.area()));
    }
    if (possible_count_ <= static_cast<double>(kCountMask)) return;
    std::uint64_t largest = 0;
    for (std::size_t i = 0; i < count_; ++i) largest = std::max(largest, count_of(cells_.get()[i]));
    const double added = static_cast<double>(image_size.area()) * static_cast<double>(images.size());
    possible_count_ = static_cast<double>(largest) + added;
    if (possible_count_ > static_cast<double>(kCountMask)) {
      throw Error(
          "more than 16 million pixels may fall into one voxel, too many to be summed exactly; choose a finer "
          "spacing");
    }
  }

  void insert_frame(const PlacedImage& image, std::uint64_t frame, const CellBox& box) {
    const Eigen::Affine3d map = cell_from_image(image);
    const RowSteps steps(map.linear().col(0));
    std::vector<std::uint64_t> sums(static_cast<std::size_t>(image_size.width) + 1);
    for (int y = used.y; y < used.y + used.height; ++y) {
      const Eigen::Vector3d start = map.translation() + y * map.linear().col(1);
      for (const PixelSpan& span : area.rows[static_cast<std::size_t>(y)]) {
        const RowWalk walk(steps, start, box, span.first, span.end);
        if (walk.empty()) continue;
        const Pixel* pixels = image.image.ptr<Pixel>(y);
        if (steps.finer_than_cells()) {
          insert_row<true>(walk, steps, pixels, frame, sums.data());
        } else {
          insert_row<false>(walk, steps, pixels, frame, sums.data());
        }
      }
    }
  }

  template <bool kFine>
  void insert_row(const RowWalk& walk, const RowSteps& steps, const Pixel* pixels, std::uint64_t frame,
                  std::uint64_t* sums) {
    if constexpr (kIsLinear<Cell>) {
      insert_linear<kFine>(walk, steps, pixels, frame);
    } else if constexpr (std::is_same_v<Cell, MaxCell>) {
      walk.each_run<kFine>(strides_, [&](std::int64_t first, std::int64_t end, std::int64_t index, const auto&) {
        const std::int64_t value = *std::max_element(pixels + first, pixels + end);
        auto& cell = cells_.get()[index];
        cell.above = std::max(cell.above, static_cast<std::uint32_t>(value + kOffset + 1));
      });
    } else {
      // Sums of any run by one subtraction.
      std::uint64_t sum = 0;
      for (std::int64_t x = walk.begin(); x < walk.end(); ++x) {
        sums[x] = sum;
        sum += static_cast<std::uint64_t>(pixels[x] + kOffset);
      }
      sums[walk.end()] = sum;
      walk.each_run<kFine>(strides_, [&](std::int64_t first, std::int64_t end, std::int64_t index, const auto&) {
        Cell& cell = cells_.get()[index];
        if constexpr (std::is_same_v<Cell, LatestCell>) {
          if (cell.frame != frame) cell = {0, frame};
        }
        cell.sum_and_count += ((sums[end] - sums[first]) << kCountBits) + static_cast<std::uint64_t>(end - first);
      });
    }
  }

  template <bool kFine>
  void insert_linear(const RowWalk& walk, const RowSteps& steps, const Pixel* pixels, std::uint64_t frame) {
    constexpr int kFixedBits = 24;  // of a position in its cell, while it is stepped along
    const double fixed_step = std::ldexp(1.0, kFixedBits);
    std::array<std::int64_t, 3> step;
    std::array<double, 3> scale;
    for (int k = 0; k < 3; ++k) {
      step[static_cast<std::size_t>(k)] = std::llround(steps.step[k] * fixed_step);
      scale[static_cast<std::size_t>(k)] = std::ldexp(std::abs(steps.step[k]), kFixedBits - kPlaceBits);
    }
    const auto weight = [](std::int64_t fixed) {
      const std::int64_t half = std::int64_t{1} << (kFixedBits - kFractionBits - 1);
      return static_cast<std::uint32_t>(
          std::clamp<std::int64_t>((fixed + half) >> (kFixedBits - kFractionBits), 0, kOne));
    };
    walk.each_run<kFine>(strides_, [&](std::int64_t first, std::int64_t end, std::int64_t index, const auto& next) {
      std::array<std::int64_t, 3> at;
      for (std::size_t k = 0; k < 3; ++k) {
        if (next[k] >= kNever) {
          at[k] = std::llround(walk.fraction(k, first, steps) * fixed_step);
          continue;
        }
        const double left = static_cast<double>(next[k] - (first << kPlaceBits)) * scale[k];
        at[k] = static_cast<std::int64_t>(step[k] > 0 ? fixed_step - left : left);
      }
      std::array<std::uint64_t, 8> sum = {};
      std::array<std::uint64_t, 8> total = {};
      for (std::int64_t x = first; x < end; ++x) {
        const std::uint32_t wx = weight(at[0]);
        const std::uint32_t wy = weight(at[1]);
        const std::uint32_t wz = weight(at[2]);
        for (std::size_t k = 0; k < 3; ++k) at[k] += step[k];
        const std::uint32_t yz[4] = {(kOne - wy) * (kOne - wz), wy * (kOne - wz), (kOne - wy) * wz, wy * wz};
        const auto value = static_cast<std::uint64_t>(pixels[x] + kOffset);
        for (std::size_t c = 0; c < 4; ++c) {
          const std::uint32_t high = yz[c] * wx;
          const std::uint32_t low = (yz[c] << kFractionBits) - high;
          total[2 * c] += low;
          total[2 * c + 1] += high;
          sum[2 * c] += low * value;
          sum[2 * c + 1] += high * value;
        }
      }
      for (std::size_t c = 0; c < 8; ++c) {
        if (total[c] == 0) continue;
        Cell& cell = cells_.get()[index + static_cast<std::int64_t>(c & 1) + (c & 2 ? strides_[1] : 0) +
                                  (c & 4 ? strides_[2] : 0) + strides_[0] + strides_[1] + strides_[2]];
        if constexpr (std::is_same_v<Cell, LinearFrameCell>) {
          if (cell.frame != static_cast<std::uint32_t>(frame)) {
            const std::uint32_t kept = latest ? 0 : above(cell);
            cell = {0, 0, static_cast<std::uint32_t>(frame), kept};
          }
        }
        cell.sum += sum[c];
        cell.weight += total[c];
      }
    });
  }

  std::array<std::int64_t, 3> strides_ = {};
  std::unique_ptr<Cell, Free> cells_;
  std::size_t count_ = 0;
  std::uint64_t frames_ = 0;
  double possible_count_ = 0.0;
};

template <typename Pixel, typename Cell>
std::unique_ptr<Reconstruction::Cells> make_cells(const VoxelGrid& grid) {
  auto cells = std::make_unique<TypedCells<Pixel, Cell>>();
  cells->grid = grid;
  cells->allocate();
  return cells;
}

template <typename Pixel>
std::unique_ptr<Reconstruction::Cells> make_cells(const VoxelGrid& grid, const ReconstructOptions& options) {
  const bool mean = options.compounding == Compounding::kMean;
  if (options.insertion == Insertion::kLinear) {
    return mean ? make_cells<Pixel, LinearMeanCell>(grid) : make_cells<Pixel, LinearFrameCell>(grid);
  }
  if (options.compounding == Compounding::kMax) return make_cells<Pixel, MaxCell>(grid);
  return mean ? make_cells<Pixel, MeanCell>(grid) : make_cells<Pixel, LatestCell>(grid);
}

}  // namespace

std::size_t cell_bytes(const ReconstructOptions& options) {
  const bool mean = options.compounding == Compounding::kMean;
  if (options.insertion == Insertion::kLinear) return mean ? sizeof(LinearMeanCell) : sizeof(LinearFrameCell);
  if (options.compounding == Compounding::kMax) return sizeof(MaxCell);
  return mean ? sizeof(MeanCell) : sizeof(LatestCell);
}

std::unique_ptr<Reconstruction::Cells> make_cells(int pixel_type, const VoxelGrid& grid,
                                                  const ReconstructOptions& options) {
  switch (pixel_type) {
    case CV_8UC1:
      return make_cells<std::uint8_t>(grid, options);
    case CV_8SC1:
      return make_cells<std::int8_t>(grid, options);
    case CV_16UC1:
      return make_cells<std::uint16_t>(grid, options);
    case CV_16SC1:
      return make_cells<std::int16_t>(grid, options);
    default:
      throw Error("voxel arrays are made of grey images of 8 or 16 bits; convert the recording first");
  }
}

}  // namespace fathom
