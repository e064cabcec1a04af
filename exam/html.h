#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace fathom {

/// A text as it stands in HTML, whatever characters it holds.
std::string html_text(std::string_view text);

/// Rows as a table, the first as its head. What is in the cells is made safe here.
std::string html_table(const std::vector<std::vector<std::string>>& rows);

/// A picture inside of the page. 8-bit BGR or grey.
std::string html_picture(const cv::Mat& picture, std::string_view description);

/// RFC 4648.
std::string base64(std::span<const unsigned char> bytes);

}  // namespace fathom
