#include "registration/wall_detection.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/random.h"

namespace fathom {

namespace {

constexpr int kFramesPerReport = 16;
constexpr int kRefits = 4;             // of the line to its own columns: the set of columns settles in two or three
constexpr double kUnit = 1.0 / 300.0;  // of the smaller side: about half an echo's height
constexpr double kEdgeReach = 3.0;     // tolerances above and below the ridge within which the upper edge is looked for

/// What one column shows.
struct Echo {
  double x = 0.0;
  double y = 0.0;
  double height = 0.0;  ///< above the column's background
};

/// y = at + slope * x
struct Line {
  double at = 0.0;
  double slope = 0.0;
  double y(double x) const { return at + slope * x; }
  double distance(const Echo& echo) const { return std::abs(echo.y - y(echo.x)) / std::sqrt(1.0 + slope * slope); }
};

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
    while (y + 1 < count && value[y + 1] > value[y]) ++y;  // up to the ridge
    if (y == 0 || y + 1 == count) continue;
    echoes.push_back({static_cast<double>(x), static_cast<double>(y), static_cast<double>(value[y]) - background});
  }
  return echoes;
}

std::optional<Line> fit_line(const std::vector<Echo>& echoes) {
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
  return Line{y_mean - slope * x_mean, slope};
}

std::vector<Echo> members(const std::vector<Echo>& echoes, const Line& line, double tolerance_px) {
  std::vector<Echo> near;
  std::copy_if(echoes.begin(), echoes.end(), std::back_inserter(near),
               [&](const Echo& echo) { return line.distance(echo) <= tolerance_px; });
  return near;
}

/// The line with the greatest sum of brightness along it.
std::optional<Line> brightest_line(const std::vector<Echo>& echoes, double tolerance_px,
                                   const WallDetectionOptions& options) {
  Random random(options.seed);
  const auto any = [&] {
    return echoes[static_cast<std::size_t>(random.uniform() * static_cast<double>(echoes.size()))];
  };
  std::optional<Line> best;
  double most = 0.0;
  for (int trial = 0; trial < options.trials; ++trial) {
    const Echo a = any();
    const Echo b = any();
    if (std::abs(a.x - b.x) < 8.0 * tolerance_px) continue;
    const double slope = (b.y - a.y) / (b.x - a.x);
    if (std::abs(std::atan(slope)) > options.max_tilt_rad) continue;
    const Line line{a.y - slope * a.x, slope};
    double sum = 0.0;
    for (const Echo& echo : echoes) {
      if (line.distance(echo) <= tolerance_px) sum += echo.height;
    }
    if (sum <= most) continue;
    most = sum;
    best = line;
  }
  return best;
}

/// Where a column rises to half of its ridge, above the ridge, between pixels.
std::optional<double> upper_edge(const float* value, const Echo& echo, int reach) {
  const int ridge = static_cast<int>(echo.y);
  const double half = static_cast<double>(value[ridge]) - echo.height / 2.0;
  for (int y = ridge; y > std::max(0, ridge - reach); --y) {
    const double here = static_cast<double>(value[y]);
    const double above = static_cast<double>(value[y - 1]);
    if (above < half && here >= half) return y - (here - half) / (here - above);
  }
  return std::nullopt;
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
  if (image.empty() || std::min(image.rows, image.cols) < 16) return std::nullopt;
  const int unit = std::max(1, static_cast<int>(std::lround(kUnit * std::min(image.rows, image.cols))));
  cv::Mat smooth;
  // Wide and low: speckle is averaged along the wall, the edge stays where it is.
  cv::blur(grey_image(image), smooth, cv::Size(6 * unit + 1, 3), cv::Point(-1, -1), cv::BORDER_REPLICATE);
  cv::Mat turned;
  cv::transpose(smooth, turned);

  const double tolerance_px = std::max(1.5, options.tolerance * image.rows);
  const std::vector<Echo> echoes = first_echoes(turned, options.min_contrast * full_scale(image), options);
  const double needed = options.min_columns * image.cols;
  if (static_cast<double>(echoes.size()) < needed) return std::nullopt;
  std::optional<Line> line = brightest_line(echoes, tolerance_px, options);
  if (!line) return std::nullopt;

  std::vector<Echo> edges;
  for (const Echo& echo : members(echoes, *line, tolerance_px)) {
    const auto edge = upper_edge(turned.ptr<float>(static_cast<int>(echo.x)), echo,
                                 static_cast<int>(std::ceil(kEdgeReach * tolerance_px)));
    if (edge) edges.push_back({echo.x, *edge, echo.height});
  }
  std::vector<Echo> kept = edges;
  for (int refit = 0; refit < kRefits; ++refit) {
    line = fit_line(kept);
    if (!line) return std::nullopt;
    kept = members(edges, *line, tolerance_px);
  }
  if (static_cast<double>(kept.size()) < needed) return std::nullopt;
  WallLine wall;
  double squares = 0.0;
  for (const Echo& echo : kept) {
    wall.point_px.x() += echo.x / static_cast<double>(kept.size());
    squares += line->distance(echo) * line->distance(echo);
  }
  wall.point_px.y() = line->y(wall.point_px.x());
  wall.direction = Eigen::Vector2d(1.0, line->slope).normalized();
  wall.sigma_px = std::sqrt(squares / static_cast<double>(kept.size()));
  double aside = 0.0;
  for (const Echo& echo : kept) aside += (echo.x - wall.point_px.x()) * (echo.x - wall.point_px.x());
  wall.reach_px = std::sqrt(aside / static_cast<double>(kept.size())) / wall.direction.x();
  if (std::abs(std::atan(line->slope)) > options.max_tilt_rad) return std::nullopt;
  return wall;
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
  std::vector<std::optional<WallLine>> of_frame(recording.header().frames.size());
  for_each_image(recording, "a wall", progress, [&](int frame) {
    of_frame[static_cast<std::size_t>(frame)] = detect_wall_in_image(recording.image(frame), options);
  });
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
