#include <filesystem>

#include <gtest/gtest.h>

#include "acquisition/recording.h"
#include "measurement/cross_section.h"
#include "measurement/planimetry.h"
#include "registration/calibration.h"
#include "registration/frame_locator.h"
#include "segmentation/contours.h"
#include "segmentation/outline_topology.h"
#include "tests/real_recordings.h"

namespace fathom {
namespace {

// A prism between four wires of a calibration phantom, in a real freehand sweep with a real calibration. The drawing
// says 16.86 ml; with this calibration the sections are 1.2 % larger.
TEST(WirePrism, InARealSweepMeasures1706Millilitres) {
  const std::filesystem::path data = real_recordings();
  FATHOM_NEEDS_REAL_RECORDINGS();
  const auto recording = open_recording(data / "fCal_Test_Calibration_3NWires_fCal2.0.igs.mha");
  const Calibration calibration = read_calibration(data / "FreehandCalibration3NWires_fCal2.0.results.xml");
  const auto structures = read_contours(data / "fCal2_wire_prism.contours.json");
  ASSERT_EQ(structures.size(), 1u);
  EXPECT_NO_THROW(require_measurable(structures, recording->header().frame_count(), "contours"));
  EXPECT_NO_THROW(require_simple_outlines(structures, "contours"));
  EXPECT_FALSE(outside_image_warning(structures[0], recording->header().width, recording->header().height));

  const FrameLocator locator(*recording, calibration);
  const auto measurement = measure_planimetry(cross_sections(structures[0], locator, nullptr));
  EXPECT_EQ(measurement.sections, 37);
  ASSERT_TRUE(measurement.volumes.linear_ml);
  EXPECT_NEAR(*measurement.volumes.linear_ml, 17.06, 0.02);
  EXPECT_NEAR(*measurement.volumes.cubic_ml, 17.06, 0.02);
  EXPECT_NEAR(*measurement.volumes.cubic_3d_ml, 17.06, 0.02);
}

}  // namespace
}  // namespace fathom
