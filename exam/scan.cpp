#include "exam/scan.h"

#include <utility>

#include "core/error.h"

namespace fathom {

namespace {

void add(std::unique_ptr<Recording> recording, const Calibration& calibration, const FrameNames& names, Scan& scan) {
  scan.locators.emplace_back(*recording, calibration, names);
  scan.recordings.push_back(std::move(recording));
  const FrameLocator& first = scan.locators.front();
  const FrameLocator& last = scan.locators.back();
  if (first.reference_frame() != last.reference_frame()) {
    throw Error(scan.name + ": " + first.recording_name() + " lies in coordinates " + first.reference_frame() + ", " +
                last.recording_name() + " in " + last.reference_frame() +
                ", so that they have no place relative to each other; choose coordinates that both have by "
                "--reference-frame");
  }
}

}  // namespace

Scan open_scan(const std::filesystem::path& recording, const Calibration& calibration, const FrameNames& names) {
  Scan scan{recording.string(), {}, {}, calibration, names};
  add(open_recording(recording), calibration, names, scan);
  return scan;
}

Scan open_scan(const Exam& exam, const Calibration& calibration, const FrameNames& names) {
  Scan scan{exam_json(exam).string(), {}, {}, calibration, names};
  for (const std::string& name : exam.recordings) {
    add(open_recording(file_of(exam, name)), calibration, names, scan);
  }
  require_sweeps(exam.sweeps, scan, scan.name);
  return scan;
}

std::vector<Sweep> find_sweeps(const Scan& scan, const FindSweepsOptions& options) {
  std::vector<Sweep> sweeps;
  for (std::size_t i = 0; i < scan.recordings.size(); ++i) {
    for (Sweep sweep : find_sweeps(*scan.recordings[i], scan.locators[i], options)) {
      sweep.recording = i;
      sweeps.push_back(sweep);
    }
  }
  if (sweeps.empty()) throw Error(scan.name + ": has no sweep, as no run of frames is valid; record again");
  return sweeps;
}

void require_sweeps(std::span<const Sweep> sweeps, const Scan& scan, const std::string& file) {
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    const std::string which = file + ": sweep " + std::to_string(i + 1) + " ";
    if (sweeps[i].recording >= scan.recordings.size()) {
      throw Error(which + "is of recording " + std::to_string(sweeps[i].recording) +
                  ", counted from 0, but there are " + std::to_string(scan.recordings.size()) +
                  "; give the file that was made for this scan");
    }
    const Recording& recording = *scan.recordings[sweeps[i].recording];
    if (sweeps[i].last >= recording.header().frame_count()) {
      throw Error(which + "goes to frame " + std::to_string(sweeps[i].last) + ", but " + recording.name() + " has " +
                  std::to_string(recording.header().frame_count()) +
                  " frames, numbered from 0; give the file that was made for this scan");
    }
  }
}

std::vector<SweepShape> sweep_shapes(std::span<const Sweep> sweeps, const Scan& scan) {
  std::vector<SweepShape> shapes;
  for (const Sweep& sweep : sweeps) {
    const Recording& recording = *scan.recordings.at(sweep.recording);
    const RecordingHeader& header = recording.header();
    if (!header.has_images()) {
      throw Error(recording.name() + ": has no images, so that no planes lie between them; name one that has");
    }
    shapes.push_back(sweep_shape(sweep, scan.locators[sweep.recording], header.width, header.height));
  }
  return shapes;
}

std::vector<int> frame_counts(const Scan& scan) {
  std::vector<int> counts;
  for (const auto& recording : scan.recordings) counts.push_back(recording->header().frame_count());
  return counts;
}

}  // namespace fathom
