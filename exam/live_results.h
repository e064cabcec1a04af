#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exam/document.h"
#include "exam/job.h"
#include "exam/live_volume.h"
#include "measurement/contour_surface.h"
#include "surface/mesh.h"

namespace fathom {

/// A structure's surface as it was made last.
struct LiveSurface {
  std::shared_ptr<const Mesh> mesh;  ///< empty before the first
  std::optional<double> volume_ml;
  std::vector<std::string> warnings;
  std::string fault;           ///< why the last attempt gave none; empty where it did
  bool cancelled = false;      ///< the last attempt was stopped: mesh, if any, is of an earlier state
  std::uint64_t revision = 0;  ///< of the document, that mesh or fault are of
};

/// Volumes and surfaces of the structures of a document, following what is edited. For the main thread.
class LiveResults {
 public:
  /// Both must live as long.
  LiveResults(const Document& document, Worker& worker);
  /// Cancels the surfaces under way.
  ~LiveResults();
  LiveResults(const LiveResults&) = delete;
  LiveResults& operator=(const LiveResults&) = delete;

  /// By planimetry, up to date: measured at once where the structure changed. Without a calibration there are no
  /// volumes.
  const VolumeMeasurement& volume(std::size_t structure);
  /// As LiveVolume::sections, after volume().
  const std::vector<CrossSection>& sections(std::size_t structure);

  /// Starts jobs for the surfaces that do not show the document as it is. While one is made a later one waits, and only
  /// the newest waits. They arrive by Worker::poll.
  void request_surfaces();
  /// The last one that arrived, perhaps of an earlier state: see is_current.
  const LiveSurface& surface(std::size_t structure);
  bool is_current(std::size_t structure);
  /// Stops the surface under way; the last one stays, and is not requested again until the structure changes, or
  /// retry_surface asks for it.
  void cancel_surface(std::size_t structure);
  void retry_surface(std::size_t structure);

  /// For all surfaces that are made from now on.
  void set_options(const ContourSurfaceOptions& options);

 private:
  struct Item;
  Item& item(std::size_t structure);
  void start_surface(std::size_t structure, Item& item, std::uint64_t revision);

  const Document& document_;
  Worker& worker_;
  ContourSurfaceOptions options_;
  std::uint64_t options_changes_ = 0;
  std::map<std::uint64_t, std::shared_ptr<Item>> items_;  ///< by the structure's id
};

}  // namespace fathom
