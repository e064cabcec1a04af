#include "viewer/structure_views.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "measurement/partition_surface.h"
#include "measurement/partition_volume.h"

namespace fathom {

namespace {

// What of a structure stands on one frame.
Structure on_frame(const Structure& structure, int frame) {
  Structure part;
  part.name = structure.name;
  const auto copy = [frame](const auto& from, auto& to) {
    std::copy_if(from.begin(), from.end(), std::back_inserter(to),
                 [frame](const auto& item) { return item.frame == frame; });
  };
  copy(structure.contours, part.contours);
  copy(structure.extremities, part.extremities);
  return part;
}

// Numbers that differ where the section does.
std::vector<double> made_of(const Structure& part) {
  std::vector<double> numbers;
  for (const Contour& contour : part.contours) {
    numbers.push_back(static_cast<double>(contour.points_px.size()) + (contour.closed ? 0.5 : 0.0));
    for (const Eigen::Vector2d& point : contour.points_px) numbers.insert(numbers.end(), {point.x(), point.y()});
  }
  for (const Extremity& extremity : part.extremities) {
    numbers.insert(numbers.end(), {-1.0, extremity.point_px.x(), extremity.point_px.y()});
  }
  return numbers;
}

// The section of one frame anew, where it changed; the others as they were.
void update_sections(const Structure& structure, const FrameLocator& locator, StructureView& view) {
  std::map<int, std::vector<double>> now;
  for (const Contour& contour : structure.contours) now[contour.frame];
  for (const Extremity& extremity : structure.extremities) now[extremity.frame];
  std::vector<CrossSection> sections;
  for (auto& [frame, numbers] : now) {
    const Structure part = on_frame(structure, frame);
    numbers = made_of(part);
    const auto before = view.section_of.find(frame);
    const auto kept = std::find_if(view.sections.begin(), view.sections.end(),
                                   [&, f = frame](const CrossSection& section) { return section.frame == f; });
    if (before != view.section_of.end() && before->second == numbers && kept != view.sections.end()) {
      sections.push_back(*kept);
      continue;
    }
    for (CrossSection& section : cross_sections(part, locator, nullptr)) sections.push_back(std::move(section));
  }
  view.sections = std::move(sections);
  view.section_of = std::move(now);
}

void set_volumes(PlanimetryVolumes volumes, bool in_action, StructureView& view) {
  view.volumes = volumes;
  if (in_action) return;
  if (view.volume_settled_ml != volumes.cubic_ml) {
    view.volume_before_ml = view.volume_settled_ml;
    view.volume_settled_ml = volumes.cubic_ml;
  }
}

}  // namespace

void StructureViews::clear() { views_.clear(); }

const StructureView* StructureViews::find(std::uint64_t id) const {
  const auto found = views_.find(id);
  return found == views_.end() ? nullptr : found->second.get();
}

void StructureViews::update(const Document& document, Worker& worker) {
  const std::vector<std::uint64_t>& ids = document.content().ids;
  std::erase_if(views_, [&](const auto& item) { return std::find(ids.begin(), ids.end(), item.first) == ids.end(); });
  for (std::size_t i = 0; i < ids.size(); ++i) {
    auto& view = views_[ids[i]];
    if (!view) view = std::make_shared<StructureView>();
    if (!document.is_calibrated()) continue;
    if (view->placement != document.placement_revision()) {
      *view = StructureView();
      view->placement = document.placement_revision();
    }
    measure(document, i, *view, worker);
    if (show_surfaces && !document.in_action()) make_surface(document, i, *view, worker);
  }
}

void StructureViews::measure_alone(const Document& document, const Structure& structure, StructureView& view) {
  const FrameLocator& locator = document.scan()->locators.front();
  view.warnings.clear();
  view.error.clear();
  try {
    if (document.in_action()) {
      update_sections(structure, locator, view);
    } else {
      view.sections = cross_sections(structure, locator, &view.warnings);
    }
    VolumeMeasurement measured = measure_planimetry(view.sections);
    view.warnings.insert(view.warnings.end(), measured.warnings.begin(), measured.warnings.end());
    set_volumes(measured.volumes, document.in_action(), view);
  } catch (const Error& error) {
    view.error = error.what();
    view.sections.clear();
    view.section_of.clear();
    set_volumes({}, document.in_action(), view);
  }
}

void StructureViews::measure(const Document& document, std::size_t index, StructureView& view, Worker& worker) {
  // An action that ends without a further change makes what was measured the settled volume.
  const std::uint64_t revision = document.structure_revision(index) * 2 + (document.in_action() ? 1 : 0);
  if (view.measured == revision && view.measured_division == document.division_revision()) return;
  view.measured = revision;
  view.measured_division = document.division_revision();
  const Structure& structure = document.structures()[index];
  std::optional<Division> division;
  try {
    division = document.division();
  } catch (const Error& error) {
    view.error = error.what();
    set_volumes({}, document.in_action(), view);
    return;
  }
  if (!division) return measure_alone(document, structure, view);

  const std::uint64_t id = document.content().ids[index];
  const bool in_action = document.in_action();
  const auto work = [this, id, revision, in_action, structure, division = *division,
                     scan = document.scan()](const Progress&) -> std::function<void()> {
    const PartitionedVolume measured =
        division.partition.planes().empty()
            ? measure_sweeps(structure, scan->locators, division.sweeps)
            : measure_partitions(structure, scan->locators, division.sweeps, division.partition);
    std::vector<CrossSection> sections;
    for (const Sweep& sweep : division.sweeps) {
      for (const SectionOutline& outline : section_outlines(structure, scan->locators[sweep.recording], sweep)) {
        sections.push_back(outline.whole);
      }
    }
    return [this, id, revision, in_action, measured, sections] {
      const auto found = views_.find(id);
      if (found == views_.end()) return;
      StructureView& target = *found->second;
      target.error.clear();
      target.sections = sections;
      target.section_of.clear();
      target.warnings = measured.warnings;
      set_volumes(measured.total, in_action, target);
    };
  };
  const auto failed = [this, id](const std::string& error) {
    const auto found = views_.find(id);
    if (found == views_.end()) return;
    found->second->error = error;
    set_volumes({}, false, *found->second);
  };
  worker.start({"volume:" + std::to_string(id), "Volume of " + structure.name, work, failed});
}

void StructureViews::make_surface(const Document& document, std::size_t index, StructureView& view, Worker& worker) {
  const std::uint64_t revision = document.structure_revision(index);
  if (view.surfaced == revision && view.surfaced_division == document.division_revision()) return;
  view.surfaced = revision;
  view.surfaced_division = document.division_revision();
  const Structure& structure = document.structures()[index];
  const std::uint64_t id = document.content().ids[index];
  const std::string key = "surface:" + std::to_string(id);
  std::optional<Division> division;
  try {
    division = document.division();
  } catch (const Error&) {
    return;  // said beside the volume
  }
  if (view.sections.size() < 2 && !division) {
    worker.cancel(key);
    view.mesh = nullptr;
    view.triangles = nullptr;
    view.surface_ml.reset();
    view.surface_error.clear();
    view.mesh_number = ++meshes_;
    return;
  }
  const std::shared_ptr<const Scan> scan = document.scan();
  if (!view.maker || view.scan != scan) {
    view.maker = std::make_shared<ContourSurface>(scan->locators.front(), ContourSurfaceOptions{});
    view.scan = scan;
  }
  struct Made {
    std::shared_ptr<const Mesh> mesh;
    std::shared_ptr<const std::vector<SceneVertex>> triangles;
    std::optional<double> volume_ml;
    int layers = 0;
    int layers_made = 0;
  };
  const auto deliver = [this, id](const Made& made, const std::string& error) {
    const auto found = views_.find(id);
    if (found == views_.end()) return;
    StructureView& target = *found->second;
    target.mesh = made.mesh;
    target.triangles = made.triangles;
    target.surface_ml = made.volume_ml;
    target.layers = made.layers;
    target.layers_made = made.layers_made;
    target.surface_error = error;
    target.mesh_number = ++meshes_;
  };
  const auto work = [deliver, structure, division, scan,
                     maker = view.maker](const Progress& progress) -> std::function<void()> {
    Made made;
    if (division) {
      const PartitionedSurface surface =
          partition_surface(structure, scan->locators, *division, {}, Caps::kClosed, progress);
      made.mesh = std::make_shared<Mesh>(surface.mesh());
      made.volume_ml = surface.volume_ml;
    } else {
      made.mesh = std::make_shared<Mesh>(maker->update(structure, progress));
      made.volume_ml = maker->volume_ml();
      made.layers = maker->layers();
      made.layers_made = maker->layers_made();
    }
    made.triangles = std::make_shared<const std::vector<SceneVertex>>(scene_vertices(*made.mesh));
    return [deliver, made] { deliver(made, {}); };
  };
  worker.start(
      {key, "Surface of " + structure.name, work, [deliver](const std::string& error) { deliver({}, error); }});
}

}  // namespace fathom
