// The sample of README.md, complete: built and run by the tests, so that what the page shows works.
#include <iostream>
#include <string>
#include <vector>

#include "acquisition/recording.h"
#include "measurement/cross_section.h"
#include "measurement/planimetry.h"
#include "registration/calibration.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"

int main() {
  const auto sweep = fathom::open_recording("sweep.mha");
  const fathom::FrameLocator locator(*sweep, fathom::read_calibration("sweep.calibration.json"));
  for (const fathom::Structure& structure : fathom::read_contours("sweep.contours.json")) {
    std::vector<std::string> warnings;
    const auto sections = fathom::cross_sections(structure, locator, &warnings);
    const fathom::VolumeMeasurement result = fathom::measure_planimetry(sections);
    std::cout << structure.name << ": " << result.volumes.recommended_ml().value() << " ml\n";
  }
}
