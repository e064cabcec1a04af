#include "viewer/reslice_views.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "registration/find_sweeps.h"

namespace fathom {

namespace {

constexpr double kMostPixels = 400.0;  // along the longer side of a picture: as many as a pane shows

// As the Review pane shows grey values that nobody has changed.
cv::Mat shown(const cv::Mat& picture) {
  cv::Mat grey;
  if (picture.depth() == CV_8U) {
    grey = picture;
  } else {
    cv::normalize(picture, grey, 0.0, 255.0, cv::NORM_MINMAX, CV_8U);
  }
  cv::Mat rgba;
  cv::cvtColor(grey, rgba, cv::COLOR_GRAY2RGBA);
  return rgba;
}

// Outlines that cannot be measured, open ones without planes, leave no division; a picture can be made without.
std::optional<Division> division_if_any(const Document& document) {
  try {
    return document.division();
  } catch (const Error&) {
    return std::nullopt;
  }
}

// How far points reach to either side of the centre along an axis.
double reach(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& centre, const Eigen::Vector3d& axis) {
  double farthest = 1.0;
  for (const Eigen::Vector3d& point : points) farthest = std::max(farthest, std::abs((point - centre).dot(axis)));
  return farthest;
}

}  // namespace

std::optional<std::array<Eigen::Vector2d, 2>> crossing(const CutPlane& plane, const Eigen::Vector3d& normal,
                                                       const Eigen::Vector3d& point_mm) {
  // In the picture: a * right + b * down = c.
  const double a = normal.dot(plane.right);
  const double b = normal.dot(plane.down);
  const double c = normal.dot(point_mm - plane.centre_mm);
  const double length2 = a * a + b * b;
  if (length2 < 1e-8) return std::nullopt;
  const Eigen::Vector2d foot(a * c / length2, b * c / length2);
  const Eigen::Vector2d way = Eigen::Vector2d(-b, a) / std::sqrt(length2);
  const Eigen::Vector2d half(0.5 * plane.width_mm, 0.5 * plane.height_mm);
  double low = -1e9;
  double high = 1e9;
  for (int k = 0; k < 2; ++k) {
    if (std::abs(way[k]) < 1e-12) {
      if (std::abs(foot[k]) > half[k]) return std::nullopt;
      continue;
    }
    const double one = (-half[k] - foot[k]) / way[k];
    const double other = (half[k] - foot[k]) / way[k];
    low = std::max(low, std::min(one, other));
    high = std::min(high, std::max(one, other));
  }
  if (low >= high) return std::nullopt;
  return std::array<Eigen::Vector2d, 2>{foot + low * way, foot + high * way};
}

void ResliceViews::reset(const Document& document, int recording) {
  scan_ = document.scan();
  recording_ = recording;
  made_of_ = {document.placement_revision(), document.division_revision()};
  reslicer_ = nullptr;
  partition_ = nullptr;
  for (View& view : views_) view = View();
  const auto index = static_cast<std::size_t>(recording);
  const Recording& source = *scan_->recordings[index];
  const FrameLocator& locator = scan_->locators[index];
  try {
    const std::vector<PlacedFrame> frames = placed_frames(source, locator);
    if (frames.empty()) throw Error(source.name() + ": no frame has a place in space");
    std::vector<Sweep> sweeps = find_sweeps(source, locator);
    const std::optional<Division> division = division_if_any(document);
    if (division && scan_->recordings.size() == 1) {
      sweeps = division->sweeps;
      if (!division->partition.planes().empty()) partition_ = std::make_shared<SpacePartition>(division->partition);
    }
    reslicer_ = std::make_shared<const Reslicer>(source, locator, sweeps);
    const Eigen::Affine3d& middle = frames[frames.size() / 2].reference_from_image;
    const double width = source.header().width - 1;
    const double height = source.header().height - 1;
    std::vector<Eigen::Vector3d> corners;
    const std::size_t step = std::max<std::size_t>(1, frames.size() / 50);
    for (std::size_t i = 0; i < frames.size(); i += step) {
      for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0, 0), Eigen::Vector2d(width, 0),
                                            Eigen::Vector2d(width, height), Eigen::Vector2d(0, height)}) {
        corners.push_back(frames[i].reference_from_image * Eigen::Vector3d(corner.x(), corner.y(), 0.0));
      }
    }
    const Eigen::Vector3d across = middle.linear().col(0).normalized();
    const Eigen::Vector3d along = frame_normal(middle);
    const Eigen::Vector3d depth = along.cross(across);
    const Eigen::Vector3d centre = middle * Eigen::Vector3d(0.5 * width, 0.5 * height, 0.0);
    const auto plane = [&](const Eigen::Vector3d& right, const Eigen::Vector3d& down) {
      return CutPlane{centre, right, down, 2.0 * reach(corners, centre, right), 2.0 * reach(corners, centre, down)};
    };
    views_[0].plane = plane(along, depth);
    views_[1].plane = plane(across, along);
    double longest = 1.0;
    for (const View& view : views_) longest = std::max({longest, view.plane.width_mm, view.plane.height_mm});
    spacing_mm_ = std::max(pixel_size_mm(middle), longest / kMostPixels);
    for (CutPlane& asked : asked_) asked.width_mm = -1.0;
  } catch (const Error& error) {
    for (View& view : views_) view.error = error.what();
  }
}

void ResliceViews::update(const Document& document, int recording, Worker& worker) {
  const std::array<std::uint64_t, 2> now{document.placement_revision(), document.division_revision()};
  if (scan_ != document.scan() || recording != recording_ || made_of_ != now) {
    const bool same_place = scan_ == document.scan() && recording == recording_ && made_of_[0] == now[0];
    const std::array<View, kCount> before = views_;
    reset(document, recording);
    // Another division changes what is shown, not where: the picture before is there until the new one is.
    if (same_place && before[0].error.empty()) views_ = before;
  }
  if (!reslicer_) return;
  for (std::size_t i = 0; i < kCount; ++i) {
    if (!(asked_[i] == views_[i].plane)) start(i, document, worker);
  }
}

void ResliceViews::start(std::size_t index, const Document& document, Worker& worker) {
  asked_[index] = views_[index].plane;
  const CutPlane plane = views_[index].plane;
  const auto work = [this, index, plane, scan = document.scan(), reslicer = reslicer_, partition = partition_,
                     spacing = spacing_mm_](const Progress& progress) -> std::function<void()> {
    ReslicePlane wanted;
    wanted.x_axis = plane.right;
    wanted.y_axis = plane.down;
    wanted.spacing_mm = spacing;
    wanted.size = {pixels_along(plane.width_mm, spacing), pixels_along(plane.height_mm, spacing)};
    wanted.origin_mm = plane.at(-0.5 * spacing * (wanted.size.width - 1), -0.5 * spacing * (wanted.size.height - 1));
    ResliceOptions options;
    options.mode = ResliceMode::kLinear;
    const cv::Mat rgba = shown(reslicer->reslice(plane_surface(wanted), options, partition.get(), progress).picture);
    return [this, index, rgba, reslicer] {
      if (reslicer != reslicer_) return;  // of what was open before
      views_[index].rgba = rgba;
      views_[index].number = ++pictures_;
      views_[index].error.clear();
    };
  };
  worker.start({"reslice:" + std::to_string(index), "Reslice " + std::to_string(index + 1), work,
                [this, index](const std::string& error) { views_[index].error = error; }});
}

}  // namespace fathom
