#include "segmentation/morphology.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"

namespace fathom {

namespace {

/// The pixels of a disc in a slice, as many on either side of its centre. Columns and rows that cannot meet another
/// pixel of the slice are left out.
cv::Mat disc(const Volume& volume, double radius_mm) {
  const Eigen::Vector3d along_row = volume.reference_from_voxel.linear().col(0);
  const Eigen::Vector3d along_column = volume.reference_from_voxel.linear().col(1);
  // A pixel whose centre lies on the circle belongs to the disc, whatever rounding makes of its distance.
  const double limit_mm = radius_mm * (1.0 + 1e-12);
  // How far the ellipse reaches along an axis: the radius over the distance of that axis's lines.
  const double area = along_row.cross(along_column).norm();
  const auto reach = [&](const Eigen::Vector3d& other, int pixels) {
    return static_cast<int>(std::min(std::floor(limit_mm * other.norm() / area), pixels - 1.0));
  };
  const int reach_x = reach(along_column, volume.voxels.size[2]);
  const int reach_y = reach(along_row, volume.voxels.size[1]);
  cv::Mat element(2 * reach_y + 1, 2 * reach_x + 1, CV_8U);
  for (int y = -reach_y; y <= reach_y; ++y) {
    for (int x = -reach_x; x <= reach_x; ++x) {
      element.at<uchar>(y + reach_y, x + reach_x) = (x * along_row + y * along_column).norm() <= limit_mm ? 1 : 0;
    }
  }
  return element;
}

void check(const Volume& volume, double radius_mm) {
  if (!(radius_mm > 0.0) || !std::isfinite(radius_mm)) {
    throw Error("morphology: the radius of the disc must be finite and greater than 0 mm");
  }
  const cv::Mat& voxels = volume.voxels;
  constexpr std::array<int, 6> kDepths = {CV_8U, CV_8S, CV_16U, CV_16S, CV_32F, CV_64F};
  if (voxels.dims != 3 || voxels.empty() || voxels.channels() != 1 ||
      std::find(kDepths.begin(), kDepths.end(), voxels.depth()) == kDepths.end()) {
    throw Error("morphology: needs voxels of one channel, of integers of 8 or 16 bits, float or double");
  }
  const Eigen::Matrix3d axes = volume.reference_from_voxel.linear();
  if (!axes.allFinite() || !(axes.col(0).cross(axes.col(1)).norm() > 0.0)) {
    throw Error("morphology: the pixels of the volume's slices have no area");
  }
}

Volume each_slice(const Volume& volume, double radius_mm, cv::MorphTypes operation) {
  check(volume, radius_mm);
  const cv::Mat element = disc(volume, radius_mm);
  Volume result = {volume.voxels.clone(), volume.reference_from_voxel};
  const cv::Mat& voxels = result.voxels;
  cv::parallel_for_(cv::Range(0, voxels.size[0]), [&](const cv::Range& slices) {
    for (int slice = slices.start; slice < slices.end; ++slice) {
      cv::Mat image(voxels.size[1], voxels.size[2], voxels.type(), result.voxels.ptr(slice), voxels.step[1]);
      if (image.depth() != CV_8S) {
        cv::morphologyEx(image, image, operation, element);
        continue;
      }
      // OpenCV has no morphology of signed bytes.
      cv::Mat wide;
      image.convertTo(wide, CV_16S);
      cv::morphologyEx(wide, wide, operation, element);
      wide.convertTo(image, CV_8S);
    }
  });
  return result;
}

}  // namespace

Volume open_slices(const Volume& volume, double radius_mm) { return each_slice(volume, radius_mm, cv::MORPH_OPEN); }

Volume close_slices(const Volume& volume, double radius_mm) { return each_slice(volume, radius_mm, cv::MORPH_CLOSE); }

}  // namespace fathom
