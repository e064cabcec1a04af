#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "measurement/section_gap.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"
#include "surface/layer_mesher.h"
#include "surface/mesh.h"

namespace fathom {

/// By how many sections the space between two of them is interpolated.
enum class GapOrder {
  kLinear,  ///< the two: what is round comes out a little too small
  kCurved   ///< those beyond them as well, by CurvedGap: second order; not with Guide::kCentroids
};

/// How the surface of a structure is made from its contours.
struct ContourSurfaceOptions {
  Guide guide = Guide::kDiscs;
  /// Empty: curved, but linear with Guide::kCentroids.
  std::optional<GapOrder> order;
  MesherOptions mesher;
  /// Distance of the layers of samples and of the rows in them. Empty: an eightieth of the structure's largest extent,
  /// to two digits.
  std::optional<double> spacing_mm;

  /// The order that is meant.
  GapOrder gap_order() const;

  /// Throws Error when the spacing is not a positive, finite number, or guide and order do not go together.
  void check() const;
};

/// The surface of one structure through its contours on frames that need not be parallel, kept up to date while
/// contours are edited. Treece 2000, sections 3.2 and 3.4.
///
/// Between each two successive outlined frames lies a lattice of samples that starts and ends on the frames' own
/// planes, with an even number of layers (figure 3.22), so that an edited, added or removed contour moves no other
/// lattice: only what lies between it and its neighbours (of second order, and their neighbours) is made again, and the
/// result equals, vertex for vertex, the surface made from scratch. The first and last outlined frames close the
/// surface by flat caps. A frame that is marked absent ends the structure half-way to its neighbour; such marks before
/// the first and behind the last outline are passed over.
///
/// Regions that the sweep passed backward have sweep sign -1 (equation (3.12)).
class ContourSurface {
 public:
  /// More samples than these, 1 GB, are refused.
  static constexpr std::int64_t kMaxSamples = std::int64_t{1} << 28;

  /// Frames are where `locator` says. Nothing is made yet. Throws Error as options.check.
  ContourSurface(const FrameLocator& locator, const ContourSurfaceOptions& options);
  ~ContourSurface();
  ContourSurface(ContourSurface&& other) noexcept;
  ContourSurface& operator=(ContourSurface&& other) noexcept;

  /// Makes the surface of `structure`, from what is the same as in the update before. When it throws, the surface stays
  /// what it was. Throws Error as frame_marks does; for fewer than two outlined frames with a known pose, or none with
  /// an area; for two on the same plane or turned away from each other; for a spacing too fine for memory, with one
  /// that fits; Cancelled.
  const Mesh& update(const Structure& structure, const Progress& progress = {});

  /// Of the last update; empty before the first.
  const Mesh& mesh() const;
  /// Frames left out, regions passed backward, ...
  const std::vector<std::string>& warnings() const;
  /// The enclosed volume, what was passed backward counted negative; empty where planimetry has none either
  /// (measure_planimetry): in a rotational sweep.
  std::optional<double> volume_ml() const;
  /// As given, or as chosen at the first update and kept since; 0 before.
  double spacing_mm() const;
  /// The layers of samples, and how many of them the last update had to make.
  int layers() const;
  int layers_made() const;

 private:
  class Maker;
  std::unique_ptr<Maker> maker_;
};

}  // namespace fathom
