#include "sim/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "core/random.h"
#include "sim/scene_constants.h"
#include "sim/section.h"

namespace fathom {

namespace {

constexpr double kSigmaOfWidth = 1.0 / 2.354820045;
constexpr int kPatternStep = 8;  // pixels between which the pattern is interpolated: its waves are 20 times longer
constexpr int kSurfaceLines = 3000;

enum class Stream : std::uint64_t { kWaves = 11, kSurface = 12, kShadows = 13 };

Random random_stream(std::uint64_t seed, Stream stream) {
  return Random(seed ^ (static_cast<std::uint64_t>(stream) * 0x9E3779B97F4A7C15u));
}

Eigen::Vector3d unit_vector(Random& random) {
  const Eigen::Vector3d vector(random.normal(), random.normal(), random.normal());
  return vector.normalized();
}

/// The next place where the solid's surface is crossed, in millimetres along the line; past `end_mm` if nowhere.
double next_crossing_mm(const Solid& solid, const Eigen::Vector3d& start, const Eigen::Vector3d& direction, double at,
                        double end_mm) {
  constexpr double kLeastStep_mm = 0.05;
  const bool inside = solid.distance_bound_mm(start + at * direction) <= 0.0;
  while (at <= end_mm) {
    const double bound = solid.distance_bound_mm(start + at * direction);
    if ((bound <= 0.0) != inside) break;
    at += std::max(std::abs(bound), kLeastStep_mm);
  }
  return at;
}

double width_mm(const Eigen::Affine3d& map, int axis) { return map.linear().col(axis).norm(); }

/// Where a body is seen, 0 to 1: its section, blurred by the resolution.
cv::Mat share_seen(const cv::Mat& mask, const SpeckleOptions& speckle, const Eigen::Affine3d& map) {
  cv::Mat share;
  mask.convertTo(share, CV_32F, 1.0 / 255.0);
  cv::GaussianBlur(share, share, cv::Size(0, 0), speckle.lateral_mm * kSigmaOfWidth / width_mm(map, 0),
                   speckle.axial_mm * kSigmaOfWidth / width_mm(map, 1), cv::BORDER_REPLICATE);
  return share;
}

/// At places of dropout the echoes of one side spread into the other, so that nothing happens at the outline: from
/// outside in where the pattern is positive, from inside out where it is negative.
void drop_out(cv::Mat& share, const cv::Mat& mask, const cv::Mat& pattern, double threshold, double pixel_mm) {
  cv::Mat outside;
  cv::bitwise_not(mask, outside);
  cv::Mat depth_in;
  cv::Mat depth_out;
  cv::distanceTransform(mask, depth_in, cv::DIST_L2, 3);
  cv::distanceTransform(outside, depth_out, cv::DIST_L2, 3);
  const auto band_px = static_cast<float>(scene::kDropoutBand_mm / pixel_mm);
  const auto limit = static_cast<float>(threshold);
  const auto fade = static_cast<float>(scene::kDropoutFade * threshold);
  for (int y = 0; y < share.rows; ++y) {
    auto* s = share.ptr<float>(y);
    const auto* p = pattern.ptr<float>(y);
    const auto* in = depth_in.ptr<float>(y);
    const auto* out = depth_out.ptr<float>(y);
    for (int x = 0; x < share.cols; ++x) {
      const float hidden = std::clamp(0.5F + (std::abs(p[x]) - limit) / (2.0F * fade), 0.0F, 1.0F);
      const float depth = (p[x] > 0.0F ? in[x] : out[x]) / band_px;
      if (hidden == 0.0F || depth > 3.0F) continue;
      const float spread = hidden * std::exp(-depth * depth);
      s[x] = p[x] > 0.0F ? s[x] * (1.0F - spread) : s[x] + spread * (1.0F - s[x]);
    }
  }
}

}  // namespace

Scene::Scene(std::vector<SceneBody> bodies, std::uint64_t seed)
    : bodies_(std::move(bodies)), speckle_(scene::speckle(seed)), field_(speckle_) {
  Random random = random_stream(seed, Stream::kWaves);
  for (Wave& wave : waves_) {
    const double length_mm = scene::kDropoutWave_mm * random.uniform(1.0, 2.0);
    wave = {unit_vector(random) * (2.0 * std::numbers::pi / length_mm), random.uniform(0.0, 2.0 * std::numbers::pi)};
  }
  threshold_ = pattern_quantile(1.0 - scene::kDropout, seed);
  place_shadows(seed);
}

double Scene::pattern(const Eigen::Vector3d& x_mm) const {
  double sum = 0.0;
  for (const Wave& wave : waves_) sum += std::sin(wave.per_mm.dot(x_mm) + wave.phase_rad);
  return sum / std::sqrt(0.5 * static_cast<double>(waves_.size()));
}

/// Over the bodies' surfaces: random lines meet equal areas equally often (Crofton).
double Scene::pattern_quantile(double share, std::uint64_t seed) const {
  Random random = random_stream(seed, Stream::kSurface);
  std::vector<double> values;
  for (const SceneBody& body : bodies_) {
    if (!body.drops_out) continue;
    const double reach = body.solid->radius_mm();
    for (int i = 0; i < kSurfaceLines; ++i) {
      const Eigen::Vector3d direction = unit_vector(random);
      const Eigen::Vector3d aside = direction.unitOrthogonal();
      const double distance = reach * std::sqrt(random.uniform());
      const double turn = 2.0 * std::numbers::pi * random.uniform();
      const Eigen::Vector3d start =
          distance * (std::cos(turn) * aside + std::sin(turn) * direction.cross(aside)) - reach * direction;
      for (double at = 0.0; at <= 2.0 * reach;) {
        at = next_crossing_mm(*body.solid, start, direction, at, 2.0 * reach);
        if (at <= 2.0 * reach) values.push_back(std::abs(pattern(start + at * direction)));
      }
    }
  }
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

void Scene::place_shadows(std::uint64_t seed) {
  Random random = random_stream(seed, Stream::kShadows);
  double reach = 0.0;
  for (const SceneBody& body : bodies_) reach = std::max(reach, body.solid->radius_mm());
  const double radius = scene::kShadowRadius * reach;
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  std::vector<SceneBody> shadows;
  while (shadows.size() < scene::kShadows) {
    const Eigen::Vector3d start(random.uniform(-reach, reach), random.uniform(-reach, reach), 1.2 * reach);
    double height = 2.4 * reach;
    for (const SceneBody& body : bodies_) {
      height = std::min(height, next_crossing_mm(*body.solid, start, down, 0.0, 2.4 * reach));
    }
    if (height >= 2.4 * reach) continue;
    // Just above the surface, aside of which nothing of the body may lie.
    const Eigen::Vector3d centre = start + (height - 1.5 * radius) * down;
    std::shared_ptr<const Solid> ball = make_limbed_ball(centre, radius, {});
    shadows.push_back({std::move(ball), scene::kShadowEcho_db, scene::kShadow_db / (2.0 * radius), false});
  }
  // Below the bodies, which must be seen where they reach into one.
  bodies_.insert(bodies_.begin(), shadows.begin(), shadows.end());
}

cv::Mat Scene::pattern_image(const Eigen::Affine3d& map, cv::Size size) const {
  const cv::Size coarse(size.width / kPatternStep + 2, size.height / kPatternStep + 2);
  cv::Mat values(coarse, CV_32FC1);
  for (int y = 0; y < coarse.height; ++y) {
    for (int x = 0; x < coarse.width; ++x) {
      values.at<float>(y, x) =
          static_cast<float>(pattern(map * Eigen::Vector3d(x * kPatternStep, y * kPatternStep, 0.0)));
    }
  }
  cv::Mat result;
  const cv::Matx23d fine_to_coarse(1.0 / kPatternStep, 0.0, 0.0, 0.0, 1.0 / kPatternStep, 0.0);
  cv::warpAffine(values, result, fine_to_coarse, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return result;
}

cv::Mat Scene::level_db(const Eigen::Affine3d& map, cv::Size size) const {
  const cv::Mat pattern = pattern_image(map, size);
  cv::Mat level(size, CV_32FC1, cv::Scalar(0));
  cv::Mat gain_per_row(size, CV_32FC1, cv::Scalar(0));
  const auto row_mm = static_cast<float>(width_mm(map, 1));
  for (const SceneBody& body : bodies_) {
    const cv::Mat mask = section_image(*body.solid, map, size);
    if (cv::countNonZero(mask) == 0) continue;
    cv::Mat share = share_seen(mask, speckle_, map);
    if (body.drops_out) {
      drop_out(share, mask, pattern, threshold_, std::sqrt(width_mm(map, 0) * width_mm(map, 1)));
    }
    const auto body_level = static_cast<float>(body.level_db);
    for (int y = 0; y < size.height; ++y) {
      auto* to = level.ptr<float>(y);
      const auto* s = share.ptr<float>(y);
      for (int x = 0; x < size.width; ++x) to[x] += s[x] * (body_level - to[x]);
    }
    if (body.behind_db_per_mm != 0.0) gain_per_row.setTo(body.behind_db_per_mm * row_mm, mask);
  }
  std::vector<float> behind(static_cast<std::size_t>(size.width), 0.0F);
  const auto most = static_cast<float>(scene::kMostBehind_db);
  for (int y = 0; y < size.height; ++y) {
    auto* to = level.ptr<float>(y);
    const auto* gain = gain_per_row.ptr<float>(y);
    const auto attenuation = static_cast<float>(speckle_.attenuation_db_per_mm) * row_mm * static_cast<float>(y);
    for (int x = 0; x < size.width; ++x) {
      float& sum = behind[static_cast<std::size_t>(x)];
      sum = std::clamp(sum + gain[x], -most, most);
      to[x] += sum - attenuation;
    }
  }
  return level;
}

cv::Mat Scene::image(const Eigen::Affine3d& map, cv::Size size) const {
  cv::Mat amplitude = field_.amplitude(map, size);
  cv::Mat gain = level_db(map, size);
  const double log_of_db = std::log(10.0) / 20.0;
  gain.convertTo(gain, CV_32F, log_of_db, log_of_db * speckle_.tissue_db);
  cv::exp(gain, gain);
  cv::multiply(amplitude, gain, amplitude);
  return log_compressed(amplitude, speckle_.dynamic_range_db);
}

}  // namespace fathom
