#include "exam/calibration_picture.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

namespace {

constexpr int kPane = 900;  // pixels, side of the left pane, and width of the right one
constexpr int kMargin = 60;
constexpr int kLine = 30;  // height of a caption
constexpr std::size_t kLineLength = 150;
constexpr double kTopShare = 0.98;  // of the distances: the colour scale ends there, not at a single outlier
const cv::Scalar kBackground(24, 17, 13);
const cv::Scalar kPost(92, 80, 70);
const cv::Scalar kText(225, 220, 215);
const cv::Scalar kFaint(150, 140, 130);

void draw_text(cv::Mat& canvas, const std::string& text, int x, int y, const cv::Scalar& color = kText) {
  cv::putText(canvas, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.55, color, 1, cv::LINE_AA);
}

cv::Scalar color_for(double share) {
  cv::Mat1b grey(1, 1, static_cast<unsigned char>(std::lround(40.0 + 215.0 * std::clamp(share, 0.0, 1.0))));
  cv::Mat3b color;
  cv::applyColorMap(grey, color, cv::COLORMAP_TURBO);
  return cv::Scalar(color(0, 0)[0], color(0, 0)[1], color(0, 0)[2]);
}

double top_of_scale(const std::vector<Residual>& residuals) {
  std::vector<double> distances;
  for (const Residual& residual : residuals) distances.push_back(residual.distance_mm);
  std::sort(distances.begin(), distances.end());
  const double top = distances[static_cast<std::size_t>(kTopShare * static_cast<double>(distances.size() - 1))];
  return std::max(top, 1e-6);
}

void draw_scale(cv::Mat& pane, double top_mm) {
  constexpr int kSteps = 100;
  const int y = pane.rows - kMargin / 2;
  const int width = (pane.cols - 4 * kMargin) / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    cv::rectangle(pane, cv::Rect(2 * kMargin + i * width, y - 12, width, 12), color_for(i / (kSteps - 1.0)),
                  cv::FILLED);
  }
  draw_text(pane, "0", 2 * kMargin - 20, y);
  draw_text(pane, format_rounded(top_mm, 2) + " mm", 2 * kMargin + kSteps * width + 10, y);
}

void draw_in_image(cv::Mat& pane, cv::Size image, const std::vector<Residual>& residuals, double top_mm) {
  const double scale = std::min((pane.cols - 2.0 * kMargin) / image.width, (pane.rows - 2.0 * kMargin) / image.height);
  const cv::Point2d origin(0.5 * (pane.cols - scale * image.width), 0.5 * (pane.rows - scale * image.height));
  cv::rectangle(pane, cv::Rect(cv::Point(origin), cv::Size(cv::Size2d(scale * image.width, scale * image.height))),
                kPost, 1);
  draw_text(pane, "errors in the image (" + std::to_string(image.width) + " x " + std::to_string(image.height) + ")",
            kMargin, kMargin / 2);
  // The large ones last, so that none is hidden.
  std::vector<Residual> sorted = residuals;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Residual& a, const Residual& b) { return a.distance_mm < b.distance_mm; });
  for (const Residual& residual : sorted) {
    const double share = std::min(1.0, residual.distance_mm / top_mm);
    const cv::Point2d at = origin + scale * cv::Point2d(residual.position_px.x(), residual.position_px.y());
    cv::circle(pane, cv::Point(at), cvRound(3.0 + 7.0 * share), color_for(share), share > 0.5 ? 2 : 1, cv::LINE_AA);
  }
  draw_scale(pane, top_mm);
}

struct Sum {
  double sum_mm = 0.0;
  double largest_mm = 0.0;
  int count = 0;
  void add(double distance_mm) {
    sum_mm += distance_mm;
    largest_mm = std::max(largest_mm, distance_mm);
    ++count;
  }
  double mean_mm() const { return sum_mm / count; }
};

void draw_by_part(cv::Mat& pane, const std::vector<Residual>& residuals) {
  std::map<std::string, Sum> parts;
  std::vector<std::string> order;  // of the phantom, not of the alphabet
  double largest = 1e-6;
  for (const Residual& residual : residuals) {
    if (parts.find(residual.part) == parts.end()) order.push_back(residual.part);
    parts[residual.part].add(residual.distance_mm);
    largest = std::max(largest, residual.distance_mm);
  }
  draw_text(pane, "by part of the phantom: mean (bar) and largest (line)", kMargin, kMargin / 2);
  const int step = std::min(2 * kLine, (pane.rows - kMargin) / static_cast<int>(order.size()));
  constexpr int kLabel = 110;  // pixels for a name
  const double scale = (pane.cols - 2.0 * kMargin - 2 * kLabel) / largest;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Sum& part = parts[order[i]];
    const int y = kMargin + step * static_cast<int>(i);
    const int x = kMargin + kLabel;
    draw_text(pane, order[i].substr(0, 10), kMargin, y + step / 2);
    cv::rectangle(pane, cv::Rect(x, y + step / 6, std::max(1, cvRound(scale * part.mean_mm())), step / 2),
                  color_for(part.mean_mm() / largest), cv::FILLED);
    const int end = x + cvRound(scale * part.largest_mm);
    cv::line(pane, {x, y + step * 5 / 12}, {end, y + step * 5 / 12}, kFaint, 1);
    draw_text(pane, format_rounded(part.mean_mm(), 2) + ", " + format_rounded(part.largest_mm, 2) + " mm", end + 8,
              y + step / 2, kFaint);
  }
}

void draw_by_frame(cv::Mat& pane, const std::vector<Residual>& residuals, int frames) {
  std::map<int, Sum> sums;
  for (const Residual& residual : residuals) sums[residual.frame].add(residual.distance_mm);
  double largest = 1e-6;
  for (const auto& [frame, sum] : sums) largest = std::max(largest, sum.mean_mm());
  draw_text(pane, "by frame: mean", kMargin, kMargin / 2);
  const int bottom = pane.rows - kMargin;
  const double width = pane.cols - 3.0 * kMargin;
  const int left = 2 * kMargin;
  cv::line(pane, {left, bottom}, {left + cvRound(width), bottom}, kPost, 1);
  cv::line(pane, {left, kMargin}, {left, bottom}, kPost, 1);
  draw_text(pane, format_rounded(largest, 2) + " mm", kMargin / 4, kMargin + 5, kFaint);
  draw_text(pane, "0", left - 20, bottom + 5, kFaint);
  draw_text(pane, "0", left, bottom + 24, kFaint);
  draw_text(pane, std::to_string(frames - 1), left + cvRound(width) - 20, bottom + 24, kFaint);
  for (const auto& [frame, sum] : sums) {
    const double share = sum.mean_mm() / largest;
    const cv::Point at(left + cvRound(width * frame / std::max(1, frames - 1)),
                       bottom - cvRound(share * (bottom - kMargin)));
    cv::circle(pane, at, 3, color_for(share), cv::FILLED, cv::LINE_AA);
  }
}

// Long captions go on in the next line, at a space.
std::vector<std::string> wrapped(const std::vector<std::string>& captions) {
  std::vector<std::string> lines;
  for (std::string rest : captions) {
    while (rest.size() > kLineLength) {
      const std::size_t space = rest.rfind(' ', kLineLength);
      if (space == std::string::npos || space == 0) break;
      lines.push_back(rest.substr(0, space));
      rest = "    " + rest.substr(space + 1);
    }
    lines.push_back(rest);
  }
  return lines;
}

}  // namespace

cv::Mat calibration_picture(const CalibrationScan& scan, const std::vector<Residual>& residuals,
                            const std::vector<std::string>& captions) {
  if (residuals.empty()) throw Error(scan.poses.recording() + ": no frame has a pose; nothing to picture");
  const std::vector<std::string> lines = wrapped(captions);
  const int caption_height = kMargin + kLine * static_cast<int>(lines.size());
  cv::Mat canvas(kPane + caption_height, 2 * kPane, CV_8UC3, kBackground);
  cv::Mat left = canvas(cv::Rect(0, 0, kPane, kPane));
  cv::Mat upper = canvas(cv::Rect(kPane, 0, kPane, kPane * 6 / 10));
  cv::Mat lower = canvas(cv::Rect(kPane, kPane * 6 / 10, kPane, kPane * 4 / 10));
  draw_in_image(left, scan.image_size, residuals, top_of_scale(residuals));
  draw_by_part(upper, residuals);
  draw_by_frame(lower, residuals, scan.poses.frame_count());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    draw_text(canvas, lines[i], kMargin, kPane + kLine * static_cast<int>(i + 1));
  }
  return canvas;
}

}  // namespace fathom
