#include "registration/wall_detection.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/random.h"
#include "registration/wall_profile.h"

namespace fathom {

namespace {

constexpr int kFramesPerReport = 16;
constexpr int kRefits = 4;             // of the line to its own columns: the set of columns settles in two or three
constexpr double kUnit = 1.0 / 300.0;  // of the smaller side: about half an echo's height
constexpr double kDip = 0.05;          // of an echo's height, by which it must fall for its ridge to be past
constexpr double kProfileReach =
    0.06;  // of the image's height, above and below the wall, within which its place is taken
constexpr std::size_t kLeastParts = 3;

/// What one column shows.
struct Echo {
  double x = 0.0;
  double y = 0.0;
  double height = 0.0;  ///< above the column's background
};

double distance(const Echo& echo, const WallSlope& line) {
  return std::abs(echo.y - line.y(echo.x)) / std::sqrt(1.0 + line.slope * line.slope);
}

/// The first bright echo of every column of `turned`, whose rows are the image's columns.
std::vector<Echo> first_echoes(const cv::Mat& turned, double least, const WallDetectionOptions& options) {
  std::vector<Echo> echoes;
  for (int x = 0; x < turned.rows; ++x) {
    const float* value = turned.ptr<float>(x);
    const int count = turned.cols;
    double sum = 0.0;
    for (int y = 0; y < count; ++y) sum += static_cast<double>(value[y]);
    const double background = sum / count;
    const double highest = static_cast<double>(*std::max_element(value, value + count)) - background;
    if (highest < least) continue;
    const double enough = background + options.first_echo * highest;
    int y = 0;
    while (static_cast<double>(value[y]) < enough) ++y;
    // Up to the ridge; speckle on the way up is not one.
    const double dip = kDip * highest;
    for (int next = y + 1; next < count && static_cast<double>(value[y] - value[next]) < dip; ++next) {
      if (value[next] > value[y]) y = next;
    }
    if (y == 0 || y + 1 == count) continue;
    echoes.push_back({static_cast<double>(x), static_cast<double>(y), static_cast<double>(value[y]) - background});
  }
  return echoes;
}

std::optional<WallSlope> fit_line(const std::vector<Echo>& echoes) {
  if (echoes.size() < 2) return std::nullopt;
  double x_mean = 0.0;
  double y_mean = 0.0;
  for (const Echo& echo : echoes) {
    x_mean += echo.x / static_cast<double>(echoes.size());
    y_mean += echo.y / static_cast<double>(echoes.size());
  }
  double xx = 0.0;
  double xy = 0.0;
  for (const Echo& echo : echoes) {
    xx += (echo.x - x_mean) * (echo.x - x_mean);
    xy += (echo.x - x_mean) * (echo.y - y_mean);
  }
  if (xx <= 0.0) return std::nullopt;
  const double slope = xy / xx;
  return WallSlope{y_mean - slope * x_mean, slope};
}

std::vector<Echo> members(const std::vector<Echo>& echoes, const WallSlope& line, double tolerance_px) {
  std::vector<Echo> near;
  std::copy_if(echoes.begin(), echoes.end(), std::back_inserter(near),
               [&](const Echo& echo) { return distance(echo, line) <= tolerance_px; });
  return near;
}

/// The line with the greatest sum of brightness along it.
std::optional<WallSlope> brightest_line(const std::vector<Echo>& echoes, double tolerance_px,
                                        const WallDetectionOptions& options) {
  Random random(options.seed);
  const auto any = [&] {
    return echoes[static_cast<std::size_t>(random.uniform() * static_cast<double>(echoes.size()))];
  };
  std::optional<WallSlope> best;
  double most = 0.0;
  for (int trial = 0; trial < options.trials; ++trial) {
    const Echo a = any();
    const Echo b = any();
    if (std::abs(a.x - b.x) < 8.0 * tolerance_px) continue;
    const double slope = (b.y - a.y) / (b.x - a.x);
    if (std::abs(std::atan(slope)) > options.max_tilt_rad) continue;
    const WallSlope line{a.y - slope * a.x, slope};
    double sum = 0.0;
    for (const Echo& echo : echoes) {
      if (distance(echo, line) <= tolerance_px) sum += echo.height;
    }
    if (sum <= most) continue;
    most = sum;
    best = line;
  }
  return best;
}

/// Those near the line, and the line through them, until neither changes.
std::optional<WallSlope> settled_line(const std::vector<Echo>& echoes, std::vector<Echo>& kept, double tolerance_px) {
  std::optional<WallSlope> line;
  for (int refit = 0; refit < kRefits; ++refit) {
    line = fit_line(kept);
    if (!line) return std::nullopt;
    kept = members(echoes, *line, tolerance_px);
  }
  return line;
}

/// A line through places along the wall.
std::optional<WallLine> wall_line(const std::vector<WallPart>& parts, double WallProfile::*place, double tolerance_px) {
  std::vector<Echo> echoes;
  for (const WallPart& part : parts) echoes.push_back({part.x, part.place.*place, 1.0});
  std::vector<Echo> kept = echoes;
  const auto line = settled_line(echoes, kept, tolerance_px);
  if (!line || kept.size() < kLeastParts) return std::nullopt;
  WallLine wall;
  double squares = 0.0;
  for (const Echo& echo : kept) {
    wall.point_px.x() += echo.x / static_cast<double>(kept.size());
    squares += distance(echo, *line) * distance(echo, *line);
  }
  wall.point_px.y() = line->y(wall.point_px.x());
  wall.direction = Eigen::Vector2d(1.0, line->slope).normalized();
  wall.sigma_px = std::sqrt(squares / static_cast<double>(kept.size()));
  double aside = 0.0;
  for (const Echo& echo : kept) aside += (echo.x - wall.point_px.x()) * (echo.x - wall.point_px.x());
  wall.reach_px = std::sqrt(aside / static_cast<double>(kept.size())) / wall.direction.x();
  return wall;
}

/// A wall by its ridge, and by its upper edge.
struct MeasuredWall {
  std::optional<WallLine> ridge;
  std::optional<WallLine> edge;
  bool peaked = false;  ///< most of it has a ridge

  const std::optional<WallLine>& by(bool its_ridge) const { return its_ridge ? ridge : edge; }
};

std::optional<MeasuredWall> measure_wall(const cv::Mat& image, const WallDetectionOptions& options) {
  if (image.empty() || std::min(image.rows, image.cols) < 16) return std::nullopt;
  const int unit = std::max(1, static_cast<int>(std::lround(kUnit * std::min(image.rows, image.cols))));
  const cv::Mat grey = grey_image(image);
  cv::Mat smooth;
  // Wide and low: speckle is averaged along the wall.
  cv::blur(grey, smooth, cv::Size(6 * unit + 1, 2 * unit + 1), cv::Point(-1, -1), cv::BORDER_REPLICATE);
  cv::Mat turned;
  cv::transpose(smooth, turned);

  const double tolerance_px = std::max(1.5, options.tolerance * image.rows);
  const std::vector<Echo> echoes = first_echoes(turned, options.min_contrast * full_scale(image), options);
  const double needed = options.min_columns * image.cols;
  if (static_cast<double>(echoes.size()) < needed) return std::nullopt;
  auto line = brightest_line(echoes, tolerance_px, options);
  if (!line) return std::nullopt;
  std::vector<Echo> kept = members(echoes, *line, tolerance_px);
  line = settled_line(echoes, kept, tolerance_px);
  if (!line || static_cast<double>(kept.size()) < needed) return std::nullopt;
  if (std::abs(std::atan(line->slope)) > options.max_tilt_rad) return std::nullopt;

  std::vector<int> columns;
  for (const Echo& echo : kept) columns.push_back(static_cast<int>(echo.x));
  const auto reach = static_cast<int>(std::ceil(kProfileReach * image.rows));
  const std::vector<WallPart> parts = wall_parts(grey, *line, columns, reach, options.first_echo);
  const auto peaked = std::count_if(parts.begin(), parts.end(), [](const WallPart& part) { return part.place.peaked; });
  MeasuredWall wall;
  wall.peaked = 2 * static_cast<std::size_t>(peaked) > parts.size();
  wall.ridge = wall_line(parts, &WallProfile::ridge, tolerance_px);
  wall.edge = wall_line(parts, &WallProfile::edge, tolerance_px);
  return wall;
}

}  // namespace

void WallDetectionOptions::check() const {
  if (!(min_contrast > 0.0 && min_contrast < 1.0)) throw Error("wall detection: the contrast must be between 0 and 1");
  if (!(min_columns > 0.0 && min_columns <= 1.0)) throw Error("wall detection: the columns must be above 0, up to 1");
  if (!(max_tilt_rad > 0.0 && max_tilt_rad < 1.5)) throw Error("wall detection: the tilt must be from 0 to 1.5 rad");
  if (!(first_echo > 0.0 && first_echo <= 1.0)) throw Error("wall detection: the first echo must be above 0, up to 1");
  if (!(tolerance > 0.0 && tolerance < 0.5)) throw Error("wall detection: the tolerance must be from 0 to 0.5");
  if (trials < 1) throw Error("wall detection: at least one line must be tried");
}

std::optional<WallLine> detect_wall_in_image(const cv::Mat& image, const WallDetectionOptions& options) {
  options.check();
  const auto wall = measure_wall(image, options);
  return wall ? wall->by(wall->peaked) : std::nullopt;
}

namespace {

/// Calls `look(frame)` for every frame with a valid image, in parallel.
template <typename Look>
void for_each_image(const Recording& recording, const char* target, const Progress& progress, const Look& look) {
  const RecordingHeader& header = recording.header();
  if (!header.has_images())
    throw Error(recording.name() + ": has no images in which to look for " + target + "; give a recording with images");
  const int count = header.frame_count();
  for (int start = 0; start < count; start += kFramesPerReport) {
    report(progress, static_cast<double>(start) / count);
    cv::parallel_for_(cv::Range(start, std::min(count, start + kFramesPerReport)), [&](const cv::Range& range) {
      for (int frame = range.start; frame < range.end; ++frame) {
        if (header.frames[static_cast<std::size_t>(frame)].image_valid()) look(frame);
      }
    });
  }
  report(progress, 1.0);
}

template <typename Found>
std::vector<Found> in_order(std::vector<std::optional<Found>>& of_frame, const Recording& recording,
                            const char* target) {
  std::vector<Found> found;
  for (std::size_t i = 0; i < of_frame.size(); ++i) {
    if (!of_frame[i]) continue;
    of_frame[i]->frame = static_cast<int>(i);
    found.push_back(*of_frame[i]);
  }
  if (found.empty()) {
    throw Error(recording.name() + ": none of its " + std::to_string(of_frame.size()) + " frames shows " + target +
                "; check gain and depth, and that this is the right recording");
  }
  return found;
}

}  // namespace

std::vector<WallLine> detect_wall(const Recording& recording, const WallDetectionOptions& options,
                                  const Progress& progress) {
  options.check();
  std::vector<std::optional<MeasuredWall>> measured(recording.header().frames.size());
  for_each_image(recording, "a wall", progress, [&](int frame) {
    measured[static_cast<std::size_t>(frame)] = measure_wall(recording.image(frame), options);
  });
  // Edge and ridge are apart by as much as the scanner blurs: the same one counts in all frames.
  int peaked = 0;
  int seen = 0;
  for (const auto& wall : measured) {
    seen += wall ? 1 : 0;
    peaked += wall && wall->peaked ? 1 : 0;
  }
  std::vector<std::optional<WallLine>> of_frame(measured.size());
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (measured[i]) of_frame[i] = measured[i]->by(2 * peaked > seen);
  }
  return in_order(of_frame, recording, "a wall");
}

std::vector<SpotPoint> detect_point(const Recording& recording, const BrightSpotOptions& options, double rival,
                                    const Progress& progress) {
  options.check();
  std::vector<std::optional<SpotPoint>> of_frame(recording.header().frames.size());
  for_each_image(recording, "a point", progress, [&](int frame) {
    const std::vector<BrightSpot> spots = find_bright_spots(recording.image(frame), options);
    if (spots.empty() || spots[0].cut_off) return;
    if (spots.size() > 1 && spots[1].contrast > rival * spots[0].contrast) return;
    of_frame[static_cast<std::size_t>(frame)] = SpotPoint{frame, spots[0].centre_px};
  });
  return in_order(of_frame, recording, "a single bright point");
}

}  // namespace fathom
