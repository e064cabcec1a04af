#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exam/live_confidence.h"
#include "exam/live_results.h"
#include "viewer/scene_vertex.h"

namespace fathom {

/// What panes show of one structure besides its outlines.
struct StructureView {
  std::vector<CrossSection> sections;  ///< of a scan that is taken as one sweep
  int section_count = 0;
  PlanimetryVolumes volumes;
  std::vector<std::string> warnings;
  LiveConfidence confidence;
  bool confidence_is_current = false;       ///< else it is being found out
  std::optional<double> volume_before_ml;   ///< before the last action
  std::optional<double> volume_settled_ml;  ///< after it, or before one under way

  LiveSurface surface;
  std::shared_ptr<const std::vector<SceneVertex>> triangles;  ///< of the surface's mesh; null where there is none
  std::uint64_t triangles_number = 0;                         ///< grows with every new mesh

  std::uint64_t measured = 0;  ///< what the volumes are of
};

/// Volumes and surfaces of a document's structures as panes show them: volumes with every change, surfaces after every
/// action, beside the frame.
class StructureViews {
 public:
  /// Both must live as long.
  StructureViews(const Document& document, Worker& worker)
      : results_(document, worker), confidences_(document, worker) {}

  /// Once a frame. Without a calibration nothing is measured.
  void update(const Document& document, Worker& worker);
  /// By its id in the document; null where nothing is known.
  const StructureView* find(std::uint64_t id) const;
  /// As LiveResults::cancel_surface or LiveConfidences::cancel: `key` is that of the job.
  void cancel(const Document& document, const std::string& key);
  /// As LiveResults::retry_surface.
  void retry_surface(const Document& document, std::uint64_t id);

 private:
  void measure(const Document& document, std::size_t structure, StructureView& view);
  void take_confidence(const Document& document, std::size_t structure, StructureView& view);
  void take_surface(std::uint64_t id, const LiveSurface& surface, StructureView& view, Worker& worker);

  LiveResults results_;
  LiveConfidences confidences_;
  std::map<std::uint64_t, StructureView> views_;
  std::uint64_t meshes_ = 0;
};

}  // namespace fathom
