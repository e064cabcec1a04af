#include "exam/report_picture.h"

#include <algorithm>
#include <map>
#include <span>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "exam/frame_drawing.h"
#include "exam/scene_view.h"

namespace fathom {

namespace {

constexpr int kLongestPngSide = 1000000;  // libpng refuses more

constexpr int kPane = 900;  // pixels, side of each of the two panes
constexpr int kMargin = 40;
constexpr int kLine = 30;  // height of a caption
const cv::Scalar kHighlight(70, 180, 255);

// A contour or the goal post of a frame, in space.
struct SpaceLine {
  std::vector<Eigen::Vector3d> points;
  cv::Scalar color;
  bool closed = false;
  bool filled = false;
  int thickness = 1;
};

double round_length_mm(double up_to) {
  double length = std::pow(10.0, std::floor(std::log10(up_to)));
  for (const double step : {5.0, 2.0}) {
    if (length * step <= up_to) return length * step;
  }
  return length;
}

void draw_space(cv::Mat& pane, std::vector<SpaceLine> lines, const Eigen::Matrix3d& view) {
  const auto depth = [&view](const SpaceLine& line) {
    double sum = 0.0;
    for (const Eigen::Vector3d& point : line.points) sum += view.row(2).dot(point);
    return sum / static_cast<double>(line.points.size());
  };
  std::stable_sort(lines.begin(), lines.end(),
                   [&depth](const SpaceLine& a, const SpaceLine& b) { return depth(a) > depth(b); });
  Eigen::AlignedBox2d box;
  for (const SpaceLine& line : lines) {
    for (const Eigen::Vector3d& point : line.points) box.extend((view * point).head<2>());
  }
  const double free = kPane - 2.0 * kMargin;
  const double scale = free / std::max(box.sizes().maxCoeff(), 1e-6);  // pixels per millimetre
  const Eigen::Vector2d centre(0.5 * pane.cols, 0.5 * pane.rows);
  for (const SpaceLine& line : lines) {
    Polygon drawn;
    for (const Eigen::Vector3d& point : line.points) {
      drawn.push_back(centre + scale * ((view * point).head<2>() - box.center()));
    }
    if (line.filled) {
      cv::Mat over = pane.clone();
      cv::fillPoly(over, std::vector{fixed_point(drawn)}, line.color, cv::LINE_AA, kFractionBits);
      cv::addWeighted(over, 0.18, pane, 0.82, 0.0, pane);
    }
    draw_polyline(pane, drawn, line.closed, line.color, line.thickness);
  }
  const double bar_mm = round_length_mm(0.25 * free / scale);
  const cv::Point start(kMargin, pane.rows - kMargin);
  cv::line(pane, start, start + cv::Point(cvRound(bar_mm * scale), 0), kPictureText, 2, cv::LINE_AA);
  draw_text(pane, cv::format("%g mm", bar_mm), start - cv::Point(0, 12));
}

std::vector<SpaceLine> lines_in_space(const RecordingHeader& header, const FrameLocator& locator,
                                      const std::vector<Structure>& structures, int frame) {
  std::vector<SpaceLine> lines;
  std::map<int, bool> posts;
  for (const Structure& structure : structures) {
    for (const Contour& contour : structure.contours) {
      const auto reference_from_image = locator.reference_from_image(contour.frame);
      if (!reference_from_image) continue;
      SpaceLine line{{}, color_of(structure), contour.closed, contour.closed, 1};
      if (contour.frame == frame) {
        line.color = kHighlight;
        line.thickness = 3;
      }
      for (const Eigen::Vector2d& point : contour.points_px) {
        line.points.push_back(*reference_from_image * Eigen::Vector3d(point.x(), point.y(), 0.0));
      }
      lines.push_back(std::move(line));
      posts[contour.frame] = true;
    }
  }
  for (const auto& [outlined, drawn] : posts) {
    // Open at the probe's side, so that it is seen which way the probe looked.
    const Eigen::Affine3d reference_from_image = *locator.reference_from_image(outlined);
    const double right = header.width - 1.0, bottom = header.height - 1.0;
    SpaceLine post{{}, outlined == frame ? kHighlight : kPictureLine, false, false, 1};
    for (const Eigen::Vector3d& corner : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, bottom, 0),
                                          Eigen::Vector3d(right, bottom, 0), Eigen::Vector3d(right, 0, 0)}) {
      post.points.push_back(reference_from_image * corner);
    }
    lines.push_back(std::move(post));
  }
  return lines;
}

}  // namespace

cv::Mat report_picture(const Recording& recording, const FrameLocator& locator,
                       const std::vector<Structure>& structures, int frame, const std::vector<std::string>& captions) {
  const cv::Mat image = recording.image(frame);
  std::vector<SpaceLine> lines = lines_in_space(recording.header(), locator, structures, frame);
  std::vector<Eigen::Vector3d> outlined;
  for (const SpaceLine& line : lines) {
    if (line.closed) outlined.insert(outlined.end(), line.points.begin(), line.points.end());
  }
  if (outlined.empty()) throw Error(recording.name() + ": no outlined frame has a known pose; nothing to picture");

  const int caption_height = kMargin + kLine * static_cast<int>(captions.size());
  cv::Mat canvas(kPane + caption_height, 2 * kPane, CV_8UC3, kPictureBackground);
  cv::Mat right = canvas(cv::Rect(kPane, 0, kPane, kPane));
  draw_frame(canvas, {kMargin, kMargin, kPane - 2 * kMargin, kPane - 2 * kMargin}, image, structures, frame, 0, 2);
  draw_space(right, std::move(lines), scene_view(outlined, mean_depth(locator, structures)));
  draw_text(canvas, "frame " + std::to_string(frame), {kMargin, kMargin - 12});
  for (std::size_t i = 0; i < captions.size(); ++i) {
    draw_text(canvas, captions[i], {kMargin, kPane + kLine * static_cast<int>(i + 1)});
  }
  return canvas;
}

void write_png(const cv::Mat& picture, AtomicFile& file) {
  const std::string name = file.target().string();
  if (std::max(picture.cols, picture.rows) > kLongestPngSide) {
    throw Error(name + ": a PNG holds at most " + std::to_string(kLongestPngSide) +
                " pixels along a side; make the picture smaller or its pixels larger");
  }
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", picture, bytes)) throw Error(name + ": no PNG can be made of it; try again");
  file.write(std::as_bytes(std::span(bytes)));
}

void write_png(const cv::Mat& picture, const std::filesystem::path& path) {
  AtomicFile file(path);
  write_png(picture, file);
  file.commit();
}

}  // namespace fathom
