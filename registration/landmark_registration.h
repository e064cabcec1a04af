#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fathom {

struct LandmarkOptions {
  double max_rms_mm = 5.0;       ///< landmarks that fit worse do not belong together
  double tolerance_mm = 5.0;     ///< by which distances of landmarks may differ when their order is looked for
  double min_off_line_mm = 2.0;  ///< rms distance from the line through landmarks; less leaves the turn about it open
  double min_share = 0.6;        ///< of the shorter list that must be matched

  void check() const;
};

/// A rigid motion that takes landmarks in one frame ("from") to the same in another ("to").
struct LandmarkRegistration {
  struct Pair {
    std::size_t from = 0;  ///< index into the list
    std::size_t to = 0;
    double distance_mm = 0.0;  ///< that is left between them
  };
  Eigen::Isometry3d to_from_from = Eigen::Isometry3d::Identity();
  double rms_mm = 0.0;      ///< of the distances
  double error_mm = 0.0;    ///< of one landmark and direction, as the distances tell: rms / sqrt(3 - 6/n)
  std::vector<Pair> pairs;  ///< in the order of `from`; landmarks that the other list lacks are not here
};

/// The most landmarks that match_landmarks takes in either list.
inline constexpr std::size_t kMaxUnorderedLandmarks = 12;

/// Least squares over landmarks that correspond as they are listed, without mirroring: the singular value decomposition
/// of Kabsch (1976) and Umeyama (1991). Both lists have the same length.
/// Throws Error when there are fewer than three, when they lie on a line, or when they do not fit, saying so if they
/// would as mirror images.
LandmarkRegistration register_landmarks(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to,
                                        const LandmarkOptions& options = {});

/// The same where the order is not known and either list may lack some: the assignment that matches most landmarks,
/// then the one with the least rms, of all whose mutual distances agree. Throws Error as above, when there are too
/// many, and when another assignment fits nearly as well but leads elsewhere (a symmetric layout).
LandmarkRegistration match_landmarks(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to,
                                     const LandmarkOptions& options = {});

}  // namespace fathom
