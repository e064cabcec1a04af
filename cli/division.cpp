#include "cli/division.h"

#include <utility>

#include "core/error.h"
#include "registration/dividing_planes.h"
#include "registration/find_sweeps.h"

namespace fathom {

Division read_division(const std::string& planes_file, const Recording& recording, const FrameLocator& locator) {
  PlanesFile file = read_planes(planes_file);
  const RecordingHeader& header = recording.header();
  const std::string name = locator.recording_name();
  if (!header.has_images()) throw Error(name + ": has no images, so that no planes lie between them");
  if (file.sweeps.empty()) file.sweeps = find_sweeps(recording, locator);
  if (file.sweeps.empty()) throw Error(name + ": has no sweep, as no run of frames is valid; record again");
  std::vector<SweepShape> shapes;
  for (const Sweep& sweep : file.sweeps) {
    if (sweep.recording != 0) {
      throw Error(planes_file + ": has a sweep of recording " + std::to_string(sweep.recording) +
                  " of an exam; give the planes of this recording alone");
    }
    if (sweep.last >= header.frame_count()) {
      throw Error(planes_file + ": has a sweep to frame " + std::to_string(sweep.last) + ", and the recording has " +
                  std::to_string(header.frame_count()) + " frames; give the planes that were placed for it");
    }
    shapes.push_back(sweep_shape(sweep, locator, header.width, header.height));
  }
  SpacePartition partition(std::move(shapes), std::move(file.planes));
  return {std::move(file.sweeps), std::move(partition)};
}

}  // namespace fathom
