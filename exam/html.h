#pragma once

#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace fathom {

/// A picture inside of the page. 8-bit BGR or grey.
std::string html_picture(const cv::Mat& picture, std::string_view description);

}  // namespace fathom
