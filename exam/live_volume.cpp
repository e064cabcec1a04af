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

// Of one sweep, or of all frames: then what is of another recording stays, to be complained about.
std::map<int, OnFrame> by_frame(const Structure& structure, const Sweep* sweep = nullptr) {
  std::map<int, OnFrame> frames;
  const auto add = [&](const auto& items, auto list) {
    for (const auto& item : items) {
      const bool here =
          !sweep || (item.recording == static_cast<int>(sweep->recording) && contains(*sweep, item.frame));
      if (here) (frames[item.frame].*list).push_back(&item);
    }
  };
  add(structure.contours, &OnFrame::contours);
  add(structure.extremities, &OnFrame::extremities);
  add(structure.absent, &OnFrame::absent);
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
Structure skeleton_of(const Structure& structure, const std::map<int, OnFrame>& frames, int recording) {
  Structure skeleton;
  skeleton.name = structure.name;
  skeleton.absent = structure.absent;
  for (const auto& [frame, marks] : frames) {
    if (marks.absent.empty()) skeleton.extremities.push_back({frame, Eigen::Vector2d::Zero(), recording});
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
  measure_way(sections_, locator);
  cross_sections(skeleton_of(structure, frames, 0), locator, &warnings);
}

SweepSections LiveVolume::update_sweep(const Structure& structure, const FrameLocator& locator, KeptSweep& kept) {
  const std::map<int, OnFrame> frames = by_frame(structure, &kept.sweep);
  std::erase_if(kept.frames, [&](const auto& known) { return !frames.contains(known.first); });
  SweepSections made;
  for (const auto& [frame, marks] : frames) {
    auto known = kept.frames.find(frame);
    if (known == kept.frames.end() || !is_same(marks, known->second.marks)) {
      kept.frames.erase(frame);
      Structure alone = copy_of(marks, structure.name);
      std::vector<SectionOutline> section = section_outlines(alone, locator, kept.sweep);
      known = kept.frames.insert({frame, {std::move(alone), std::move(section)}}).first;
      ++frames_made_;
    }
    made.sections.insert(made.sections.end(), known->second.section.begin(), known->second.section.end());
  }
  // Each frame was made by itself and knows nothing of the way to it.
  std::vector<CrossSection> wholes;
  for (const SectionOutline& section : made.sections) wholes.push_back(section.whole);
  measure_way(wholes, locator);
  for (std::size_t i = 0; i < wholes.size(); ++i) made.sections[i].whole.along_mm = wholes[i].along_mm;
  const int recording = static_cast<int>(kept.sweep.recording);
  section_outlines(skeleton_of(structure, frames, recording), locator, kept.sweep, &made.warnings);
  return made;
}

VolumeMeasurement LiveVolume::measure_division(const Structure& structure, const Scan& scan, const Division& division) {
  if (division.partition.planes().empty()) {
    sweeps_.clear();
    return measure_structures({structure}, scan, division, {.surfaces = false}).front().measurement;
  }
  const bool same = std::equal(sweeps_.begin(), sweeps_.end(), division.sweeps.begin(), division.sweeps.end(),
                               [](const KeptSweep& kept, const Sweep& sweep) { return kept.sweep == sweep; });
  if (!same) {
    sweeps_.clear();
    for (const Sweep& sweep : division.sweeps) sweeps_.push_back({sweep, {}});
  }
  std::vector<SweepSections> sections;
  for (KeptSweep& kept : sweeps_) {
    sections.push_back(update_sweep(structure, scan.locators[kept.sweep.recording], kept));
  }
  PartitionedVolume measured =
      measure_partitions(structure, scan.locators, division.sweeps, division.partition, sections);
  return division_result(structure, scan, division, std::move(measured)).measurement;
}

const VolumeMeasurement& LiveVolume::update(const Structure& structure, const Scan& scan,
                                            const std::optional<Division>& division) {
  frames_made_ = 0;
  measurement_ = {};
  try {
    if (division) {
      sections_.clear();
      frames_.clear();
      return measurement_ = measure_division(structure, scan, *division);
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
