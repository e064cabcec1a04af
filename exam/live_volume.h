#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "exam/scan.h"
#include "measurement/cross_section.h"
#include "measurement/partition_volume.h"
#include "measurement/planimetry.h"
#include "measurement/section_outline.h"
#include "registration/division.h"
#include "segmentation/contours.h"

namespace fathom {

/// The volumes of one structure by planimetry, kept up to date while it is edited: only frames that changed are looked
/// at again. Equals measure_structures without surfaces. Sweeps that no planes divide are measured anew.
class LiveVolume {
 public:
  /// Measures `structure` as it is now. `division` as division_of gives it. Never throws for outlines without a volume:
  /// then there are no volumes, and the first warning says why.
  const VolumeMeasurement& update(const Structure& structure, const Scan& scan,
                                  const std::optional<Division>& division);

  /// No volume, for this reason.
  const VolumeMeasurement& refuse(const std::string& why);

  /// Of the last update.
  const VolumeMeasurement& measurement() const { return measurement_; }
  /// The sections of a scan that is taken as one sweep, in the order of the frames: for a graph of area along it. Empty
  /// otherwise, and where outlines have a fault.
  const std::vector<CrossSection>& sections() const { return sections_; }
  /// Frames that the last update had to look at.
  int frames_made() const { return frames_made_; }
  /// Forgets all frames: poses have changed.
  void clear() {
    frames_.clear();
    sweeps_.clear();
  }

 private:
  // What a structure has on one frame, and what came of it.
  struct Frame {
    Structure marks;
    std::optional<CrossSection> section;
  };
  // The same of one sweep of several.
  struct SweepFrame {
    Structure marks;
    std::vector<SectionOutline> section;  // at most one
  };
  struct KeptSweep {
    Sweep sweep;
    std::map<int, SweepFrame> frames;
  };
  SweepSections update_sweep(const Structure& structure, const FrameLocator& locator, KeptSweep& kept);
  VolumeMeasurement measure_division(const Structure& structure, const Scan& scan, const Division& division);
  void update_sections(const Structure& structure, const Scan& scan, std::vector<std::string>& warnings);

  std::map<int, Frame> frames_;
  std::vector<KeptSweep> sweeps_;
  std::vector<CrossSection> sections_;
  VolumeMeasurement measurement_;
  int frames_made_ = 0;
};

}  // namespace fathom
