#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "acquisition/recording.h"
#include "measurement/contour_surface.h"
#include "measurement/cross_section.h"
#include "measurement/planimetry.h"
#include "registration/calibration.h"
#include "segmentation/threshold_recording.h"
#include "tests/error_sums.h"
#include "tests/real_recordings.h"

// Linear and curved surfaces through few of a real sweep's outlines, against the volume of all of them.
namespace fathom {
namespace {

struct RealStructure {
  const char* name;
  const char* recording;
  const char* calibration;
  double threshold;  // 0: the prism's contours file
  double min_area_px;
  double spacing_mm;
  std::vector<std::size_t> every;
};

constexpr const char* kPhantom = "fCal_Test_Calibration_3NWires_fCal2.0.igs.mha";
constexpr const char* kPhantomAgain = "fCal_Test_Validation_3NWires_fCal2.0.igs.mha";
constexpr const char* kPhantomXml = "FreehandCalibration3NWires_fCal2.0.results.xml";
constexpr const char* kSpine = "SpinePhantomFreehand.igs.mha";
constexpr const char* kSpineXml = "PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml";

// A prism; echoes of wires of about a millimetre, whose size changes from frame to frame; the bright layer over a
// spine, in a sweep of 21 frames. The other real sweep, of the N-wire phantom, turns back and forth.
const std::vector<RealStructure>& real_structures() {
  static const std::vector<RealStructure> all = {
      {"prism of four wires, 37 frames", kPhantom, kPhantomXml, 0.0, 0.0, 0.6, {4, 8, 12}},
      {"nine wires, 190 frames", kPhantom, kPhantomXml, 60.0, 20.0, 0.15, {8, 12}},
      {"nine wires again, 103 frames", kPhantomAgain, kPhantomXml, 60.0, 20.0, 0.15, {8, 12}},
      {"bright layer over a spine, 21 frames", kSpine, kSpineXml, 160.0, 1500.0, 0.4, {2, 4, 8}}};
  return all;
}

Structure structure_of(const RealStructure& real, const Recording& recording) {
  if (real.threshold == 0.0) return read_contours(real_recordings() / "fCal2_wire_prism.contours.json").front();
  ThresholdRecordingOptions options;
  options.threshold.threshold = real.threshold;
  options.threshold.min_area_px = real.min_area_px;
  return segment_by_threshold(recording, options);
}

// What is outlined on every n-th of `frames` from an offset on, or with n = 1 on all between the first and last of
// those.
Structure thinned(const Structure& structure, const std::vector<int>& frames, std::size_t offset, std::size_t every,
                  bool all_between) {
  std::set<int> kept;
  for (std::size_t i = offset; i < frames.size(); i += every) kept.insert(frames[i]);
  if (all_between) {
    const int first = *kept.begin();
    const int last = *kept.rbegin();
    for (const int frame : frames) {
      if (frame >= first && frame <= last) kept.insert(frame);
    }
  }
  Structure result = structure;
  std::erase_if(result.contours, [&](const Contour& contour) { return !kept.contains(contour.frame); });
  return result;
}

double surface_ml(const FrameLocator& locator, const Structure& structure, GapOrder order, double spacing_mm) {
  ContourSurfaceOptions options;
  options.order = order;
  options.spacing_mm = spacing_mm;
  ContourSurface surface(locator, options);
  surface.update(structure);
  return surface.volume_ml().value();
}

TEST(GapOrdersStudy, CurvedIsAsNearAsLinearToTheVolumeOfAllFramesOfRealSweeps) {
  FATHOM_NEEDS_REAL_RECORDINGS();
  std::printf("| structure | every | scans | linear: mean, rms (%%) | curved: mean, rms (%%) |\n");
  for (const RealStructure& real : real_structures()) {
    const auto recording = open_recording(real_recordings() / real.recording);
    const FrameLocator locator(*recording, read_calibration(real_recordings() / real.calibration));
    const Structure whole = structure_of(real, *recording);
    std::set<int> outlined;
    for (const Contour& contour : whole.contours) {
      if (locator.reference_from_image(contour.frame)) outlined.insert(contour.frame);
    }
    const std::vector<int> frames(outlined.begin(), outlined.end());
    for (const std::size_t every : real.every) {
      ErrorSums linear;
      ErrorSums curved;
      for (std::size_t offset = 0; offset < every; offset += every / 2) {
        const Structure few = thinned(whole, frames, offset, every, false);
        const Structure all = thinned(whole, frames, offset, every, true);
        const double all_ml = measure_planimetry(cross_sections(all, locator, nullptr)).volumes.linear_ml.value();
        linear.add(100.0 * (surface_ml(locator, few, GapOrder::kLinear, real.spacing_mm) / all_ml - 1.0));
        curved.add(100.0 * (surface_ml(locator, few, GapOrder::kCurved, real.spacing_mm) / all_ml - 1.0));
      }
      std::printf("| %s | %zu | %d | %+.2f, %.2f | %+.2f, %.2f |\n", real.name, every, linear.count, linear.mean(),
                  linear.rms(), curved.mean(), curved.rms());
      // A prism has nothing to bend: there the two differ by how the frames were outlined.
      EXPECT_LE(curved.rms(), 1.05 * linear.rms() + 0.05) << real.name << ", every " << every;
    }
  }
}

}  // namespace
}  // namespace fathom
