#include <filesystem>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/text_file.h"
#include "exam/report_picture.h"
#include "viewer/application.h"
#include "viewer/widgets.h"

namespace fathom {

// Of a pane that was drawn, or of the whole window; empty where it is too small.
cv::Mat Application::picture_of(const std::string& item) const {
  std::optional<cv::Rect> area;
  if (!item.empty()) {
    const auto found = ui::places().items.find(item);
    if (found == ui::places().items.end()) throw Error("'" + item + "' is not shown");
    const auto low = cv::Point2f(found->second.low.x, found->second.low.y);
    const auto high = cv::Point2f(found->second.high.x, found->second.high.y);
    area = cv::Rect(cv::Point(low), cv::Point(high));
  }
  return window_->picture(area);
}

void Application::write_picture(const std::filesystem::path& file, const std::string& item) const {
  const cv::Mat picture = picture_of(item);
  if (picture.empty()) throw Error(file.string() + ": there is nothing to take a picture of; enlarge the window");
  std::vector<unsigned char> bytes;
  if (!cv::imencode(file.extension().string(), picture, bytes)) {
    throw Error(file.string() + ": is no kind of picture that can be written; name it .png");
  }
  write_text_file(file, std::string(bytes.begin(), bytes.end()));
}

std::vector<std::string> Application::shown_panes() const {
  std::vector<std::string> panes{"Window", live_shown_ ? "Live" : "Review"};
  if (settings_.show_outline) panes.emplace_back("Outline");
  if (settings_.show_reslice) panes.emplace_back("Reslice");
  if (settings_.show_measurements) panes.emplace_back("Measurements");
  if (settings_.show_timeline) panes.emplace_back("Timeline");
  return panes;
}

// Written beside the frame, as a compressed picture takes longer than a frame may.
void Application::write_asked_picture(const PictureRequest& request) {
  session_.view.hides_names = false;
  const std::filesystem::path& file = request.file;
  session_.attempt(file.filename().string(), [&] {
    if (request.without_names && live_shown_ && (request.item.empty() || request.item == "pane:Live")) {
      throw Error("Live shows images as they come, with all that is written into them; leave Live first");
    }
    if (file.extension() != ".png") throw Error(file.string() + ": pictures are written as PNG; name it .png");
    if (std::filesystem::exists(file)) throw Error(file.string() + ": is there already; choose another name");
    const cv::Mat picture = picture_of(request.item);
    if (picture.empty()) throw Error("there is nothing to take a picture of; enlarge the window");
    const auto work = [this, picture, file](const Progress&) -> std::function<void()> {
      write_png(picture, file);
      return [this, file] { session_.say("picture", "written to " + file.string(), false); };
    };
    session_.worker().start({"picture " + file.string(), "Writing " + file.filename().string(), work,
                             [this, file](const std::string& error) { session_.say("picture", error); }});
  });
}

}  // namespace fathom
