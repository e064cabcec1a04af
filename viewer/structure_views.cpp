#include "viewer/structure_views.h"

#include <algorithm>
#include <utility>

namespace fathom {

const StructureView* StructureViews::find(std::uint64_t id) const {
  const auto found = views_.find(id);
  return found == views_.end() ? nullptr : &found->second;
}

void StructureViews::update(const Document& document, Worker& worker) {
  const std::vector<std::uint64_t>& ids = document.content().ids;
  std::erase_if(views_, [&](const auto& item) { return std::find(ids.begin(), ids.end(), item.first) == ids.end(); });
  for (std::size_t i = 0; i < ids.size(); ++i) {
    StructureView& view = views_[ids[i]];
    if (!document.is_calibrated()) continue;
    measure(document, i, view);
    take_surface(ids[i], results_.surface(i), view, worker);
    take_confidence(document, i, view);
  }
  if (!document.is_calibrated() || document.in_action()) return;
  confidences_.request();  // before the surfaces, as they take longer
  results_.request_surfaces();
}

void StructureViews::measure(const Document& document, std::size_t structure, StructureView& view) {
  // The end of an action makes what was measured the settled volume, also where nothing changed last.
  const std::uint64_t now = document.structure_revision(structure) + document.division_revision() +
                            document.placement_revision() + (document.in_action() ? std::uint64_t{1} << 63 : 0);
  if (now == view.measured) return;
  view.measured = now;
  const VolumeMeasurement& measured = results_.volume(structure);
  view.volumes = measured.volumes;
  view.warnings = measured.warnings;
  view.section_count = measured.sections;
  view.sections = results_.sections(structure);
  if (document.in_action() || view.volume_settled_ml == view.volumes.recommended_ml()) return;
  view.volume_before_ml = std::exchange(view.volume_settled_ml, view.volumes.recommended_ml());
}

void StructureViews::take_confidence(const Document& document, std::size_t structure, StructureView& view) {
  const LiveConfidence& newest = confidences_.of(structure);
  view.confidence_is_current = newest.revision == document.result_revision(structure);
  const bool same = newest.revision == view.confidence.revision && newest.cancelled == view.confidence.cancelled;
  if (!same) view.confidence = newest;
}

// Corners for the graphics card are made beside the frame, as they take longer than a frame may.
void StructureViews::take_surface(std::uint64_t id, const LiveSurface& surface, StructureView& view, Worker& worker) {
  view.surface.cancelled = surface.cancelled;
  if (surface.mesh == view.surface.mesh && surface.revision == view.surface.revision) return;
  const bool same_mesh = surface.mesh == view.surface.mesh;
  view.surface = surface;
  if (same_mesh) return;
  if (surface.mesh == nullptr) {
    view.triangles = nullptr;
    view.triangles_number = ++meshes_;
    return;
  }
  const auto work = [this, id, mesh = surface.mesh](const Progress&) -> std::function<void()> {
    const auto triangles = std::make_shared<const std::vector<SceneVertex>>(scene_vertices(*mesh));
    return [this, id, mesh, triangles] {
      const auto found = views_.find(id);
      if (found == views_.end() || found->second.surface.mesh != mesh) return;
      found->second.triangles = triangles;
      found->second.triangles_number = ++meshes_;
    };
  };
  worker.start({"triangles " + std::to_string(id), "Drawing the surface", work, {}});
}

void StructureViews::cancel(const Document& document, const std::string& key) {
  for (std::size_t i = 0; i < document.structures().size(); ++i) {
    const std::string id = std::to_string(document.content().ids[i]);
    if (key == "surface " + id) results_.cancel_surface(i);
    if (key == "interval " + id) confidences_.cancel(i);
  }
}

void StructureViews::retry_surface(const Document& document, std::uint64_t id) {
  if (const auto structure = document.index_of(id)) results_.retry_surface(*structure);
}

}  // namespace fathom
