#include "registration/wall_profile.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace fathom {

namespace {

constexpr int kParts = 24;           // of a wall that spans the image: some beams' widths each
constexpr double kDip = 0.05;        // of the height, by which an echo must fall for its ridge to be past
constexpr double kTop = 0.95;        // of the height, above which a band is even
constexpr double kCap = 0.8;         // of the height, above which a ridge is like a parabola
constexpr double kWidestPeak = 1.3;  // width of the top by that of the flank: more is a band
constexpr double kLeastRise = 0.3;   // of the profile's brightest, of an echo's height

/// First index from `from` on, in steps of `step`, at which `value` is below `level`.
std::optional<int> falls_below(const std::vector<double>& value, int from, int step, double level) {
  for (int i = from; i >= 0 && i < static_cast<int>(value.size()); i += step) {
    if (value[static_cast<std::size_t>(i)] < level) return i;
  }
  return std::nullopt;
}

/// Where the line between two neighbouring samples passes a level.
double crossing(const std::vector<double>& value, int below, int above, double level) {
  const double low = value[static_cast<std::size_t>(below)];
  const double high = value[static_cast<std::size_t>(above)];
  return below + (above - below) * (level - low) / (high - low);
}

/// The top of the parabola through the samples from `first` to `last`; empty where they do not curve down.
std::optional<double> parabola_top(const std::vector<double>& value, int first, int last) {
  const double middle = 0.5 * (first + last);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int i = first; i <= last; ++i) {
    const double u = i - middle;
    const Eigen::Vector3d row(1.0, u, u * u);
    normal += row * row.transpose();
    right += row * value[static_cast<std::size_t>(i)];
  }
  const Eigen::Vector3d fit = normal.ldlt().solve(right);
  if (!fit.allFinite() || !(fit[2] < 0.0)) return std::nullopt;
  const double top = middle - fit[1] / (2.0 * fit[2]);
  if (top < first || top > last) return std::nullopt;
  return top;
}

}  // namespace

std::optional<WallProfile> locate_wall(const std::vector<double>& brightness, double first_echo) {
  const auto count = static_cast<int>(brightness.size());
  if (count < 5) return std::nullopt;
  const auto [low, high] = std::minmax_element(brightness.begin(), brightness.end());
  const double range = *high - *low;
  if (!(range > kLeastRise * *high)) return std::nullopt;
  int ridge = 0;
  while (brightness[static_cast<std::size_t>(ridge)] < *low + first_echo * range) ++ridge;
  for (int i = ridge + 1; i < count && brightness[static_cast<std::size_t>(i)] >
                                           brightness[static_cast<std::size_t>(ridge)] - kDip * range;
       ++i) {
    if (brightness[static_cast<std::size_t>(i)] > brightness[static_cast<std::size_t>(ridge)]) ridge = i;
  }
  // Above the echo there is water; below it may ring on.
  double water = 0.0;
  const auto rise =
      falls_below(brightness, ridge, -1, *low + 0.5 * (brightness[static_cast<std::size_t>(ridge)] - *low));
  if (!rise || *rise < 1) return std::nullopt;
  const int clear = std::max(1, 2 * *rise - ridge);
  for (int i = 0; i < clear; ++i) water += brightness[static_cast<std::size_t>(i)] / clear;
  const double height = brightness[static_cast<std::size_t>(ridge)] - water;
  const auto level = [&](double share) { return water + share * height; };
  const auto half = falls_below(brightness, ridge, -1, level(0.5));
  const auto top_before = falls_below(brightness, ridge, -1, level(kTop));
  const auto top_after = falls_below(brightness, ridge, 1, level(kTop));
  const auto cap_before = falls_below(brightness, ridge, -1, level(kCap));
  const auto cap_after = falls_below(brightness, ridge, 1, level(kCap));
  if (!half || !top_before || !top_after || !cap_before) return std::nullopt;
  WallProfile place;
  place.edge = crossing(brightness, *half, *half + 1, level(0.5));
  const double first_top = crossing(brightness, *top_before, *top_before + 1, level(kTop));
  const double last_top = crossing(brightness, *top_after, *top_after - 1, level(kTop));
  const auto top = cap_after ? parabola_top(brightness, *cap_before + 1, *cap_after - 1) : std::nullopt;
  place.peaked = top && last_top - first_top <= kWidestPeak * (first_top - place.edge);
  place.ridge = top.value_or(0.5 * (first_top + last_top));
  return place;
}

std::vector<WallPart> wall_parts(const cv::Mat& grey, const WallSlope& line, const std::vector<int>& columns, int reach,
                                 double first_echo) {
  std::vector<WallPart> parts;
  const auto stride = std::max(std::size_t{1}, static_cast<std::size_t>(grey.cols / kParts));
  for (std::size_t first = 0; first + stride <= columns.size(); first += stride) {
    WallPart part;
    std::vector<double> mean(static_cast<std::size_t>(2 * reach + 1), 0.0);
    int used = 0;
    for (std::size_t i = first; i < first + stride; ++i) {
      const double start = line.y(columns[i]) - reach;
      const double above = std::floor(start);
      const auto row = static_cast<int>(above);
      if (row < 0 || row + 2 * reach + 1 >= grey.rows) continue;
      const auto share = start - above;
      for (int k = 0; k <= 2 * reach; ++k) {
        mean[static_cast<std::size_t>(k)] += (1.0 - share) * static_cast<double>(grey.at<float>(row + k, columns[i])) +
                                             share * static_cast<double>(grey.at<float>(row + k + 1, columns[i]));
      }
      part.x += columns[i];
      ++used;
    }
    if (2 * used < static_cast<int>(stride)) continue;
    part.x /= used;
    for (double& value : mean) value /= used;
    const auto place = locate_wall(mean, first_echo);
    if (!place) continue;
    part.place = *place;
    const double down = line.y(part.x) - reach;
    part.place.ridge += down;
    part.place.edge += down;
    parts.push_back(part);
  }
  return parts;
}

}  // namespace fathom
