#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "exam/document.h"
#include "exam/job.h"
#include "registration/reslice.h"

namespace fathom {

/// A plane through the recording, as it is looked at: reference coordinates, mm.
struct CutPlane {
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::UnitX();  ///< unit vectors, perpendicular
  Eigen::Vector3d down = Eigen::Vector3d::UnitY();
  double width_mm = 1.0;
  double height_mm = 1.0;

  Eigen::Vector3d normal() const { return right.cross(down); }
  Eigen::Vector3d at(double right_mm, double down_mm) const { return centre_mm + right_mm * right + down_mm * down; }
  bool operator==(const CutPlane&) const = default;
};

/// The part of the line in which another plane cuts this one that lies in its picture: two points, in millimetres to
/// the right and down from the picture's centre. Empty where it does not cross it.
std::optional<std::array<Eigen::Vector2d, 2>> crossing(const CutPlane& plane, const Eigen::Vector3d& normal,
                                                       const Eigen::Vector3d& point_mm);

/// Planes through the shown recording, and their pictures, made beside the frame.
class ResliceViews {
 public:
  static constexpr std::size_t kCount = 2;

  struct View {
    CutPlane plane;
    cv::Mat rgba;              ///< empty until it is made
    std::uint64_t number = 0;  ///< grows with every new picture
    std::string error;
  };

  /// Two planes through the middle of the recording's frames: along the sweep and depth, and across the depth.
  void reset(const Document& document, int recording);
  /// Once a frame: starts what is to be made.
  void update(const Document& document, int recording, Worker& worker);

  const View& view(std::size_t index) const { return views_[index]; }
  void move(std::size_t index, const CutPlane& plane) { views_[index].plane = plane; }
  bool ready() const { return scan_ != nullptr; }

 private:
  void start(std::size_t index, const Document& document, Worker& worker);

  std::array<View, kCount> views_;
  std::array<CutPlane, kCount> asked_;
  std::array<std::uint64_t, 2> made_of_{};  // placement and division
  std::shared_ptr<const Scan> scan_;
  int recording_ = -1;
  std::shared_ptr<const Reslicer> reslicer_;
  std::shared_ptr<const SpacePartition> partition_;
  double spacing_mm_ = 1.0;
  std::uint64_t pictures_ = 0;
};

}  // namespace fathom
