#include "exam/contact_sheet.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "exam/frame_drawing.h"

namespace fathom {

namespace {

constexpr int kGap = 12;          // pixels between frames
constexpr int kCaption = 24;      // pixels below a frame
constexpr int kLeastWidth = 230;  // pixels: a caption fits
constexpr int kMostPanePx = 2000;
constexpr int kMostFrames = 1000;
constexpr double kAround = 0.15;  // of the outlines' size is shown beside them

// The lowest confidence of the contours on a frame; empty where a person drew them.
using ShownFrames = std::map<int, std::optional<double>>;

ShownFrames frames_to_show(const std::vector<Structure>& structures, const ContactSheetOptions& options) {
  ShownFrames frames;
  for (const int frame : options.also) frames[frame];
  for (const Structure& structure : structures) {
    for (const Contour& contour : structure.contours) {
      if (contour.recording != options.recording) continue;
      std::optional<double>& lowest = frames[contour.frame];
      if (contour.confidence) lowest = std::min(lowest.value_or(1.0), *contour.confidence);
    }
  }
  return frames;
}

std::vector<int> spread_evenly(const ShownFrames& frames, int most) {
  std::vector<int> all;
  for (const auto& [frame, confidence] : frames) all.push_back(frame);
  const int count = static_cast<int>(all.size());
  if (count <= most) return all;
  std::vector<int> chosen;
  for (int i = 0; i < most; ++i) {
    const int index = most == 1 ? count / 2 : static_cast<int>((static_cast<long long>(i) * (count - 1)) / (most - 1));
    chosen.push_back(all[static_cast<std::size_t>(index)]);
  }
  return chosen;
}

// The part of the images that holds all outlines.
cv::Rect part_to_show(const RecordingHeader& header, const std::vector<Structure>& structures,
                      const ContactSheetOptions& options) {
  const cv::Rect whole(0, 0, header.width, header.height);
  if (!options.crop) return whole;
  Eigen::AlignedBox2d box;
  for (const Structure& structure : structures) {
    for (const Contour& contour : structure.contours) {
      if (contour.recording != options.recording) continue;
      for (const Eigen::Vector2d& point : contour.points_px) box.extend(point);
    }
  }
  if (box.isEmpty()) return whole;
  const double around = 4.0 + kAround * box.sizes().maxCoeff();
  const Eigen::Vector2d low = (box.min().array() - around).floor().cwiseMax(0.0);
  const Eigen::Vector2d high =
      (box.max().array() + around).ceil().cwiseMin(Eigen::Array2d(header.width, header.height));
  const cv::Rect part(cv::Point2d(low.x(), low.y()), cv::Point2d(high.x(), high.y()));
  return part.empty() ? whole : part;
}

std::vector<Structure> shifted(std::vector<Structure> structures, const cv::Point& origin) {
  for (Structure& structure : structures) {
    for (Contour& contour : structure.contours) {
      for (Eigen::Vector2d& point : contour.points_px) point -= Eigen::Vector2d(origin.x, origin.y);
    }
  }
  return structures;
}

std::string caption(int frame, const std::optional<double>& confidence) {
  std::string text = "frame " + std::to_string(frame);
  if (confidence) text += cv::format("   confidence %.2f", *confidence);
  return text;
}

}  // namespace

void ContactSheetOptions::check() const {
  if (columns < 1 || columns > 100) throw Error("contact sheet: needs 1 to 100 columns");
  if (most_frames < 1 || most_frames > kMostFrames) throw Error("contact sheet: shows 1 to 1000 frames");
  if (pane_px < 50 || pane_px > kMostPanePx) throw Error("contact sheet: frames must be 50 to 2000 pixels wide");
}

cv::Mat contact_sheet(const Recording& recording, const std::vector<Structure>& structures,
                      const ContactSheetOptions& options) {
  options.check();
  const ShownFrames all = frames_to_show(structures, options);
  if (all.empty()) throw Error(recording.name() + ": no frame is outlined; there is nothing to picture");
  if (all.begin()->first < 0 || all.rbegin()->first >= recording.header().frame_count()) {
    throw Error(recording.name() + ": has no frame " +
                std::to_string(all.begin()->first < 0 ? all.begin()->first : all.rbegin()->first) +
                ", which is outlined; give the contours of this recording");
  }
  const std::vector<int> frames = spread_evenly(all, options.most_frames);
  const cv::Rect part = part_to_show(recording.header(), structures, options);
  const std::vector<Structure> shown = shifted(structures, part.tl());
  const int count = static_cast<int>(frames.size());
  const int columns = std::min(options.columns, count);
  const int rows = (count + columns - 1) / columns;
  const double scale = static_cast<double>(options.pane_px) / std::max(part.width, part.height);
  const cv::Size pane(std::max(1, cvRound(scale * part.width)), std::max(1, cvRound(scale * part.height)));
  const cv::Size cell(std::max(pane.width, kLeastWidth) + kGap, pane.height + kGap + kCaption);
  cv::Mat sheet(kGap + rows * cell.height, kGap + columns * cell.width, CV_8UC3, kPictureBackground);
  for (int i = 0; i < count; ++i) {
    const int frame = frames[static_cast<std::size_t>(i)];
    const cv::Point corner(kGap + (i % columns) * cell.width, kGap + (i / columns) * cell.height);
    draw_frame(sheet, {corner, pane}, recording.image(frame)(part), shown, frame, options.recording, 1);
    draw_text(sheet, caption(frame, all.at(frame)), corner + cv::Point(0, pane.height + 18), 0.75);
  }
  return sheet;
}

}  // namespace fathom
