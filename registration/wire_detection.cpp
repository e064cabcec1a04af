#include "registration/wire_detection.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "core/statistics.h"

namespace fathom {

namespace {

constexpr int kFramesPerReport = 16;  // searched in some tenths of a second
// Two orientations are equally good when their readings differ by less than this share of the points.
constexpr double kTie = 0.05;
// Orientation and scale are believed when at least this share of the frames looked at agrees, and at least one.
constexpr double kLeastShare = 0.1;
// Side from which PLUS's phantoms are looked at, where nothing tells.
constexpr ImageOrientation kUsualSide = ImageOrientation::kWire0Right;

std::string described(FrameWires outcome) {
  switch (outcome) {
    case FrameWires::kFound:
      return "show the wires";
    case FrameWires::kNoImage:
      return "have no valid image";
    case FrameWires::kTooFewSpots:
      return "have fewer bright spots than the phantom needs";
    case FrameWires::kNoMatch:
      return "have no spots that fit the phantom";
  }
  return {};
}

std::size_t fewest_spots(const WirePhantom& phantom, bool scale_known) {
  const std::size_t count = phantom.patterns.size();
  return 3 * (scale_known && count >= 3 ? count - 1 : count);
}

/// How an orientation does over the frames that decide.
struct Verdict {
  double points = 0.0;
  int frames = 0;
  double misfit = 0.0;  ///< mean over the frames, of the phantom's width
  Eigen::Vector2d pixel_mm = Eigen::Vector2d::Zero();
};

Verdict judge(const std::vector<const std::vector<BrightSpot>*>& frames, const WirePhantom& phantom,
              ImageOrientation orientation, const WireDetectionOptions& options) {
  std::vector<std::optional<WireMatch>> matches(frames.size());
  cv::parallel_for_(cv::Range(0, static_cast<int>(frames.size())), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      matches[at] = identify_wires(*frames[at], phantom, orientation, options.pixel_mm, options.match);
    }
  });
  Verdict verdict;
  std::vector<double> widths;
  std::vector<double> heights;
  for (const auto& match : matches) {
    if (!match) continue;
    ++verdict.frames;
    verdict.points += match->points;
    verdict.misfit += match->rms_mm / phantom_width_mm(phantom);
    widths.push_back(match->pixel_mm.x());
    heights.push_back(match->pixel_mm.y());
  }
  if (verdict.frames > 0) {
    verdict.misfit /= verdict.frames;
    verdict.pixel_mm = {median(widths), median(heights)};
  }
  return verdict;
}

bool clearly_better(const Verdict& a, const Verdict& b) { return a.points > (1.0 + kTie) * b.points && a.frames > 0; }

std::vector<ImageOrientation> upright_orientations(const WireDetectionOptions& options) {
  if (options.wire_0_left) {
    return {*options.wire_0_left ? ImageOrientation::kWire0Left : ImageOrientation::kWire0Right};
  }
  return {ImageOrientation::kWire0Right, ImageOrientation::kWire0Left};
}

/// Points of a match that are where the wire was seen. Points whose spot was cut off are left out.
void append_points(const WireMatch& match, const std::vector<BrightSpot>& spots, int frame,
                   std::vector<WirePoint>& points) {
  for (std::size_t k = 0; k < match.spots.size(); ++k) {
    for (std::size_t wire = 0; wire < 3; ++wire) {
      const auto& spot = match.spots[k][wire];
      if (!spot || spots[*spot].cut_off) continue;
      points.push_back({frame, k, wire, spots[*spot].centre_px});
    }
  }
}

struct Decision {
  ImageOrientation orientation = kUsualSide;
  Eigen::Vector2d pixel_mm = Eigen::Vector2d::Zero();
  bool side_unknown = false;
};

std::string wrong_way(ImageOrientation orientation) {
  switch (orientation) {
    case ImageOrientation::kUpsideDownWire0Left:
    case ImageOrientation::kUpsideDownWire0Right:
      return "the wires are seen upside down, the first pattern at the bottom";
    case ImageOrientation::kFirstPatternLeft:
    case ImageOrientation::kFirstPatternLeftMirrored:
      return "the wires are seen turned by a right angle, the first pattern on the left";
    default:
      return "the wires are seen turned by a right angle, the first pattern on the right";
  }
}

/// Orientation and scale, from frames spread over the recording.
Decision decide(const std::vector<std::vector<BrightSpot>>& spots, const Recording& recording,
                const WirePhantom& phantom, const WireDetectionOptions& options, const WireDetection& so_far) {
  std::vector<const std::vector<BrightSpot>*> rich;
  for (const auto& of_frame : spots) {
    if (of_frame.size() >= fewest_spots(phantom, options.pixel_mm.has_value())) rich.push_back(&of_frame);
  }
  std::vector<const std::vector<BrightSpot>*> chosen;
  const std::size_t count = std::min(rich.size(), static_cast<std::size_t>(options.orientation_frames));
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(rich[i * rich.size() / count]);

  Verdict best;
  Decision decision;
  for (const ImageOrientation orientation : upright_orientations(options)) {
    const Verdict verdict = judge(chosen, phantom, orientation, options);
    if (clearly_better(verdict, best)) {
      decision = {orientation, verdict.pixel_mm, false};
      best = verdict;
    } else if (!clearly_better(best, verdict) && verdict.frames > 0) {
      decision.side_unknown = true;  // the usual side was first
    }
  }
  const auto enough = [&](const Verdict& verdict) {
    return verdict.frames > 0 && verdict.frames >= kLeastShare * static_cast<double>(chosen.size());
  };
  // A reading the wrong way round of some frames' clutter is not held against one that fits most frames.
  if (!enough(best) || best.frames < static_cast<int>(chosen.size() / 2)) {
    for (const ImageOrientation orientation : kImageOrientations) {
      if (is_upright(orientation)) continue;
      const Verdict verdict = judge(chosen, phantom, orientation, options);
      if (!enough(verdict) || !clearly_better(verdict, best)) continue;
      throw Error(
          recording.name() + ": " + wrong_way(orientation) +
          "; correct the recording's image orientation (MF: the probe at the top) or the phantom's description");
    }
  }
  if (!enough(best)) {
    WireDetection none = so_far;
    for (FrameWires& frame : none.frames) {
      if (frame == FrameWires::kFound) frame = FrameWires::kNoMatch;
    }
    throw Error(recording.name() + ": the wires of the phantom" +
                (phantom.name.empty() ? "" : " \"" + phantom.name + "\"") + " are not seen: " + summary(none) +
                "; check that this is the phantom and that all its wires are in view");
  }
  return decision;
}

}  // namespace

void WireDetectionOptions::check() const {
  spots.check();
  if (pixel_mm && !(pixel_mm->allFinite() && pixel_mm->minCoeff() > 0.0)) {
    throw Error("wire detection: the pixel size must be above 0 mm");
  }
  if (first < 0) throw Error("wire detection: the first frame cannot be before 0");
  if (last && *last < first) throw Error("wire detection: the last frame cannot be before the first");
  if (orientation_frames < 1) throw Error("wire detection: at least one frame must decide on the orientation");
}

int WireDetection::count(FrameWires outcome) const {
  return static_cast<int>(std::count(frames.begin(), frames.end(), outcome));
}

std::string summary(const WireDetection& detection) {
  std::string text = std::to_string(detection.frames_with_wires()) + " of " + std::to_string(detection.frames.size()) +
                     " frames " + described(FrameWires::kFound);
  for (const FrameWires outcome : kFrameWires) {
    const int count = detection.count(outcome);
    if (outcome != FrameWires::kFound && count > 0) text += ", " + std::to_string(count) + " " + described(outcome);
  }
  return text;
}

WireDetection find_wires(const Recording& recording, const WirePhantom& phantom, const WireDetectionOptions& options,
                         const Progress& progress) {
  options.check();
  require_usable(phantom);
  const RecordingHeader& header = recording.header();
  if (!header.has_images()) throw Error(recording.name() + ": has no images in which to look for wires");
  const int last = options.last.value_or(header.frame_count() - 1);
  if (last >= header.frame_count() || options.first > last) {
    throw Error(recording.name() + ": has no frames " + std::to_string(options.first) + " to " + std::to_string(last) +
                "; there are " + std::to_string(header.frame_count()) + ", numbered from 0");
  }
  const int count = last - options.first + 1;
  WireDetection detection;
  detection.first = options.first;
  detection.frames.assign(static_cast<std::size_t>(count), FrameWires::kFound);
  std::vector<std::vector<BrightSpot>> spots(static_cast<std::size_t>(count));
  for (int start = 0; start < count; start += kFramesPerReport) {
    report(progress, 0.9 * start / count);
    cv::parallel_for_(cv::Range(start, std::min(count, start + kFramesPerReport)), [&](const cv::Range& range) {
      for (int i = range.start; i < range.end; ++i) {
        const int frame = options.first + i;
        const auto at = static_cast<std::size_t>(i);
        if (!header.frames[static_cast<std::size_t>(frame)].image_valid()) {
          detection.frames[at] = FrameWires::kNoImage;
          continue;
        }
        spots[at] = find_bright_spots(recording.image(frame), options.spots);
        if (spots[at].size() < fewest_spots(phantom, true)) detection.frames[at] = FrameWires::kTooFewSpots;
      }
    });
  }
  report(progress, 0.9);
  const Decision decision = decide(spots, recording, phantom, options, detection);
  detection.pixel_mm = decision.pixel_mm;
  detection.wire_0_left = decision.orientation == ImageOrientation::kWire0Left;
  detection.side_unknown = decision.side_unknown;

  std::vector<std::optional<WireMatch>> matches(static_cast<std::size_t>(count));
  cv::parallel_for_(cv::Range(0, count), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (detection.frames[at] != FrameWires::kFound) continue;
      matches[at] = identify_wires(spots[at], phantom, decision.orientation, decision.pixel_mm, options.match);
    }
  });
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (detection.frames[at] != FrameWires::kFound) continue;
    if (matches[at]) {
      append_points(*matches[at], spots[at], options.first + i, detection.points);
    } else {
      detection.frames[at] = FrameWires::kNoMatch;
    }
  }
  report(progress, 1.0);
  return detection;
}

std::vector<WirePoint> detect_wires(const Recording& recording, const WirePhantom& phantom,
                                    const WireDetectionOptions& options, const Progress& progress) {
  return find_wires(recording, phantom, options, progress).points;
}

std::vector<WirePoint> detect_wires_in_image(const cv::Mat& image, const WirePhantom& phantom,
                                             const WireDetectionOptions& options) {
  options.check();
  const std::vector<BrightSpot> spots = find_bright_spots(image, options.spots);
  std::optional<WireMatch> best;
  for (const ImageOrientation orientation : upright_orientations(options)) {
    const std::optional<WireMatch> match = identify_wires(spots, phantom, orientation, options.pixel_mm, options.match);
    if (match && (!best || match->points > best->points)) best = match;
  }
  std::vector<WirePoint> points;
  if (best) append_points(*best, spots, 0, points);
  return points;
}

}  // namespace fathom
