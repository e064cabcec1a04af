#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "core/random.h"
#include "surface/layer_mesh.h"
#include "surface/layer_mesher.h"
#include "surface/sampled_layer.h"

// Fields sampled on stacks of layers, and their meshes.
namespace fathom::fields {

using Field = std::function<double(const Eigen::Vector3d&)>;

/// Where a stack lies: `steps` are those of columns, rows and layers.
struct Place {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Matrix3d steps = Eigen::Matrix3d::Identity();
};

/// The regular lattice of a layer distance about the origin.
inline Place around_origin(Lattice lattice, double spacing, int columns, int rows, int layers) {
  Place place;
  place.steps = spacing * Eigen::Matrix3d::Identity();
  if (lattice == Lattice::kBodyCentred) place.steps(0, 0) = std::numbers::sqrt2 * spacing;
  // Half a column for the shifted rows, and a little more, so that nothing is symmetric.
  place.origin = -0.5 * (place.steps * Eigen::Vector3d(columns - 0.5, rows - 1, layers - 1)) +
                 spacing * Eigen::Vector3d(0.037, 0.021, 0.043);
  return place;
}

inline Eigen::Vector3d sample_place(const Place& place, Lattice lattice, int column, int row, int layer) {
  const double shift = lattice == Lattice::kBodyCentred && (row + layer) % 2 != 0 ? 0.5 : 0.0;
  return place.origin + place.steps * Eigen::Vector3d(column + shift, row, layer);
}

inline std::vector<SampledLayer> sampled(const Field& field, Lattice lattice, const Place& place, int columns, int rows,
                                         int layers) {
  std::vector<SampledLayer> stack(static_cast<std::size_t>(layers));
  for (int k = 0; k < layers; ++k) {
    SampledLayer& layer = stack[static_cast<std::size_t>(k)];
    layer.columns = columns;
    layer.rows = rows;
    layer.origin = place.origin + k * place.steps.col(2);
    layer.column_step = place.steps.col(0);
    layer.row_step = place.steps.col(1);
    layer.values.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        layer.values.push_back(static_cast<float>(field(sample_place(place, lattice, i, j, k))));
      }
    }
  }
  return stack;
}

/// A lattice of a layer distance that reaches at least `reach` from the origin along every axis.
inline std::vector<SampledLayer> sampled_within(const Field& field, Lattice lattice, double spacing,
                                                const Eigen::Vector3d& reach) {
  const double column = (lattice == Lattice::kBodyCentred ? std::numbers::sqrt2 : 1.0) * spacing;
  const auto count = [](double length, double step) { return 3 + static_cast<int>(std::ceil(2.0 * length / step)); };
  const int columns = count(reach.x(), column);
  const int rows = count(reach.y(), spacing);
  const int layers = count(reach.z(), spacing);
  return sampled(field, lattice, around_origin(lattice, spacing, columns, rows, layers), columns, rows, layers);
}

inline std::vector<const SampledLayer*> pointers(const std::vector<SampledLayer>& stack) {
  std::vector<const SampledLayer*> result;
  for (const SampledLayer& layer : stack) result.push_back(&layer);
  return result;
}

inline Mesh meshed(const std::vector<SampledLayer>& stack, const MesherOptions& options) {
  return join(mesh_layers(pointers(stack), 0, static_cast<int>(stack.size()), options));
}

inline Mesh meshed(const std::vector<SampledLayer>& stack, Mesher mesher) {
  MesherOptions options;
  options.mesher = mesher;
  return meshed(stack, options);
}

/// Makes all samples at the border of the stack negative.
inline void close_border(std::vector<SampledLayer>& stack) {
  for (std::size_t k = 0; k < stack.size(); ++k) {
    SampledLayer& layer = stack[k];
    const bool end = k == 0 || k + 1 == stack.size();
    for (int j = 0; j < layer.rows; ++j) {
      for (int i = 0; i < layer.columns; ++i) {
        if (!end && j > 0 && j + 1 < layer.rows && i > 0 && i + 1 < layer.columns) continue;
        float& value = layer.values[static_cast<std::size_t>(j * layer.columns + i)];
        value = std::min(value, -0.5F - std::abs(value));
      }
    }
  }
}

/// Kinds of random fields, each harder for topology than the one before.
inline constexpr int kRandomKinds = 6;

/// A random field of a kind on a small stack of random size; the same for the same seed.
inline std::vector<SampledLayer> random_stack(int kind, Lattice lattice, std::uint64_t seed) {
  Random random(seed);
  const auto count = [&random](int low, int high) {
    return low + static_cast<int>(random.uniform() * static_cast<double>(high - low + 1));
  };
  const int columns = count(5, 9), rows = count(5, 11), layers = count(5, 11);
  const Place place = around_origin(lattice, 1.0, columns, rows, layers);
  const auto point = [&random](double reach) {
    return Eigen::Vector3d(random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach));
  };
  switch (kind % kRandomKinds) {
    case 0: {  // sums of blobs
      std::vector<Eigen::Vector4d> blobs;
      for (int i = count(3, 9); i > 0; --i) {
        blobs.emplace_back(0, 0, 0, random.uniform(-1.0, 1.5));
        blobs.back().head<3>() = point(4.0);
      }
      return sampled(
          [&](const Eigen::Vector3d& p) {
            double sum = -0.3;
            for (const auto& blob : blobs) sum += blob.w() * std::exp(-0.4 * (p - blob.head<3>()).squaredNorm());
            return sum;
          },
          lattice, place, columns, rows, layers);
    }
    case 1:  // white noise
      return sampled([&](const Eigen::Vector3d&) { return random.normal() + random.uniform(-0.5, 0.5); }, lattice,
                     place, columns, rows, layers);
    case 2: {  // thin sheets, less than a layer thick, with ripples
      const Eigen::Vector3d normal = point(1.0).normalized();
      const double thickness = random.uniform(0.1, 0.9);
      const Eigen::Vector3d wave = point(2.0);
      return sampled(
          [&](const Eigen::Vector3d& p) { return thickness - std::abs(normal.dot(p) + 0.6 * std::sin(wave.dot(p))); },
          lattice, place, columns, rows, layers);
    }
    case 3: {  // checkerboards with some noise
      const int size = count(1, 2);
      const double noise = random.uniform(0.0, 1.2);
      int n = 0;
      return sampled(
          [&](const Eigen::Vector3d&) {
            const int i = n % columns, j = n / columns % rows, k = n / (columns * rows);
            ++n;
            return (((i / size + j / size + k / size) % 2 == 0) ? 1.0 : -1.0) + noise * random.normal();
          },
          lattice, place, columns, rows, layers);
    }
    case 4:  // few whole values, so that many samples lie exactly at the threshold and many cuts in the middle
      return sampled([&](const Eigen::Vector3d&) { return std::floor(random.uniform(-2.0, 2.0)); }, lattice, place,
                     columns, rows, layers);
    default: {  // smooth, plus noise, of values that differ by many orders
      const Eigen::Vector3d wave = point(1.5);
      return sampled(
          [&](const Eigen::Vector3d& p) {
            return (std::sin(wave.dot(p)) + 0.7 * random.normal()) * std::pow(10.0, random.uniform(-6.0, 6.0));
          },
          lattice, place, columns, rows, layers);
    }
  }
}

}  // namespace fathom::fields
