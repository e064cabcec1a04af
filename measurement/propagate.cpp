#include "measurement/propagate.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/error.h"
#include "measurement/frame_marks.h"
#include "measurement/predicted_outline.h"
#include "measurement/propagated_run.h"
#include "measurement/section_raster.h"

namespace fathom {

namespace {

constexpr double kLeastArea_px = 12.0;   // smaller parts and holes are noise
constexpr double kApart_blocks = 0.05;   // kept between structures that touch
constexpr double kMeantToOverlap = 0.1;  // of the smaller structure: more than drawn lines that meet overlap by

// The probability of Dice >= 0.9, by a logistic regression on simulated sweeps with seeds of their own
// (docs/results.md says how).
constexpr double kConfidenceConstant = -2.397;
constexpr double kConfidenceOfError = -0.998;
constexpr double kConfidenceOfMove = -0.051;
constexpr double kConfidenceOfChange = -1.340;
constexpr double kLeastFault = 0.002;  // of 1 - Dice, that a logarithm is taken of

double confidence_of(const FilledFrame& frame) {
  const auto logarithm = [](double fault) { return std::log(std::max(fault, kLeastFault)); };
  const double score = kConfidenceConstant + kConfidenceOfError * logarithm(frame.expected_error) +
                       kConfidenceOfMove * logarithm(frame.moved) + kConfidenceOfChange * logarithm(frame.change);
  return 1.0 / (1.0 + std::exp(-score));
}

/// Places of all frames, empty where unknown. Without poses the frames are parallel, a pixel apart.
std::vector<std::optional<CarriedPlane>> places_of(const Recording& recording, const FrameLocator* locator) {
  if (locator != nullptr) return carried_planes(*locator);
  std::vector<std::optional<CarriedPlane>> places;
  for (int frame = 0; frame < recording.header().frame_count(); ++frame) {
    CarriedPlane place;
    place.plane.origin_mm.z() = frame;
    places.emplace_back(place);
  }
  return places;
}

Structure without_earlier_results(Structure structure) {
  std::erase_if(structure.contours, [](const Contour& contour) { return contour.confidence.has_value(); });
  return structure;
}

std::vector<DrawnSection> drawn_sections(const Structure& structure, const Recording& recording,
                                         const std::vector<std::optional<CarriedPlane>>& places) {
  const auto marks = frame_marks(structure, recording.name(), recording.header().frame_count());
  std::vector<Polygon> all;
  for (const FrameMarks& mark : marks) {
    for (const Polygon* outline : mark.outlines) all.push_back(*outline);
  }
  if (all.empty()) return {};
  const PixelGrid grid = grid_around(all, 0.0);
  std::vector<DrawnSection> sections;
  for (const FrameMarks& mark : marks) {
    const auto& place = places[static_cast<std::size_t>(mark.frame)];
    if (!place) continue;
    DrawnSection section{mark.frame, *place, nullptr, {}};
    const double cell_mm = block_mm(*place, grid);
    if (mark.absent) {
      section.shape = std::make_shared<SectionShape>();
    } else if (mark.extremity_px != nullptr) {
      section.shape = std::make_shared<SectionShape>(place->ab_from_image * *mark.extremity_px, cell_mm);
    } else {
      std::vector<Polygon> outlines_mm;
      for (const Polygon* outline : mark.outlines) {
        section.outlines_px.push_back(*outline);
        outlines_mm.emplace_back();
        for (const Eigen::Vector2d& point : *outline) outlines_mm.back().push_back(place->ab_from_image * point);
      }
      const SectionRaster raster = section_raster(outlines_mm, cell_mm);
      section.shape = std::make_shared<SectionShape>(std::move(outlines_mm), raster);
    }
    sections.push_back(std::move(section));
  }
  return sections;
}

/// Why nothing leads from one drawn section to the next; empty where it can.
std::string obstacle(const DrawnSection& first, const DrawnSection& second, std::span<const Sweep> sweeps) {
  const auto sweep_of = [&](int frame) {
    return std::find_if(sweeps.begin(), sweeps.end(), [&](const Sweep& sweep) { return contains(sweep, frame); }) -
           sweeps.begin();
  };
  if (!sweeps.empty() && sweep_of(first.frame) != sweep_of(second.frame)) {
    return "they are of different sweeps, between which the probe was moved or stood still; outline frames of each "
           "sweep";
  }
  if (first.place.run != second.place.run) {
    return "the probe was turned round between them; outline frames before and after the turn";
  }
  return {};
}

/// One structure's filled frames.
struct Filled {
  std::vector<FilledFrame> frames;
  std::vector<DrawnSection> drawn;
};

using Places = std::vector<std::optional<CarriedPlane>>;

std::vector<OpenFrame> open_frames(const Recording& recording, const Places& places, int after, int before, int every) {
  std::vector<OpenFrame> frames;
  for (int frame = after + every; frame < before; frame += every) {
    const auto& place = places[static_cast<std::size_t>(frame)];
    if (place && recording.header().frames[static_cast<std::size_t>(frame)].image_valid()) {
      frames.push_back({frame, *place});
    }
  }
  return frames;
}

Filled fill(const Structure& structure, const Recording& recording, const Places& places, std::span<const Sweep> sweeps,
            bool placed, const PropagateOptions& options, std::vector<std::string>& refused, const Progress& progress) {
  Filled result;
  result.drawn = drawn_sections(structure, recording, places);
  const auto& drawn = result.drawn;
  const auto joined = [&](std::size_t i) {
    return i + 1 < drawn.size() && obstacle(drawn[i], drawn[i + 1], sweeps).empty();
  };
  for (std::size_t i = 0; i + 1 < drawn.size(); ++i) {
    report(progress, static_cast<double>(i) / static_cast<double>(drawn.size()));
    const DrawnSection& first = drawn[i];
    const DrawnSection& second = drawn[i + 1];
    if (first.outlines_px.empty() && second.outlines_px.empty()) continue;
    if (!joined(i)) {
      refused.push_back(structure.name + ", frames " + std::to_string(first.frame) + " to " +
                        std::to_string(second.frame) + ": " + obstacle(first, second, sweeps));
      continue;
    }
    const auto open = open_frames(recording, places, first.frame, second.frame, options.every);
    DrawnAround around{&first, &second, {}, {}, placed};
    for (std::size_t k = i; k > 0 && k + 1 >= i && joined(k - 1); --k) around.before.push_back(&drawn[k - 1]);
    for (std::size_t k = i + 1; around.after.size() < 2 && joined(k); ++k) around.after.push_back(&drawn[k + 1]);
    auto filled = fill_run(recording, around, open, options);
    result.frames.insert(result.frames.end(), std::make_move_iterator(filled.begin()),
                         std::make_move_iterator(filled.end()));
  }
  return result;
}

/// Distance from another structure's outline on a frame, in its own blocks' pixels; empty where it has none there.
using DistanceAt = std::function<double(const Eigen::Vector2d&)>;

DistanceAt distance_on(const Filled& other, int frame) {
  for (const FilledFrame& filled : other.frames) {
    if (filled.frame != frame) continue;
    return [&filled](const Eigen::Vector2d& x_px) {
      const Eigen::Vector2d at = filled.grid.in_blocks(x_px);
      const int i = static_cast<int>(std::floor(at.x()));
      const int j = static_cast<int>(std::floor(at.y()));
      const cv::Mat& values = filled.distance;
      if (i < 0 || j < 0 || i + 1 >= values.cols || j + 1 >= values.rows) return -1e6;
      const double x = at.x() - i;
      const double y = at.y() - j;
      return filled.grid.step_px * ((1.0 - y) * ((1.0 - x) * values.at<float>(j, i) + x * values.at<float>(j, i + 1)) +
                                    y * ((1.0 - x) * values.at<float>(j + 1, i) + x * values.at<float>(j + 1, i + 1)));
    };
  }
  for (const DrawnSection& drawn : other.drawn) {
    if (drawn.frame != frame || drawn.outlines_px.empty()) continue;
    const double per_mm = 1.0 / std::sqrt(std::abs(drawn.place.ab_from_image.linear().determinant()));
    return [&drawn, per_mm](const Eigen::Vector2d& x_px) {
      return per_mm * static_cast<double>(drawn.shape->distance_mm(drawn.place.ab_from_image * x_px));
    };
  }
  return nullptr;
}

/// Whether two structures overlap where both were drawn, as a tumour and the organ around it.
bool meant_to_overlap(const Filled& a, const Filled& b) {
  for (const DrawnSection& drawn : a.drawn) {
    if (drawn.outlines_px.empty()) continue;
    const DistanceAt other = distance_on(b, drawn.frame);
    if (!other) continue;
    const PixelGrid grid = grid_around(drawn.outlines_px, 0.0);
    const cv::Mat own = section_distances(*drawn.shape, drawn.place, grid, 0.0);
    int mine = 0;
    int both = 0;
    for (int j = 0; j < own.rows; ++j) {
      for (int i = 0; i < own.cols; ++i) {
        if (own.at<float>(j, i) <= 0.0F) continue;
        ++mine;
        both += other(grid.middle_px(i, j)) > 0.0;
      }
    }
    if (both > kMeantToOverlap * mine) return true;
  }
  return false;
}

/// Gives what two structures both claim to the one whose outline is farther away.
void keep_apart(std::vector<Filled>& all) {
  const std::vector<Filled> before = [&] {
    std::vector<Filled> copies = all;
    for (Filled& copy : copies) {
      for (FilledFrame& frame : copy.frames) frame.distance = frame.distance.clone();
    }
    return copies;
  }();
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = 0; b < all.size(); ++b) {
      if (a == b || meant_to_overlap(before[a], before[b]) || meant_to_overlap(before[b], before[a])) continue;
      for (FilledFrame& frame : all[a].frames) {
        const DistanceAt other = distance_on(before[b], frame.frame);
        if (!other) continue;
        const bool drawn = std::none_of(before[b].frames.begin(), before[b].frames.end(),
                                        [&](const FilledFrame& filled) { return filled.frame == frame.frame; });
        for (int j = 0; j < frame.distance.rows; ++j) {
          for (int i = 0; i < frame.distance.cols; ++i) {
            float& own = frame.distance.at<float>(j, i);
            const double theirs = other(frame.grid.middle_px(i, j)) / frame.grid.step_px;
            // What is drawn stays, so that all of it is theirs; interpolation cuts its corners by less than a block.
            const double limit = drawn ? -theirs - 0.5 : 0.5 * (own - theirs) - kApart_blocks;
            if (limit < own) own = static_cast<float>(limit);
          }
        }
      }
    }
  }
}

void add_contours(const Filled& filled, Structure& structure, Propagation& result) {
  for (const FilledFrame& frame : filled.frames) {
    PropagatedFrame made{structure.name,       frame.frame, 0,           confidence_of(frame),
                         frame.expected_error, frame.moved, frame.change};
    for (Polygon& outline : grid_outlines(frame.distance, frame.grid, kLeastArea_px)) {
      Contour contour;
      contour.frame = frame.frame;
      contour.points_px = std::move(outline);
      contour.confidence = made.confidence;
      structure.contours.push_back(std::move(contour));
      ++made.contours;
    }
    result.contours += made.contours;
    result.frames.push_back(std::move(made));
  }
}

std::string why_nothing(const Propagation& result) {
  if (!result.refused.empty()) return "nothing can be filled in: " + result.refused.front();
  return "there is nothing to fill in; outline at least two frames of one sweep with others between them";
}

}  // namespace

void PropagateOptions::check() const {
  if (every < 1) throw Error("propagation: every how many frames must be at least 1");
  for (const double share : {spread_of_misfit, spread_of_change, spread_of_end, spread_of_gap}) {
    if (!(share > 0.0) || !std::isfinite(share)) throw Error("propagation: the spreads must be positive");
  }
  refinement.check();
}

Propagation propagate(const Recording& recording, const std::vector<Structure>& structures, const FrameLocator* locator,
                      std::span<const Sweep> sweeps, const PropagateOptions& options, const Progress& progress) {
  options.check();
  if (!recording.header().has_images()) {
    throw Error(recording.name() + ": has no images, only poses; give a recording with images");
  }
  const auto asked = [&](const Structure& structure) {
    return !options.structure || structure.name == *options.structure;
  };
  if (std::none_of(structures.begin(), structures.end(), asked)) {
    throw Error("the contours have no structure " + options.structure.value_or("at all") +
                "; outline it on some frames");
  }
  const Places places = places_of(recording, locator);
  Propagation result;
  std::vector<Filled> filled;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    const bool wanted = asked(structures[i]);
    result.structures.push_back(wanted ? without_earlier_results(structures[i]) : structures[i]);
    const auto count = static_cast<double>(structures.size());
    const Progress part = part_of(progress, static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
    Filled one;
    if (wanted) {
      one =
          fill(result.structures.back(), recording, places, sweeps, locator != nullptr, options, result.refused, part);
    } else {
      one.drawn = drawn_sections(result.structures.back(), recording, places);
    }
    filled.push_back(std::move(one));
  }
  keep_apart(filled);
  for (std::size_t i = 0; i < structures.size(); ++i) add_contours(filled[i], result.structures[i], result);
  if (result.frames.empty()) throw Error(recording.name() + ": " + why_nothing(result));
  report(progress, 1.0);
  return result;
}

}  // namespace fathom
