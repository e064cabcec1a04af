#include "measurement/contour_surface.h"

#include <cmath>
#include <span>
#include <utility>

#include "core/error.h"
#include "core/numbers.h"
#include "measurement/carried_planes.h"
#include "measurement/contour_lattice.h"
#include "measurement/cross_section.h"
#include "measurement/kept_meshes.h"
#include "measurement/planimetry.h"
#include "measurement/surface_gap.h"
#include "measurement/surface_section.h"
#include "measurement/sweep_signs.h"
#include "surface/layer_mesh.h"
#include "surface/mesh_measure.h"

namespace fathom {

namespace {

// The lattice reaches this many spacings beyond the contours; where interpolation leads farther out, twice as many, ...
constexpr double kMargin = 4.0;
constexpr double kMaxMargin = 256.0;
// A larger share of the volume passed backward is worth a word.
constexpr double kWorthAWord = 0.01;
// Of the work, by time.
constexpr double kSampling = 0.8;

}  // namespace

GapOrder ContourSurfaceOptions::gap_order() const {
  return order.value_or(guide == Guide::kCentroids ? GapOrder::kLinear : GapOrder::kCurved);
}

void ContourSurfaceOptions::check() const {
  if (spacing_mm && !(std::isfinite(*spacing_mm) && *spacing_mm > 0.0)) {
    throw Error("the spacing of a surface must be a positive number of millimetres");
  }
  if (guide == Guide::kCentroids && gap_order() == GapOrder::kCurved) {
    throw Error("a surface guided by centroids is linear between its outlines; guide it by discs or shapes");
  }
}

// All that an update makes is kept in values that the next one shares or replaces, never changes, so that a failed one
// leaves no trace.
class ContourSurface::Maker {
 public:
  Maker(const FrameLocator& locator, const ContourSurfaceOptions& options)
      : locator_(locator), options_(options), planes_(carried_planes(locator)) {}

  void update(const Structure& structure, const Progress& progress);

  struct State {
    double spacing_mm = 0.0;
    ContourLattice lattice;
    std::vector<SurfaceSection> sections;
    std::vector<SurfaceGap> gaps;
    MeshedLayers stack;
    Mesh mesh;
    bool has_volume = false;
    std::vector<std::string> warnings;
    int layers_made = 0;
  };
  const State& state() const { return state_; }

 private:
  bool curved() const { return options_.gap_order() == GapOrder::kCurved; }
  double spacing_for(const std::vector<SurfaceSection>& sections) const;
  void require_memory(const State& made, const std::string& owner) const;
  bool make_stack(State& made, const Progress& progress) const;
  void finish(State& made) const;

  FrameLocator locator_;
  ContourSurfaceOptions options_;
  std::vector<std::optional<CarriedPlane>> planes_;
  State state_;
};

// Kept from the first update on.
double ContourSurface::Maker::spacing_for(const std::vector<SurfaceSection>& sections) const {
  if (state_.spacing_mm > 0.0) return state_.spacing_mm;
  return options_.spacing_mm ? *options_.spacing_mm : default_spacing_mm(sections);
}

void ContourSurface::Maker::require_memory(const State& made, const std::string& owner) const {
  const double samples = static_cast<double>(count_layers(made.sections, made.spacing_mm)) *
                         static_cast<double>(made.lattice.samples_per_layer());
  const auto most = static_cast<double>(kMaxSamples);
  if (samples <= most) return;
  const double fits_mm = to_two_digits(made.spacing_mm * std::cbrt(samples / most));
  throw Error(owner + "a surface spacing of " + format_real(made.spacing_mm) + " mm takes " +
              format_real(std::ceil(samples * sizeof(float) / 1e9)) + " GB of samples; " + format_real(fits_mm) +
              " mm fits");
}

// Returns false when the surface leaves the lattice.
bool ContourSurface::Maker::make_stack(State& made, const Progress& progress) const {
  const bool same_lattice = made.lattice == state_.lattice;
  const std::vector<int> to_make = keep_layers(made.gaps, same_lattice ? state_.gaps : std::vector<SurfaceGap>{});
  make_layers(made.sections, to_make, made.lattice, curved(), made.gaps, progress);
  for (SurfaceSection& section : made.sections) {
    if (section.layer && same_lattice) continue;
    section.layer = std::make_shared<SampledLayer>(section_layer(made.lattice, section.placed()));
    ++made.layers_made;
  }
  for (const int i : to_make) {
    const SurfaceGap& gap = made.gaps[static_cast<std::size_t>(i)];
    made.layers_made += static_cast<int>(gap.layers.size());
    for (const auto& layer : gap.layers) {
      if (touches_border(*layer)) return false;
    }
  }
  made.stack.layers.clear();
  for (std::size_t i = 0; i < made.sections.size(); ++i) {
    made.stack.layers.push_back(made.sections[i].layer);
    if (i == made.gaps.size()) break;
    made.stack.layers.insert(made.stack.layers.end(), made.gaps[i].layers.begin(), made.gaps[i].layers.end());
  }
  return true;
}

void ContourSurface::Maker::finish(State& made) const {
  SweepSigns signs;
  std::size_t layer = 0;
  for (std::size_t i = 0; i < made.gaps.size(); ++i) {
    const std::size_t end = layer + made.gaps[i].layers.size() + 1;
    signs.add_gap(made.sections[i].place.plane, made.sections[i + 1].place.plane, made.lattice,
                  std::span(made.stack.layers).subspan(layer, end - layer + 1));
    layer = end;
  }
  std::vector<const LayerMesh*> meshes;
  for (const auto& mesh : made.stack.meshes) meshes.push_back(mesh.get());
  made.mesh = join(meshes);
  const double backward = signs.apply(meshes, made.mesh);
  if (backward > kWorthAWord) {
    made.warnings.push_back(format_real(std::round(100.0 * backward)) +
                            " % of what the sweep passed was passed backward and counts negative");
  }
}

void ContourSurface::Maker::update(const Structure& structure, const Progress& progress) {
  const std::string owner = locator_.recording_name() + ": structure " + structure.name + ": ";
  State made;
  made.sections = surface_sections(structure, locator_, planes_, state_.sections, owner, made.warnings);
  made.spacing_mm = spacing_for(made.sections);
  require_gaps(made.sections, made.spacing_mm, owner);
  const SurfaceBounds bounds = bounds_of(made.sections);
  bool inside = false;
  for (double margin = kMargin; !inside; margin *= 2.0) {
    if (margin > kMaxMargin) {
      throw Error(owner +
                  "the surface runs far out of its outlines; outline a frame in between where they differ most");
    }
    made.lattice = contour_lattice(options_.mesher.lattice(), made.spacing_mm, bounds.low, bounds.high, margin);
    require_memory(made, owner);
    if (margin == kMargin) {
      make_shapes(made.sections, made.spacing_mm);
      made.gaps = surface_gaps(made.sections, state_.gaps, options_.guide, curved());
    }
    inside = make_stack(made, part_of(progress, 0.0, kSampling));
  }
  mesh_changed(state_.stack, options_.mesher, made.stack, part_of(progress, kSampling, 1.0));
  finish(made);
  // Surfaces add up to a volume where planimetry does: not in a rotational sweep.
  made.has_volume = measure_planimetry(cross_sections(structure, locator_, nullptr)).volumes.linear_ml.has_value();
  state_ = std::move(made);
}

ContourSurface::ContourSurface(const FrameLocator& locator, const ContourSurfaceOptions& options) {
  options.check();
  maker_ = std::make_unique<Maker>(locator, options);
}

ContourSurface::~ContourSurface() = default;
ContourSurface::ContourSurface(ContourSurface&& other) noexcept = default;
ContourSurface& ContourSurface::operator=(ContourSurface&& other) noexcept = default;

const Mesh& ContourSurface::update(const Structure& structure, const Progress& progress) {
  maker_->update(structure, progress);
  return mesh();
}

const Mesh& ContourSurface::mesh() const { return maker_->state().mesh; }
const std::vector<std::string>& ContourSurface::warnings() const { return maker_->state().warnings; }
double ContourSurface::spacing_mm() const { return maker_->state().spacing_mm; }
int ContourSurface::layers() const { return static_cast<int>(maker_->state().stack.layers.size()); }
int ContourSurface::layers_made() const { return maker_->state().layers_made; }

std::optional<double> ContourSurface::volume_ml() const {
  if (!maker_->state().has_volume) return std::nullopt;
  return volume_mm3(mesh()) / 1000.0;
}

}  // namespace fathom
