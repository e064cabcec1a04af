#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exam/document.h"
#include "exam/job.h"
#include "measurement/contour_surface.h"
#include "measurement/cross_section.h"
#include "measurement/planimetry.h"
#include "surface/mesh.h"
#include "viewer/scene_vertex.h"

namespace fathom {

/// What is known of one structure besides its outlines.
struct StructureView {
  std::vector<CrossSection> sections;
  PlanimetryVolumes volumes;
  std::vector<std::string> warnings;
  std::string error;                        ///< why there is no volume
  std::optional<double> volume_before_ml;   ///< before the last action
  std::optional<double> volume_settled_ml;  ///< after it, or before one under way
  std::uint64_t measured = 0;               ///< revisions that it is of
  std::uint64_t measured_division = 0;
  std::uint64_t placement = 0;

  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<const std::vector<SceneVertex>> triangles;  ///< of `mesh`
  std::uint64_t mesh_number = 0;                              ///< grows with every new mesh
  std::optional<double> surface_ml;
  std::string surface_error;
  std::uint64_t surfaced = 0;
  std::uint64_t surfaced_division = 0;
  int layers = 0;
  int layers_made = 0;

  std::shared_ptr<ContourSurface> maker;
  std::shared_ptr<const Scan> scan;               ///< that `maker` refers to
  std::map<int, std::vector<double>> section_of;  ///< frame: what its section was made of
};

/// Volumes and surfaces of a document's structures, kept up to date: the volume with every change, by measuring the
/// changed frames' sections again; the surface beside the frame, after every action.
class StructureViews {
 public:
  void clear();
  /// Once a frame. Without a calibration nothing is measured.
  void update(const Document& document, Worker& worker);
  /// By its id in the document; null where nothing is known.
  const StructureView* find(std::uint64_t id) const;
  bool show_surfaces = true;  ///< else none is made

 private:
  void measure(const Document& document, std::size_t structure, StructureView& view, Worker& worker);
  void measure_alone(const Document& document, const Structure& structure, StructureView& view);
  void make_surface(const Document& document, std::size_t structure, StructureView& view, Worker& worker);

  std::map<std::uint64_t, std::shared_ptr<StructureView>> views_;
  std::uint64_t meshes_ = 0;
};

}  // namespace fathom
