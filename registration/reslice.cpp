#include "registration/reslice.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "registration/reslice_pass.h"
#include "registration/reslice_pixels.h"
#include "registration/voxel_grid.h"

namespace fathom {

namespace {

constexpr double kTypicalGaps = 4.0;  // wider than so many typical gaps is a hole
constexpr int kLayersAtOnce = 16;     // of a slab: their plans are held together
constexpr int kMeanBits = 8;          // of a grey level, where values are added up

cv::Mat mask_of(cv::Size image_size, const cv::Rect& used, const std::optional<Fan>& fan) {
  if (!fan) return {};
  const PixelArea area = pixel_area(image_size, used, fan);
  cv::Mat mask = cv::Mat::zeros(used.size(), CV_8U);
  for (int y = 0; y < used.height; ++y) {
    for (const PixelSpan& span : area.rows[static_cast<std::size_t>(y + used.y)]) {
      mask.row(y).colRange(span.first - used.x, span.end - used.x) = 1;
    }
  }
  return mask;
}

// What the layers of a slab have added up to at one pixel.
struct Sum {
  std::int64_t total = 0;  // in 2^-kMeanBits
  std::int64_t count = 0;
};

// Colours a picture from batches of frames.
class Painter {
 public:
  virtual ~Painter() = default;
  virtual void paint(const ReslicePass& pass, int batch, const std::vector<cv::Mat>& images) = 0;
  virtual void finish() {}
};

template <typename Pixel>
class TypedPainter : public Painter {
 public:
  TypedPainter(const ResliceFrames& frames, const NearFrames& near, ResliceMode mode, bool slab, Resliced& out)
      : frames_(frames),
        near_(near),
        nearest_(mode == ResliceMode::kMax || (mode == ResliceMode::kNearest && !slab)),
        slab_(slab),
        out_(out) {
    if (slab && !nearest_) sums_.resize(out.picture.total());
  }

  void paint(const ReslicePass& pass, int batch, const std::vector<cv::Mat>& images) override {
    typename RowPixels<Pixel>::Images pixels(images.size());
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (!images[i].empty()) pixels[i].emplace(images[i], frames_);
    }
    const cv::Range rows(0, out_.picture.rows);
    cv::parallel_for_(
        rows,
        [&](const cv::Range& range) {
          RowFunctions functions;
          RowPixels<Pixel> found(out_.picture.cols);
          std::vector<std::int32_t> values(static_cast<std::size_t>(out_.picture.cols));
          for (int v = range.start; v < range.end; ++v) {
            for (int layer = 0; layer < pass.layers(); ++layer) {
              const auto runs = pass.runs(v, layer, batch);
              if (runs.empty()) continue;
              functions.set(near_, pass.row(v, layer), pass.first_frame(batch), pass.end_frame(batch));
              for (const ResliceRun& run : runs) {
                nearest_ ? found.find_nearest(functions, run, pixels) : found.find_linear(functions, run, pixels);
              }
              for (const ResliceRun& run : runs) {
                paint_run(found, run, v, pixels[static_cast<std::size_t>(run.frame)]->stride, values.data());
              }
            }
          }
        },
        row_stripes());
  }

  void finish() override {
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      if (sums_[i].count == 0) continue;
      const std::int64_t ones = sums_[i].count << kMeanBits;
      // Rounded half up, below 0 as well.
      const std::int64_t doubled = 2 * sums_[i].total + ones;
      std::int64_t mean = doubled / (2 * ones);
      if (doubled % (2 * ones) < 0) --mean;
      out_.picture.ptr<Pixel>()[i] = static_cast<Pixel>(mean);
    }
  }

 private:
  void paint_run(const RowPixels<Pixel>& found, const ResliceRun& run, int v, std::ptrdiff_t stride,
                 std::int32_t* values) {
    Pixel* const picture = out_.picture.ptr<Pixel>(v) + run.first;
    std::uint8_t* const covered = out_.covered.ptr<std::uint8_t>(v) + run.first;
    const int length = run.end - run.first;
    if (!slab_) {
      nearest_ ? found.nearest(run, picture) : found.template linear<0>(run, stride, picture);
    } else if (nearest_) {
      found.nearest(run, values);
      for (int k = 0; k < length; ++k) {
        const auto pixel = static_cast<Pixel>(values[k]);
        picture[k] = covered[k] != 0 ? std::max(picture[k], pixel) : pixel;
      }
    } else {
      found.template linear<kMeanBits>(run, stride, values);
      Sum* const sums = sums_.data() + static_cast<std::ptrdiff_t>(v) * out_.picture.cols + run.first;
      for (int k = 0; k < length; ++k) {
        sums[k].total += values[k];
        ++sums[k].count;
      }
    }
    std::fill_n(covered, length, std::uint8_t{255});
  }

  const ResliceFrames& frames_;
  const NearFrames& near_;
  const bool nearest_;
  const bool slab_;
  Resliced& out_;
  std::vector<Sum> sums_;
};

std::unique_ptr<Painter> make_painter(int type, const ResliceFrames& frames, const NearFrames& near, ResliceMode mode,
                                      bool slab, Resliced& out) {
  switch (CV_MAT_DEPTH(type)) {
    case CV_8U:
      return std::make_unique<TypedPainter<std::uint8_t>>(frames, near, mode, slab, out);
    case CV_8S:
      return std::make_unique<TypedPainter<std::int8_t>>(frames, near, mode, slab, out);
    case CV_16U:
      return std::make_unique<TypedPainter<std::uint16_t>>(frames, near, mode, slab, out);
    default:
      return std::make_unique<TypedPainter<std::int16_t>>(frames, near, mode, slab, out);
  }
}

std::vector<double> layers_of(double thickness_mm, double spacing_mm) {
  const int count = std::max(1, static_cast<int>(std::ceil(thickness_mm / spacing_mm)));
  std::vector<double> layers_mm;
  for (int i = 0; i < count; ++i) layers_mm.push_back(((i + 0.5) / count - 0.5) * thickness_mm);
  return layers_mm;
}

}  // namespace

void ReslicerOptions::check() const {
  if (max_gap_mm && !(*max_gap_mm > 0.0 && std::isfinite(*max_gap_mm))) {
    throw Error("the widest gap between frames must be above 0 mm");
  }
  if (!(max_frame_bytes > 0.0)) throw Error("the memory allowed must be positive");
  if (fan) fan->check();
}

void ResliceOptions::check(double spacing_mm) const {
  if (!(thickness_mm >= 0.0)) throw Error("the slice's thickness must not be negative");
  if (!(thickness_mm / spacing_mm <= kMaxLayers)) {
    throw Error("the slice is too thick for its spacing: it would have more than " + std::to_string(kMaxLayers) +
                " layers; choose a larger spacing");
  }
}

double Resliced::covered_share() const {
  return static_cast<double>(cv::countNonZero(covered)) / static_cast<double>(covered.total());
}

Reslicer::Reslicer(const Recording& recording, const FrameLocator& locator, const std::vector<Sweep>& sweeps,
                   const ReslicerOptions& options)
    : recording_(recording), max_frame_bytes_(options.max_frame_bytes) {
  options.check();
  require_grey_integers(recording);
  const cv::Size size(recording.header().width, recording.header().height);
  frames_.used = clipped(size, options.clip);
  frames_.mask = mask_of(size, frames_.used, options.fan);
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    const std::vector<PlacedFrame> placed = placed_frames(recording, locator, sweeps[s]);
    if (placed.empty()) {
      throw Error(recording.name() + ": no frame from " + std::to_string(sweeps[s].first) + " to " +
                  std::to_string(sweeps[s].last) + " has a valid image and pose; choose another sweep");
    }
    for (const PlacedFrame& frame : placed) frames_.frames.push_back({frame, s});
    frames_.max_gap_mm.push_back(options.max_gap_mm.value_or(kTypicalGaps * typical_gap_mm(placed, frames_.used)));
  }
  if (frames_.frames.empty()) {
    throw Error(recording.name() + ": no frame has a valid image and pose; nothing can be placed in space");
  }
}

Resliced Reslicer::reslice(const ResliceSurface& surface, const ResliceOptions& options,
                           const SpacePartition* partition, const Progress& progress) const {
  surface.check();
  options.check(surface.spacing_mm);
  if (partition != nullptr && partition->sweeps().size() != frames_.max_gap_mm.size()) {
    throw Error("the dividing planes are for " + std::to_string(partition->sweeps().size()) +
                " sweeps, and there are " + std::to_string(frames_.max_gap_mm.size()) + "; place them again");
  }
  const RecordingHeader& header = recording_.header();
  const cv::Size size(surface.columns, static_cast<int>(surface.rows.size()));
  Resliced made{cv::Mat::zeros(size, header.pixel_type), cv::Mat::zeros(size, CV_8U)};
  const NearFrames near = near_frames(frames_, surface, options.thickness_mm);
  const std::vector<double> layers_mm = layers_of(options.thickness_mm, surface.spacing_mm);
  const auto painter = make_painter(header.pixel_type, frames_, near, options.mode, layers_mm.size() > 1, made);

  const double frame_bytes = static_cast<double>(CV_ELEM_SIZE(header.pixel_type)) * header.width * header.height;
  const int batch_frames = std::max(1, static_cast<int>(std::min(max_frame_bytes_ / frame_bytes, 1e6)) - 1);
  for (std::size_t layer = 0; layer < layers_mm.size() && near.count() > 0; layer += kLayersAtOnce) {
    const auto first = layers_mm.begin() + static_cast<std::ptrdiff_t>(layer);
    const std::size_t count = std::min<std::size_t>(kLayersAtOnce, layers_mm.size() - layer);
    const auto fraction = [&](int batch, int batches) {
      return (static_cast<double>(layer) + static_cast<double>(count) * (batch + 1) / (batches + 1)) /
             static_cast<double>(layers_mm.size());
    };
    report(progress, static_cast<double>(layer) / static_cast<double>(layers_mm.size()));
    const ReslicePass pass(frames_, near, surface, {first, first + static_cast<std::ptrdiff_t>(count)}, partition,
                           batch_frames);
    std::vector<cv::Mat> images(static_cast<std::size_t>(near.count()));
    for (int batch = 0; batch < pass.batches(); ++batch) {
      for (int k = pass.first_frame(batch); k < pass.end_frame(batch); ++k) {
        const auto i = static_cast<std::size_t>(k);
        if (!pass.needed(k) || !images[i].empty()) continue;
        images[i] = recording_.image(frames_.frames[near.index[i]].placed.frame);
      }
      report(progress, fraction(batch, pass.batches()));
      painter->paint(pass, batch, images);
      for (int k = pass.first_frame(batch); k < pass.end_frame(batch) - 1; ++k) {
        images[static_cast<std::size_t>(k)].release();
      }
    }
  }
  painter->finish();
  if (surface.turned) {
    cv::transpose(made.picture, made.picture);
    cv::transpose(made.covered, made.covered);
  }
  report(progress, 1.0);
  return made;
}

}  // namespace fathom
