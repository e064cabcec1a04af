#include "exam/calibration_picture.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace fathom {
namespace {

CalibrationScan empty_scan() {
  return {ProbePoses("test.mha", std::vector<std::optional<Eigen::Isometry3d>>(10), {}), {900, 900}};
}

// Pixels of the left pane around a pixel of the image that are redder than blue: large errors.
int red_around(const cv::Mat& picture, double x_px, double y_px) {
  constexpr double kScale = 780.0 / 900.0;  // the pane less its margins, over the image
  const cv::Rect around(60 + static_cast<int>(kScale * x_px) - 15, 60 + static_cast<int>(kScale * y_px) - 15, 31, 31);
  int count = 0;
  for (int y = around.y; y < around.br().y; ++y) {
    for (int x = around.x; x < around.br().x; ++x) {
      const auto& pixel = picture.at<cv::Vec3b>(y, x);
      count += pixel[2] > pixel[0] + 60 && pixel[2] > pixel[1] + 60 ? 1 : 0;
    }
  }
  return count;
}

TEST(CalibrationPicture, LargeErrorsAreRedWhereTheyLieInTheImage) {
  std::vector<Residual> residuals;
  for (int i = 0; i < 9; ++i) {
    const double x = 100.0 + 350.0 * (i % 3);
    const double y = 100.0 + 350.0 * static_cast<int>(i / 3);
    residuals.push_back({i, {x, y}, "wire", i == 2 || i == 5 ? 1.0 : 0.1});
  }
  const cv::Mat picture = calibration_picture(empty_scan(), residuals, {"caption"});
  for (const Residual& residual : residuals) {
    const int red = red_around(picture, residual.position_px.x(), residual.position_px.y());
    EXPECT_EQ(red > 10, residual.distance_mm > 0.5) << red;
  }
}

TEST(CalibrationPicture, NothingToShowIsAnError) { EXPECT_THROW(calibration_picture(empty_scan(), {}, {}), Error); }

}  // namespace
}  // namespace fathom
