#include "exam/html.h"

#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/html.h"

namespace fathom {

std::string html_picture(const cv::Mat& picture, std::string_view description) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", picture, bytes)) throw Error("no PNG can be made of a picture of the report; try again");
  return html_image("image/png", bytes, description);
}

}  // namespace fathom
