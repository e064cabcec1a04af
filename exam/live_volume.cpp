#include "exam/live_volume.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "exam/results.h"

namespace fathom {

namespace {

// What a structure has on each frame, by reference.
struct OnFrame {
  std::vector<const Contour*> contours;
  std::vector<const Extremity*> extremities;
  std::vector<const AbsentMark*> absent;
};

std::map<int, OnFrame> by_frame(const Structure& structure) {
  std::map<int, OnFrame> frames;
  for (const Contour& contour : structure.contours) frames[contour.frame].contours.push_back(&contour);
  for (const Extremity& extremity : structure.extremities) frames[extremity.frame].extremities.push_back(&extremity);
  for (const AbsentMark& mark : structure.absent) frames[mark.frame].absent.push_back(&mark);
  return frames;
}

bool is_same(const OnFrame& now, const Structure& before) {
  const auto contour = [](const Contour* a, const Contour& b) {
    return a->closed == b.closed && a->recording == b.recording && a->points_px == b.points_px;
  };
  const auto extremity = [](const Extremity* a, const Extremity& b) {
    return a->point_px == b.point_px && a->recording == b.recording;
  };
  const auto mark = [](const AbsentMark* a, const AbsentMark& b) { return a->recording == b.recording; };
  return std::equal(now.contours.begin(), now.contours.end(), before.contours.begin(), before.contours.end(),
                    contour) &&
         std::equal(now.extremities.begin(), now.extremities.end(), before.extremities.begin(),
                    before.extremities.end(), extremity) &&
         std::equal(now.absent.begin(), now.absent.end(), before.absent.begin(), before.absent.end(), mark);
}

Structure copy_of(const OnFrame& marks, const std::string& name) {
  Structure structure;
  structure.name = name;
  for (const Contour* contour : marks.contours) structure.contours.push_back(*contour);
  for (const Extremity* extremity : marks.extremities) structure.extremities.push_back(*extremity);
  for (const AbsentMark* mark : marks.absent) structure.absent.push_back(*mark);
  return structure;
}

// The same frames with a point each in place of outlines: what is said of frames as such is said of these, too.
Structure skeleton_of(const Structure& structure, const std::map<int, OnFrame>& frames) {
  Structure skeleton;
  skeleton.name = structure.name;
  skeleton.absent = structure.absent;
  for (const auto& [frame, marks] : frames) {
    if (marks.absent.empty()) skeleton.extremities.push_back({frame, Eigen::Vector2d::Zero(), 0});
  }
  return skeleton;
}

}  // namespace

void LiveVolume::update_sections(const Structure& structure, const Scan& scan, std::vector<std::string>& warnings) {
  const FrameLocator& locator = scan.locators.front();
  const std::map<int, OnFrame> frames = by_frame(structure);
  std::erase_if(frames_, [&](const auto& known) { return !frames.contains(known.first); });
  sections_.clear();
  for (const auto& [frame, marks] : frames) {
    auto known = frames_.find(frame);
    if (known == frames_.end() || !is_same(marks, known->second.marks)) {
      frames_.erase(frame);  // not to be taken for up to date where the next line throws
      Structure alone = copy_of(marks, structure.name);
      const std::vector<CrossSection> made = cross_sections(alone, locator, nullptr);
      known =
          frames_.insert({frame, {std::move(alone), made.empty() ? std::nullopt : std::optional(made.front())}}).first;
      ++frames_made_;
    }
    if (known->second.section) sections_.push_back(*known->second.section);
  }
  cross_sections(skeleton_of(structure, frames), locator, &warnings);
}

const VolumeMeasurement& LiveVolume::update(const Structure& structure, const Scan& scan,
                                            const std::optional<Division>& division) {
  frames_made_ = 0;
  measurement_ = {};
  try {
    if (division) {
      sections_.clear();
      frames_.clear();
      measurement_ = measure_structures({structure}, scan, *division, {.surfaces = false}).front().measurement;
      return measurement_;
    }
    std::vector<std::string> warnings;
    const RecordingHeader& header = scan.recordings.front()->header();
    if (header.has_images()) {
      auto warning = outside_image_warning(structure, header.width, header.height);
      if (warning) warnings.push_back(std::move(*warning));
    }
    update_sections(structure, scan, warnings);
    measurement_ = measure_planimetry(sections_);
    measurement_.warnings.insert(measurement_.warnings.begin(), warnings.begin(), warnings.end());
  } catch (const Error& error) {
    return refuse(error.what());
  }
  return measurement_;
}

const VolumeMeasurement& LiveVolume::refuse(const std::string& why) {
  sections_.clear();
  measurement_ = {};
  measurement_.warnings.push_back(why);
  return measurement_;
}

}  // namespace fathom
