#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/error.h"
#include "core/numbers.h"
#include "surface/field_rows.h"

namespace fathom {

namespace {

// Where samples lie between the voxels along one axis.
struct AxisPlaces {
  std::vector<std::int32_t> below;  // the voxel before
  std::vector<double> weight;       // of the one behind it
};

AxisPlaces axis_places(int count, double first, double step, int voxels) {
  AxisPlaces places;
  for (int i = 0; i < count; ++i) {
    // Samples that are meant to lie on voxels do, whatever the rounding.
    constexpr double kOnVoxel = 1e-9;
    double at = std::clamp(first + i * step, 0.0, voxels - 1.0);
    const double nearest = std::round(at);
    if (std::abs(at - nearest) < kOnVoxel * voxels) at = nearest;
    const int below = std::min(static_cast<int>(at), voxels - 2);
    places.below.push_back(below);
    places.weight.push_back(at - below);
  }
  return places;
}

template <typename T>
class VolumeRows : public FieldRows {
 public:
  // Wide enough for the voxels' own digits.
  using Real = std::conditional_t<std::is_same_v<T, std::int32_t> || std::is_same_v<T, double>, double, float>;

  VolumeRows(const Volume& volume, const LatticeLayout& layout, const IsosurfaceOptions& options)
      : voxels_(volume.voxels),
        reference_from_voxel_(volume.reference_from_voxel),
        sign_(options.inside_below ? Real{-1} : Real{1}),
        value_(static_cast<Real>(options.value)) {
    const Eigen::Vector3d spacing_mm = voxel_spacing_mm(volume);
    const Eigen::Vector3d step = layout.step_mm.cwiseQuotient(spacing_mm);
    for (std::size_t shifted = 0; shifted < 2; ++shifted) {
      const AxisPlaces columns = axis_places(
          layout.columns, step.x() * first_column(options.mesher.lattice(), shifted != 0), step.x(), size(2));
      column_[shifted] = columns.below;
      column_weight_[shifted].assign(columns.weight.begin(), columns.weight.end());
    }
    rows_ = axis_places(layout.rows, 0.0, step.y(), size(1));
    slices_ = axis_places(layout.layers, 0.0, step.z(), size(0));
  }

  void sample(const LatticeRow& row, std::span<float> values) const override {
    struct Part {
      const T* voxels;
      Real weight;
    };
    std::array<Part, 4> parts;
    std::size_t count = 0;
    const auto j = static_cast<std::size_t>(row.row);
    const auto k = static_cast<std::size_t>(row.layer);
    for (int up = 0; up < 2; ++up) {
      const double slice_weight = up != 0 ? slices_.weight[k] : 1.0 - slices_.weight[k];
      for (int down = 0; down < 2; ++down) {
        const double weight = slice_weight * (down != 0 ? rows_.weight[j] : 1.0 - rows_.weight[j]);
        if (weight == 0.0) continue;
        parts[count++] = {voxels_.ptr<T>(slices_.below[k] + up, rows_.below[j] + down), static_cast<Real>(weight)};
      }
    }
    if (count == 1) return interpolate(parts[0].voxels, row.shifted, values);
    std::vector<Real> blended(static_cast<std::size_t>(size(2)), Real{0});
    for (const Part& part : std::span(parts).first(count)) {
      for (std::size_t i = 0; i < blended.size(); ++i) {
        blended[i] += part.weight * static_cast<Real>(part.voxels[i]);
      }
    }
    interpolate(blended.data(), row.shifted, values);
  }

  std::string fault_at(const LatticeRow& row, int column) const override {
    const int i = column_[row.shifted ? 1 : 0][static_cast<std::size_t>(column)];
    const int j = rows_.below[static_cast<std::size_t>(row.row)];
    const int k = slices_.below[static_cast<std::size_t>(row.layer)];
    Eigen::Vector3i voxel(i, j, k);
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3i at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
      if (std::isfinite(static_cast<double>(voxels_.at<T>(at.z(), at.y(), at.x())))) continue;
      voxel = at;
      break;
    }
    const Eigen::Vector3d place = reference_from_voxel_ * voxel.cast<double>();
    return "voxel (" + std::to_string(voxel.x()) + ", " + std::to_string(voxel.y()) + ", " + std::to_string(voxel.z()) +
           ") at (" + format_real(place.x()) + ", " + format_real(place.y()) + ", " + format_real(place.z()) +
           ") mm is not a finite number; replace such voxels";
  }

  std::pair<double, double> value_range() const override {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (int k = 0; k < size(0); ++k) {
      for (int j = 0; j < size(1); ++j) {
        const T* row = voxels_.ptr<T>(k, j);
        const auto [least, most] = std::minmax_element(row, row + size(2));
        low = std::min(low, static_cast<double>(*least));
        high = std::max(high, static_cast<double>(*most));
      }
    }
    return {low, high};
  }

 private:
  int size(int axis) const { return voxels_.size[axis]; }

  template <typename Voxel>
  void interpolate(const Voxel* voxels, bool shifted, std::span<float> values) const {
    const std::int32_t* below = column_[shifted ? 1 : 0].data();
    const Real* weights = column_weight_[shifted ? 1 : 0].data();
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Real first = static_cast<Real>(voxels[below[i]]);
      const Real second = static_cast<Real>(voxels[below[i] + 1]);
      // This form gives the voxels themselves at both ends.
      const Real inside_by = sign_ * ((Real{1} - weights[i]) * first + weights[i] * second - value_);
      if constexpr (std::is_same_v<Real, float>) {
        values[i] = inside_by;
      } else {
        values[i] = std::isfinite(inside_by) ? to_sample(inside_by) : std::numeric_limits<float>::quiet_NaN();
      }
    }
  }

  cv::Mat voxels_;
  Eigen::Affine3d reference_from_voxel_;
  Real sign_;
  Real value_;
  std::array<std::vector<std::int32_t>, 2> column_;  // of rows that are not shifted, and of those that are
  std::array<std::vector<Real>, 2> column_weight_;
  AxisPlaces rows_;
  AxisPlaces slices_;
};

}  // namespace

Eigen::Vector3d voxel_spacing_mm(const Volume& volume) {
  const cv::Mat& voxels = volume.voxels;
  if (voxels.dims != 3 || voxels.channels() != 1 || voxels.depth() > CV_64F) {
    throw Error("the voxels are not single numbers in three dimensions; give a volume with one channel");
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (voxels.size[axis] < 2) {
      throw Error("the volume is " + std::to_string(voxels.size[2]) + " x " + std::to_string(voxels.size[1]) + " x " +
                  std::to_string(voxels.size[0]) + " voxels; a surface needs at least two along each axis");
    }
  }
  const Eigen::Matrix3d linear = volume.reference_from_voxel.linear();
  const Eigen::Vector3d spacing_mm = linear.colwise().norm().transpose();
  constexpr double kFlat = 1e-6;
  if (!volume.reference_from_voxel.matrix().allFinite() || !(spacing_mm.minCoeff() > 0.0) ||
      std::abs((linear * spacing_mm.cwiseInverse().asDiagonal()).determinant()) < kFlat) {
    throw Error("the volume's axes span no space; mend the directions and spacings in its header");
  }
  return spacing_mm;
}

std::unique_ptr<FieldRows> volume_rows(const Volume& volume, const LatticeLayout& layout,
                                       const IsosurfaceOptions& options) {
  switch (volume.voxels.depth()) {
    case CV_8U:
      return std::make_unique<VolumeRows<std::uint8_t>>(volume, layout, options);
    case CV_8S:
      return std::make_unique<VolumeRows<std::int8_t>>(volume, layout, options);
    case CV_16U:
      return std::make_unique<VolumeRows<std::uint16_t>>(volume, layout, options);
    case CV_16S:
      return std::make_unique<VolumeRows<std::int16_t>>(volume, layout, options);
    case CV_32S:
      return std::make_unique<VolumeRows<std::int32_t>>(volume, layout, options);
    case CV_32F:
      return std::make_unique<VolumeRows<float>>(volume, layout, options);
    default:
      return std::make_unique<VolumeRows<double>>(volume, layout, options);
  }
}

}  // namespace fathom
