#include "surface/isosurface.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "core/numbers.h"
#include "surface/cut_layer.h"
#include "surface/field_rows.h"
#include "surface/lattice_layout.h"
#include "surface/vertex_normals.h"

namespace fathom {

namespace {

// What a surface may grow to, some gigabytes; only noise has one so large in a box that was let pass.
constexpr std::size_t kMostVertices = 50'000'000;

// Layers at a time, unless asked otherwise: few enough for samples and meshes to stay in the cache, which is worth more
// than what is worked out twice where batches meet.
constexpr int kFewestLayers = 8;
constexpr int kMostLayers = 16;
constexpr int kSamplesAtATime = 1 << 22;

// Makes values small enough for differences; returns whether one is not finite.
bool clean(std::span<float> values) {
  constexpr float kLargest = 1e30F;
  std::uint32_t large = 0;
  for (const float value : values) large |= std::abs(value) <= kLargest ? 0U : 1U;
  if (large == 0) return false;
  bool all_finite = true;
  for (float& value : values) {
    all_finite = all_finite && std::isfinite(value);
    value = std::clamp(value, -kLargest, kLargest);
  }
  return !all_finite;
}

// The layers of a lattice around those that are being meshed, each sampled once.
class LayerWindow {
 public:
  LayerWindow(const FieldRows& field, const LatticeLayout& layout, const Eigen::Affine3d& reference_from_lattice,
              const IsosurfaceOptions& options)
      : field_(field),
        layout_(layout),
        reference_from_lattice_(reference_from_lattice),
        centred_(options.mesher.lattice() == Lattice::kBodyCentred),
        border_rows_(options.cap ? 1 : 0),
        border_columns_(options.cap && !centred_ ? 1 : 0),
        stack_(static_cast<std::size_t>(layout.layers), nullptr) {}

  /// One for each layer; null where there is none now.
  std::span<const SampledLayer* const> stack() const { return stack_; }

  /// Makes layers from `first` to `last - 1` ready for the mesher. Both may only grow.
  void move_to(int first, int last) {
    sample_to(std::min(last, layout_.layers));
    for (; low_ < first; ++low_) {
      stack_[static_cast<std::size_t>(low_)] = nullptr;
      spare_.push_back(std::move(window_.front()));
      window_.pop_front();
    }
    for (; ready_ < last; ++ready_) stack_[static_cast<std::size_t>(ready_)] = &at(ready_);
  }

 private:
  SampledLayer& at(int k) { return window_[static_cast<std::size_t>(k - low_)]; }

  void sample_to(int last) {
    const int first = low_ + static_cast<int>(window_.size());
    for (int k = first; k < last; ++k) add_layer(k);
    if (first >= last) return;
    const int rows = layout_.rows;
    std::vector<std::uint8_t> faults(static_cast<std::size_t>(rows) * static_cast<std::size_t>(last - first), 0);
    cv::parallel_for_(cv::Range(0, static_cast<int>(faults.size())), [&](const cv::Range& range) {
      for (int r = range.start; r < range.end; ++r) {
        const LatticeRow row = lattice_row(first + r / rows, r % rows);
        const std::span<float> values = row_values(row);
        field_.sample(row, values);
        faults[static_cast<std::size_t>(r)] = clean(values) ? 1 : 0;
      }
    });
    const auto fault = std::find(faults.begin(), faults.end(), 1);
    if (fault == faults.end()) return;
    const int r = static_cast<int>(fault - faults.begin());
    const LatticeRow row = lattice_row(first + r / rows, r % rows);
    std::vector<float> values(static_cast<std::size_t>(layout_.columns));
    field_.sample(row, values);
    const auto column = std::find_if(values.begin(), values.end(), [](float value) { return !std::isfinite(value); });
    throw Error(field_.fault_at(row, static_cast<int>(column - values.begin())));
  }

  void add_layer(int k) {
    if (spare_.empty()) spare_.emplace_back();
    window_.push_back(std::move(spare_.back()));
    spare_.pop_back();
    SampledLayer& layer = window_.back();
    layer.columns = layout_.columns + 2 * border_columns_;
    layer.rows = layout_.rows + 2 * border_rows_;
    layer.flat_sides = centred_;
    layer.values.resize(static_cast<std::size_t>(layer.columns) * static_cast<std::size_t>(layer.rows));
    const double first = first_column(centred_ ? Lattice::kBodyCentred : Lattice::kCubic, false);
    layer.origin = reference_from_lattice_ * Eigen::Vector3d(first - border_columns_, -border_rows_, k);
    layer.column_step = reference_from_lattice_.linear().col(0);
    layer.row_step = reference_from_lattice_.linear().col(1);
    mark_border(layer);
  }

  // What closes the surface at the sides of the box: samples far outside.
  void mark_border(SampledLayer& layer) const {
    if (border_rows_ != 0) {
      std::fill_n(layer.values.begin(), layer.columns, kFarOutside);
      std::fill_n(layer.values.end() - layer.columns, layer.columns, kFarOutside);
    }
    for (int j = 0; border_columns_ != 0 && j < layer.rows; ++j) {
      const auto row = layer.values.begin() + static_cast<std::ptrdiff_t>(j) * layer.columns;
      row[0] = kFarOutside;
      row[layer.columns - 1] = kFarOutside;
    }
  }

  LatticeRow lattice_row(int layer, int row) const {
    return {row, layer, centred_ && ((row + border_rows_ + layer) & 1) != 0};
  }

  std::span<float> row_values(const LatticeRow& row) {
    SampledLayer& layer = at(row.layer);
    const auto begin = static_cast<std::size_t>(row.row + border_rows_) * static_cast<std::size_t>(layer.columns) +
                       static_cast<std::size_t>(border_columns_);
    return std::span(layer.values).subspan(begin, static_cast<std::size_t>(layout_.columns));
  }

  const FieldRows& field_;
  const LatticeLayout& layout_;
  const Eigen::Affine3d& reference_from_lattice_;
  bool centred_;
  int border_rows_;  // added on either side
  int border_columns_;
  int low_ = 0;  // number of the window's first layer
  int ready_ = 0;
  std::deque<SampledLayer> window_;
  std::vector<const SampledLayer*> stack_;
  std::vector<SampledLayer> spare_;  // kept for their memory
};

int batch_size(const LatticeLayout& layout, const IsosurfaceOptions& options) {
  if (options.batch_layers > 0) return options.batch_layers;
  const double layers = kSamplesAtATime / (static_cast<double>(layout.columns) * layout.rows);
  return static_cast<int>(std::clamp<double>(layers, kFewestLayers, kMostLayers));
}

// Room for a surface as large as the box's, so that one need not be moved as it grows; memory that is not used in the
// end is only promised.
void reserve_for_box(const LatticeLayout& layout, Mesh& mesh) {
  const auto columns = static_cast<std::size_t>(layout.columns);
  const auto rows = static_cast<std::size_t>(layout.rows);
  const auto layers = static_cast<std::size_t>(layout.layers);
  const std::size_t vertices = 2 * (columns * rows + rows * layers + layers * columns);
  mesh.vertices.reserve(vertices);
  mesh.normals.reserve(vertices);
  mesh.triangles.reserve(2 * vertices);
}

Error no_crossing(const FieldRows& field, double value) {
  const auto [low, high] = field.value_range();
  if (low < value && value < high) {
    return Error("no sample is beyond the value " + format_real(value) + ", although the values lie between " +
                 format_real(low) + " and " + format_real(high) + "; use a smaller spacing");
  }
  return Error("no value crosses " + format_real(value) + ": the values lie between " + format_real(low) + " and " +
               format_real(high) + "; choose a value between these");
}

Mesh mesh_field(const FieldRows& field, const LatticeLayout& layout, const Eigen::Affine3d& reference_from_lattice,
                const IsosurfaceOptions& options, const Progress& progress) {
  MesherOptions mesher = options.mesher;
  mesher.cap_ends = options.cap;
  mesher.cap_sides = options.cap;
  LayerWindow window(field, layout, reference_from_lattice, options);
  StackMesher meshes(window.stack(), mesher);
  Mesh mesh;
  reserve_for_box(layout, mesh);
  const int batch = batch_size(layout, options);
  for (int first = 0; first < layout.layers; first += batch) {
    report(progress, static_cast<double>(first) / layout.layers);
    const int last = first + std::min(batch, layout.layers - first);
    window.move_to(std::max(0, first - kLayerReach), std::min(last + kLayerReach, layout.layers));
    for (const LayerMesh& layer : meshes.mesh_to(last)) append(layer, mesh);
    if (mesh.vertices.size() > kMostVertices) {
      throw Error("the surface has more than " + std::to_string(kMostVertices) +
                  " vertices; use a larger spacing or a smoother field");
    }
  }
  if (mesh.triangles.empty()) throw no_crossing(field, options.value);
  if (reference_from_lattice.linear().determinant() < 0.0) {
    for (Mesh::Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  report(progress, 1.0);
  return mesh;
}

}  // namespace

void IsosurfaceOptions::check() const {
  if (!std::isfinite(value)) throw Error("the value on a surface must be a finite number; give another");
  if (spacing_mm && (!std::isfinite(*spacing_mm) || *spacing_mm <= 0.0)) {
    throw Error("the spacing must be a finite number above 0 mm; give another");
  }
  assert(batch_layers >= 0);
}

Mesh isosurface(const Volume& volume, const IsosurfaceOptions& options, const Progress& progress) {
  options.check();
  const Eigen::Vector3d voxel_mm = voxel_spacing_mm(volume);
  const cv::Mat& voxels = volume.voxels;
  const Eigen::Vector3d steps(voxels.size[2] - 1, voxels.size[1] - 1, voxels.size[0] - 1);
  const double spacing_mm = options.spacing_mm.value_or(voxel_mm.minCoeff());
  const LatticeLayout layout = lattice_layout(steps.cwiseProduct(voxel_mm), spacing_mm, options.mesher.lattice());
  const Eigen::Vector3d voxel_steps = layout.step_mm.cwiseQuotient(voxel_mm);
  return mesh_field(*volume_rows(volume, layout, options), layout,
                    volume.reference_from_voxel * Eigen::Scaling(voxel_steps), options, progress);
}

Mesh isosurface(const RowField& field, const Eigen::AlignedBox3d& box_mm, const IsosurfaceOptions& options,
                const Progress& progress) {
  options.check();
  if (!options.spacing_mm) throw Error("the surface of a function needs a spacing; give one");
  const Eigen::Vector3d extent_mm = box_mm.max() - box_mm.min();
  if (!extent_mm.allFinite() || !(extent_mm.minCoeff() > 0.0)) {
    throw Error("the box is empty or not finite; give lower bounds that are below the upper ones");
  }
  const LatticeLayout layout = lattice_layout(extent_mm, *options.spacing_mm, options.mesher.lattice());
  return mesh_field(*function_rows(field, box_mm.min(), layout, options), layout,
                    Eigen::Translation3d(box_mm.min()) * Eigen::Affine3d(Eigen::Scaling(layout.step_mm)), options,
                    progress);
}

Mesh isosurface(const PointField& field, const Eigen::AlignedBox3d& box_mm, const IsosurfaceOptions& options,
                const Progress& progress) {
  const RowField rows = [&](const Eigen::Vector3d& start_mm, const Eigen::Vector3d& step_mm, std::span<double> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = field(start_mm + static_cast<double>(i) * step_mm);
    }
  };
  return isosurface(rows, box_mm, options, progress);
}

void set_normals(Mesh& mesh, const std::function<Eigen::Vector3d(const Eigen::Vector3d& place_mm)>& outward) {
  if (mesh.normals.size() != mesh.vertices.size()) mesh.normals = vertex_normals(mesh);
  cv::parallel_for_(cv::Range(0, static_cast<int>(mesh.vertices.size())), [&](const cv::Range& range) {
    for (auto i = static_cast<std::size_t>(range.start); i < static_cast<std::size_t>(range.end); ++i) {
      const Eigen::Vector3d normal = outward(mesh.vertices[i]);
      const double length = normal.stableNorm();
      if (length > 0.0 && std::isfinite(length)) mesh.normals[i] = normal / length;
    }
  });
}

}  // namespace fathom
