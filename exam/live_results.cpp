#include "exam/live_results.h"

#include <utility>

#include "core/error.h"
#include "measurement/partition_surface.h"
#include "measurement/section_outline.h"

namespace fathom {

namespace {

// What a surface is made of. Equal ones share an incremental surface.
struct SurfaceSource {
  std::shared_ptr<const Scan> scan;
  std::optional<Sweep> sweep;  ///< the only one with outlines; empty: the scan is taken as one
  std::uint64_t options = 0;   ///< counts their changes

  bool operator==(const SurfaceSource&) const = default;
};

// Only the thread that works touches it: jobs of one key never run at once.
struct SurfaceMaker {
  SurfaceSource source;
  std::optional<ContourSurface> surface;
};

LiveSurface whole_surface(SurfaceMaker& maker, const SurfaceSource& source, const ContourSurfaceOptions& options,
                          const Structure& structure, const Progress& progress) {
  if (!maker.surface || maker.source != source) {
    maker.surface.emplace(source.scan->locators[source.sweep ? source.sweep->recording : 0], options);
    maker.source = source;
  }
  LiveSurface made;
  const Structure here = source.sweep ? part_in_sweep(structure, *source.sweep) : structure;
  made.mesh = std::make_shared<const Mesh>(maker.surface->update(here, progress));
  made.volume_ml = maker.surface->volume_ml();
  made.warnings = maker.surface->warnings();
  return made;
}

// The only sweep with outlines, where nothing divides space.
std::optional<Sweep> only_sweep(const Structure& structure, const Division& division) {
  if (!division.partition.planes().empty()) return std::nullopt;
  std::optional<Sweep> only;
  for (const Sweep& sweep : division.sweeps) {
    const Structure here = part_in_sweep(structure, sweep);
    if (here.contours.empty() && here.extremities.empty()) continue;
    if (only) return std::nullopt;
    only = sweep;
  }
  return only;
}

LiveSurface divided_surface(const Scan& scan, const Division& division, const ContourSurfaceOptions& options,
                            const Structure& structure, const Progress& progress) {
  PartitionedSurface surface = partition_surface(structure, scan.locators, division, options, Caps::kClosed, progress);
  LiveSurface made;
  made.mesh = std::make_shared<const Mesh>(surface.mesh());
  made.volume_ml = surface.volume_ml;
  made.warnings = std::move(surface.warnings);
  return made;
}

}  // namespace

struct LiveResults::Item {
  LiveVolume volume;
  std::uint64_t volume_revision = 0;
  std::uint64_t placement_revision = 0;
  LiveSurface surface;
  std::uint64_t requested = 0;  ///< revision that the newest job is of
  std::string key;
  std::shared_ptr<SurfaceMaker> maker = std::make_shared<SurfaceMaker>();
};

LiveResults::LiveResults(const Document& document, Worker& worker) : document_(document), worker_(worker) {}

LiveResults::~LiveResults() {
  for (const auto& [id, item] : items_) worker_.cancel(item->key);
}

LiveResults::Item& LiveResults::item(std::size_t structure) {
  // Those of deleted structures stay: undo brings them back as they were.
  const std::uint64_t id = document_.content().ids.at(structure);
  auto& found = items_[id];
  if (!found) {
    found = std::make_shared<Item>();
    found->key = "surface " + std::to_string(id);
  }
  return *found;
}

const VolumeMeasurement& LiveResults::volume(std::size_t structure) {
  Item& of = item(structure);
  const std::uint64_t revision = document_.result_revision(structure);
  if (of.volume_revision == revision) return of.volume.measurement();
  if (of.placement_revision != document_.placement_revision()) of.volume.clear();
  of.placement_revision = document_.placement_revision();
  of.volume_revision = revision;
  std::string fault;
  std::optional<Division> division;
  if (!document_.is_calibrated()) fault = "there is no calibration, so that nothing can be measured: choose one";
  try {
    if (fault.empty()) division = document_.division();
  } catch (const Error& error) {
    fault = error.what();
  }
  if (!fault.empty()) return of.volume.refuse(fault);
  return of.volume.update(document_.structures()[structure], *document_.scan(), division);
}

const std::vector<CrossSection>& LiveResults::sections(std::size_t structure) {
  volume(structure);
  return item(structure).volume.sections();
}

void LiveResults::request_surfaces() {
  if (!document_.is_calibrated()) return;
  for (std::size_t i = 0; i < document_.structures().size(); ++i) {
    Item& of = item(i);
    const std::uint64_t revision = document_.result_revision(i);
    if (of.requested != revision) start_surface(i, of, revision);
  }
}

void LiveResults::start_surface(std::size_t structure, Item& of, std::uint64_t revision) {
  of.requested = revision;
  of.surface.cancelled = false;
  std::optional<Division> division;
  try {
    division = document_.division();
  } catch (const Error& error) {
    of.surface.fault = error.what();
    of.surface.revision = revision;
    return;
  }
  const std::weak_ptr<Item> place = items_.at(document_.content().ids[structure]);
  const auto deliver = [place, revision](LiveSurface made) {
    const auto item = place.lock();
    if (!item) return;
    made.revision = revision;
    // The last surface stays in sight until there is a better one.
    if (!made.mesh) made.mesh = item->surface.mesh;
    item->surface = std::move(made);
  };
  Job job;
  job.key = of.key;
  job.title = "Surface of " + document_.structures()[structure].name;
  SurfaceSource source{document_.scan(), std::nullopt, options_changes_};
  if (division) source.sweep = only_sweep(document_.structures()[structure], *division);
  if (source.sweep) division.reset();
  job.work = [maker = of.maker, source = std::move(source), copy = document_.structures()[structure],
              division = std::move(division), options = options_,
              deliver](const Progress& progress) -> std::function<void()> {
    LiveSurface made = division ? divided_surface(*source.scan, *division, options, copy, progress)
                                : whole_surface(*maker, source, options, copy, progress);
    return [made = std::move(made), deliver] { deliver(made); };
  };
  job.failed = [deliver](const std::string& error) {
    LiveSurface none;
    none.fault = error;
    deliver(std::move(none));
  };
  worker_.start(std::move(job));
}

const LiveSurface& LiveResults::surface(std::size_t structure) { return item(structure).surface; }

bool LiveResults::is_current(std::size_t structure) {
  return item(structure).surface.revision == document_.result_revision(structure);
}

void LiveResults::cancel_surface(std::size_t structure) {
  Item& of = item(structure);
  worker_.cancel(of.key);
  of.surface.cancelled = !is_current(structure);
}

void LiveResults::retry_surface(std::size_t structure) {
  Item& of = item(structure);
  if (of.surface.cancelled) of.requested = 0;
}

void LiveResults::set_options(const ContourSurfaceOptions& options) {
  options.check();
  options_ = options;
  ++options_changes_;
  for (const auto& [id, item] : items_) {
    worker_.cancel(item->key);
    item->requested = item->surface.revision = 0;
  }
}

}  // namespace fathom
