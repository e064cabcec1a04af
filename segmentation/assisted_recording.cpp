#include "segmentation/assisted_recording.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "core/error.h"
#include "segmentation/outline_topology.h"

namespace fathom {

namespace {

std::string frame_name(const Recording& from, int frame) { return from.name() + ": frame " + std::to_string(frame); }

void require_images(const Recording& from) {
  if (from.header().has_images()) return;
  throw Error(from.name() + ": has no images, only poses; give a recording with images");
}

// Says on which frame a tool failed.
template <typename Work>
auto on_frame(const Recording& from, int frame, Work&& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(frame_name(from, frame) + ": " + error.what());
  }
}

void append(std::vector<Contour>& contours, std::vector<Polygon> outlines, int frame, int recording) {
  for (Polygon& outline : outlines) {
    Contour contour;
    contour.frame = frame;
    contour.recording = recording;
    contour.points_px = std::move(outline);
    contours.push_back(std::move(contour));
  }
}

std::map<int, std::vector<const FrameSeeds*>> by_frame(const std::vector<FrameSeeds>& seeds, int recording) {
  std::map<int, std::vector<const FrameSeeds*>> frames;
  for (const FrameSeeds& one : seeds) {
    if (one.recording == recording) frames[one.frame].push_back(&one);
  }
  return frames;
}

Polygon wire_around(const cv::Mat& image, const FrameSeeds& seeds, const LiveWireOptions& options) {
  LiveWire wire(image, options);
  for (const Eigen::Vector2d& point : seeds.points_px) wire.add_seed(point);
  wire.close();
  return wire.line();
}

// The contours of a structure by recording and frame.
using FrameKey = std::pair<int, int>;
std::map<FrameKey, std::vector<Contour>> grouped(const std::vector<Contour>& contours) {
  std::map<FrameKey, std::vector<Contour>> frames;
  for (const Contour& contour : contours) frames[{contour.recording, contour.frame}].push_back(contour);
  return frames;
}

std::vector<Polygon> polygons_of(const std::vector<Contour>& contours) {
  std::vector<Polygon> polygons;
  for (const Contour& contour : contours) polygons.push_back(contour.points_px);
  return polygons;
}

bool all_closed(const std::vector<Contour>& contours) {
  return std::all_of(contours.begin(), contours.end(), [](const Contour& contour) { return contour.closed; });
}

// The closed outlines of all structures but one on a frame.
std::vector<Polygon> outlines_of_others(const std::vector<Structure>& structures, std::size_t which,
                                        const FrameKey& frame) {
  std::vector<Polygon> outlines;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    if (i == which) continue;
    for (const Contour& contour : structures[i].contours) {
      if (FrameKey{contour.recording, contour.frame} == frame && contour.closed) outlines.push_back(contour.points_px);
    }
  }
  return outlines;
}

using Entries = std::vector<const FrameSeeds*>;

// The outlines that `outline` finds on every frame with seeds.
template <typename Outline>
std::vector<Contour> on_seeded_frames(const Recording& from, int recording, const std::vector<FrameSeeds>& seeds,
                                      const Progress& progress, const Outline& outline) {
  require_images(from);
  require_seeds_on_images(seeds, from, recording);
  std::vector<Contour> contours;
  const auto frames = by_frame(seeds, recording);
  double done = 0.0;
  for (const auto& [frame, entries] : frames) {
    report(progress, done++ / static_cast<double>(frames.size()));
    append(contours, outline(frame, entries), frame, recording);
  }
  return contours;
}

}  // namespace

std::vector<Contour> outline_by_seeds(const Recording& from, int recording, const std::vector<FrameSeeds>& seeds,
                                      const LiveWireOptions& options, const Progress& progress) {
  options.check();
  return on_seeded_frames(from, recording, seeds, progress, [&](int frame, const Entries& entries) {
    const cv::Mat image = from.image(frame);
    std::vector<Polygon> outlines;
    for (const FrameSeeds* entry : entries) {
      outlines.push_back(on_frame(from, frame, [&] { return wire_around(image, *entry, options); }));
    }
    if (const auto fault = outline_fault(outlines)) {
      throw Error(frame_name(from, frame) + ": an outline " + *fault + "; place its seeds nearer to each other there");
    }
    return outlines;
  });
}

std::vector<Contour> outline_regions(const Recording& from, int recording, const std::vector<FrameSeeds>& seeds,
                                     const RegionOptions& options, const Progress& progress) {
  options.check();
  return on_seeded_frames(from, recording, seeds, progress, [&](int frame, const Entries& entries) {
    std::vector<Eigen::Vector2d> points;
    for (const FrameSeeds* entry : entries) {
      points.insert(points.end(), entry->points_px.begin(), entry->points_px.end());
    }
    return on_frame(from, frame, [&] { return grow_region(from.image(frame), points, options); });
  });
}

void refine_structure(const Recording& from, int recording, const RefineOptions& options,
                      std::vector<Structure>& structures, std::size_t which, const Progress& progress) {
  options.check();
  require_images(from);
  const RecordingHeader& header = from.header();
  Structure& structure = structures[which];
  std::map<FrameKey, std::vector<Contour>> frames = grouped(structure.contours);
  std::vector<FrameKey> moved;
  for (const auto& [key, contours] : frames) {
    if (key.first != recording) continue;
    if (key.second >= header.frame_count()) {
      throw Error(frame_name(from, key.second) + " is outlined, but not there; give the contours of this recording");
    }
    const bool valid = header.frames[static_cast<std::size_t>(key.second)].image_valid();
    if (valid && all_closed(contours)) moved.push_back(key);
  }
  // Twice through the images rather than all edges in memory.
  std::vector<EdgePreference> learnt;
  const double steps = 2.0 * static_cast<double>(moved.size());
  double done = 0.0;
  for (const FrameKey& key : moved) {
    report(progress, done++ / steps);
    learnt.push_back(on_frame(from, key.second, [&] {
      return learn_boundary(edge_map(from.image(key.second), options.edges), polygons_of(frames[key]), options);
    }));
  }
  const EdgePreference boundary = together(learnt);
  for (const FrameKey& key : moved) {
    report(progress, done++ / steps);
    std::vector<Contour> contours;
    append(contours,
           on_frame(from, key.second,
                    [&] {
                      return refine_outlines(edge_map(from.image(key.second), options.edges), polygons_of(frames[key]),
                                             boundary, options, outlines_of_others(structures, which, key));
                    }),
           key.second, recording);
    frames[key] = std::move(contours);
  }
  structure.contours.clear();
  for (auto& [key, contours] : frames) {
    structure.contours.insert(structure.contours.end(), contours.begin(), contours.end());
  }
}

void FinishOptions::check() const {
  clean.check();
  evened_out({}, smooth_px);
}

void finish(const FinishOptions& options, Structure& structure) {
  options.check();
  const CleanOptions& clean = options.clean;
  const bool cleans =
      clean.close_px > 0.0 || clean.open_px > 0.0 || clean.min_part_px > 0.0 || clean.fill_holes_px > 0.0;
  if (!cleans && options.smooth_px == 0.0) return;
  std::vector<Contour> finished;
  for (const auto& [key, contours] : grouped(structure.contours)) {
    std::vector<Polygon> outlines = polygons_of(contours);
    if (!all_closed(contours) || outline_fault(outlines)) {
      finished.insert(finished.end(), contours.begin(), contours.end());
      continue;
    }
    if (cleans) outlines = cleaned(outlines, clean);
    append(finished, evened_out(outlines, options.smooth_px), key.second, key.first);
  }
  structure.contours = std::move(finished);
}

}  // namespace fathom
