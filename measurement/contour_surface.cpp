#include "measurement/contour_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "core/numbers.h"
#include "measurement/carried_planes.h"
#include "measurement/contour_lattice.h"
#include "measurement/cross_section.h"
#include "measurement/curved_gap.h"
#include "measurement/frame_marks.h"
#include "measurement/lost_frames.h"
#include "measurement/planimetry.h"
#include "measurement/section_shape.h"
#include "measurement/sweep_signs.h"
#include "surface/layer_mesh.h"
#include "surface/mesh_measure.h"

namespace fathom {

namespace {

// The sections' distance fields have this many cells for every lattice spacing; more are hardly seen by the samples.
constexpr double kCellsPerSpacing = 2.0;
// The lattice reaches this many spacings beyond the contours; where interpolation leads farther out, twice as many, ...
constexpr double kMargin = 4.0;
constexpr double kMaxMargin = 256.0;
// Planes that are nearer to each other than this share of the spacing all over the contours are one plane.
constexpr double kSamePlane = 0.01;
// Normals of successive sections that are more than 120 degrees apart have no average that leads from one to the other.
constexpr double kMinGapCosine = -0.5;
// Default spacing: so many layers through the largest extent.
constexpr double kDefaultLayers = 80.0;
// A larger share of the volume passed backward is worth a word.
constexpr double kWorthAWord = 0.01;

using LayerPtr = std::shared_ptr<const SampledLayer>;
using MeshPtr = std::shared_ptr<const LayerMesh>;

// One marked frame and what was made of it.
struct Section {
  int frame = 0;
  std::vector<Polygon> outlines_px;
  std::optional<Eigen::Vector2d> extremity_px;
  CarriedPlane place;
  std::shared_ptr<const SectionShape> shape;
  LayerPtr layer;

  PlacedSection placed() const { return {place.plane, shape}; }

  bool absent() const { return outlines_px.empty() && !extremity_px; }

  bool marked_as(const FrameMarks& marks) const {
    const bool same_point = extremity_px.has_value() == (marks.extremity_px != nullptr) &&
                            (!extremity_px || *extremity_px == *marks.extremity_px);
    return frame == marks.frame && same_point &&
           std::equal(outlines_px.begin(), outlines_px.end(), marks.outlines.begin(), marks.outlines.end(),
                      [](const Polygon& mine, const Polygon* other) { return mine == *other; });
  }
};

// The lattice between two sections. Shapes are the same while their sections are, so that they tell whether it is, too.
struct Gap {
  using ShapePtr = std::shared_ptr<const SectionShape>;

  std::shared_ptr<const SectionGap> between;
  std::vector<ShapePtr> beyond;  // the sections before and behind that the samples depend on; null where there is none
  std::vector<LayerPtr> layers;  // the sections' own excluded

  bool is_between(const ShapePtr& first, const ShapePtr& second) const {
    return between->first().shape == first && between->second().shape == second;
  }
};

struct Bounds {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());

  void extend(const Eigen::Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  void extend(const Bounds& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
};

Bounds bounds_of(const Section& section) {
  Bounds bounds;
  for (const Polygon& outline : section.outlines_px) {
    for (const Eigen::Vector2d& point : outline) bounds.extend(section.place.ab_from_image * point);
  }
  if (section.extremity_px) bounds.extend(section.place.ab_from_image * *section.extremity_px);
  return bounds;
}

double two_digits(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / unit) * unit;
}

// The farthest and the mean distance of two sections' planes over the rectangle of their outlines.
struct Distance {
  double mean_mm = 0.0;
  double largest_mm = 0.0;
};

Distance distance_between(const Section& first, const Section& second) {
  Bounds bounds = bounds_of(first);
  bounds.extend(bounds_of(second));
  Distance distance;
  for (const double a : {bounds.low.x(), bounds.high.x()}) {
    for (const double b : {bounds.low.y(), bounds.high.y()}) {
      const Eigen::Vector2d ab(a, b);
      const double here = (second.place.plane.at(ab) - first.place.plane.at(ab)).norm();
      distance.mean_mm += 0.25 * here;
      distance.largest_mm = std::max(distance.largest_mm, here);
    }
  }
  return distance;
}

}  // namespace

void ContourSurfaceOptions::check() const {
  if (spacing_mm && !(std::isfinite(*spacing_mm) && *spacing_mm > 0.0)) {
    throw Error("the spacing of a surface must be a positive number of millimetres");
  }
  if (guide == Guide::kCentroids && order == GapOrder::kCurved) {
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
    std::vector<Section> sections;
    std::vector<Gap> gaps;
    std::vector<LayerPtr> layers;
    std::vector<MeshPtr> meshes;
    Mesh mesh;
    bool has_volume = false;
    std::vector<std::string> warnings;
    int layers_made = 0;
  };
  const State& state() const { return state_; }

 private:
  std::vector<Section> sections_of(const Structure& structure, std::vector<std::string>& warnings) const;
  double default_spacing(const std::vector<Section>& sections) const;
  void require_gaps(const Structure& structure, const State& made) const;
  void require_memory(const Structure& structure, const State& made) const;
  void make_shapes(State& made) const;
  void find_gaps(State& made) const;
  std::vector<int> gaps_to_make(State& made) const;
  void make_samples(State& made, std::size_t gap) const;
  bool make_layers(State& made, const Progress& progress) const;
  void make_meshes(State& made, const Progress& progress) const;
  void finish(State& made) const;
  [[noreturn]] void fail(const Structure& structure, const std::string& what) const {
    throw Error(locator_.recording_name() + ": structure " + structure.name + ": " + what);
  }

  FrameLocator locator_;
  ContourSurfaceOptions options_;
  std::vector<std::optional<CarriedPlane>> planes_;
  State state_;
};

std::vector<Section> ContourSurface::Maker::sections_of(const Structure& structure,
                                                        std::vector<std::string>& warnings) const {
  std::vector<Section> sections;
  std::vector<int> lost;
  int outlined = 0;
  bool any_area = false;
  for (const FrameMarks& marks : frame_marks(structure, locator_)) {
    const auto& place = planes_[static_cast<std::size_t>(marks.frame)];
    if (!place) {
      if (!marks.absent) lost.push_back(marks.frame);
      continue;
    }
    if (marks.absent && outlined == 0) continue;
    const auto same = std::find_if(state_.sections.begin(), state_.sections.end(),
                                   [&marks](const Section& section) { return section.marked_as(marks); });
    if (same != state_.sections.end()) {
      sections.push_back(*same);
    } else {
      Section section;
      section.frame = marks.frame;
      section.place = *place;
      for (const Polygon* outline : marks.outlines) section.outlines_px.push_back(*outline);
      if (marks.extremity_px) section.extremity_px = *marks.extremity_px;
      sections.push_back(std::move(section));
    }
    if (!marks.absent) ++outlined;
    any_area = any_area || even_odd_area(marks.outlines).area_px2 > 0.0;
  }
  while (!sections.empty() && sections.back().absent()) sections.pop_back();
  if (outlined < 2 || !any_area) {
    fail(structure, "outlines on at least two frames with a known position make a surface, and there are " +
                        std::to_string(outlined) + (outlined >= 2 ? ", none of which encloses an area" : "") +
                        "; outline more frames");
  }
  if (!lost.empty()) {
    warnings.push_back(lost_frames_warning(std::move(lost), sections.front().frame, sections.back().frame));
  }
  return sections;
}

double ContourSurface::Maker::default_spacing(const std::vector<Section>& sections) const {
  Bounds bounds;
  double path_mm = 0.0;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    bounds.extend(bounds_of(sections[i]));
    if (i > 0) path_mm += distance_between(sections[i - 1], sections[i]).mean_mm;
  }
  const double extent_mm = std::max({bounds.high.x() - bounds.low.x(), bounds.high.y() - bounds.low.y(), path_mm});
  return two_digits(extent_mm / kDefaultLayers);
}

void ContourSurface::Maker::require_gaps(const Structure& structure, const State& made) const {
  for (std::size_t i = 1; i < made.sections.size(); ++i) {
    const Section& first = made.sections[i - 1];
    const Section& second = made.sections[i];
    const std::string frames = "frames " + std::to_string(first.frame) + " and " + std::to_string(second.frame);
    if (first.place.run != second.place.run ||
        first.place.plane.normal().dot(second.place.plane.normal()) < kMinGapCosine) {
      fail(structure, frames +
                          " are turned away from each other by more than 120 degrees, so there is no surface "
                          "between them; outline frames in between, or measure the two sweeps apart");
    }
    if (!first.absent() && !second.absent() &&
        distance_between(first, second).largest_mm < kSamePlane * made.spacing_mm) {
      fail(structure, frames + " lie on the same plane; remove the outline of one of them");
    }
  }
}

void ContourSurface::Maker::require_memory(const Structure& structure, const State& made) const {
  std::int64_t layers = 1;
  for (std::size_t i = 1; i < made.sections.size(); ++i) {
    layers += layers_between(distance_between(made.sections[i - 1], made.sections[i]).mean_mm, made.spacing_mm);
  }
  const double samples = static_cast<double>(layers) * static_cast<double>(made.lattice.samples_per_layer());
  const auto most = static_cast<double>(kMaxSamples);
  if (samples <= most) return;
  const double fits_mm = two_digits(made.spacing_mm * std::cbrt(samples / most));
  fail(structure, "a surface spacing of " + format_real(made.spacing_mm) + " mm takes " +
                      format_real(std::ceil(samples * sizeof(float) / 1e9)) + " GB of samples; " +
                      format_real(fits_mm) + " mm fits");
}

void ContourSurface::Maker::make_shapes(State& made) const {
  const double cell_mm = made.spacing_mm / kCellsPerSpacing;
  cv::parallel_for_(cv::Range(0, static_cast<int>(made.sections.size())), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      Section& section = made.sections[static_cast<std::size_t>(i)];
      if (section.shape) continue;
      if (section.absent()) {
        section.shape = std::make_shared<SectionShape>();
        continue;
      }
      if (section.extremity_px) {
        section.shape = std::make_shared<SectionShape>(section.place.ab_from_image * *section.extremity_px, cell_mm);
        continue;
      }
      std::vector<Polygon> outlines_mm = section.outlines_px;
      for (Polygon& outline : outlines_mm) {
        for (Eigen::Vector2d& point : outline) point = section.place.ab_from_image * point;
      }
      const SectionRaster raster = section_raster(outlines_mm, cell_mm);
      section.shape = std::make_shared<SectionShape>(std::move(outlines_mm), raster);
    }
  });
}

// What leads from section to section, whatever the lattice.
void ContourSurface::Maker::find_gaps(State& made) const {
  made.gaps.assign(made.sections.size() - 1, {});
  cv::parallel_for_(cv::Range(0, static_cast<int>(made.gaps.size())), [&](const cv::Range& range) {
    for (int index = range.start; index < range.end; ++index) {
      const auto i = static_cast<std::size_t>(index);
      const PlacedSection first = made.sections[i].placed();
      const PlacedSection second = made.sections[i + 1].placed();
      const auto same = std::find_if(state_.gaps.begin(), state_.gaps.end(),
                                     [&](const Gap& gap) { return gap.is_between(first.shape, second.shape); });
      made.gaps[i].between =
          same != state_.gaps.end() ? same->between : std::make_shared<const SectionGap>(first, second, options_.guide);
    }
  });
  if (options_.order == GapOrder::kLinear) return;
  for (std::size_t i = 0; i < made.gaps.size(); ++i) {
    const bool last = i + 1 == made.gaps.size();
    made.gaps[i].beyond = {i > 0 ? made.sections[i - 1].shape : nullptr, last ? nullptr : made.sections[i + 2].shape};
  }
}

// Takes over the samples of those that are the same as before.
std::vector<int> ContourSurface::Maker::gaps_to_make(State& made) const {
  std::vector<int> to_make;
  for (std::size_t i = 0; i < made.gaps.size(); ++i) {
    Gap& gap = made.gaps[i];
    const auto same = std::find_if(state_.gaps.begin(), state_.gaps.end(), [&](const Gap& before) {
      return before.between == gap.between && before.beyond == gap.beyond;
    });
    if (made.lattice == state_.lattice && same != state_.gaps.end()) {
      gap.layers = same->layers;
    } else {
      to_make.push_back(static_cast<int>(i));
    }
  }
  return to_make;
}

void ContourSurface::Maker::make_samples(State& made, std::size_t i) const {
  Gap& gap = made.gaps[i];
  const int count = layers_between(distance_between(made.sections[i], made.sections[i + 1]).mean_mm, made.spacing_mm);
  std::optional<CurvedGap> curved;
  if (options_.order == GapOrder::kCurved) {
    curved.emplace(*gap.between, i > 0 ? made.gaps[i - 1].between.get() : nullptr,
                   i + 1 < made.gaps.size() ? made.gaps[i + 1].between.get() : nullptr);
  }
  gap.layers = gap_layers(made.lattice, *gap.between, count, curved ? &*curved : nullptr);
}

// Returns false when the surface leaves the lattice.
bool ContourSurface::Maker::make_layers(State& made, const Progress& progress) const {
  const bool same_lattice = made.lattice == state_.lattice;
  const std::vector<int> to_make = gaps_to_make(made);

  // Little by little, so that the listener is asked often enough.
  const int at_once = std::max(1, cv::getNumThreads());
  for (std::size_t begin = 0; begin < to_make.size(); begin += static_cast<std::size_t>(at_once)) {
    report(progress, 0.8 * static_cast<double>(begin) / static_cast<double>(to_make.size()));
    const int end = std::min(static_cast<int>(begin) + at_once, static_cast<int>(to_make.size()));
    cv::parallel_for_(
        cv::Range(static_cast<int>(begin), end),
        [&](const cv::Range& range) {
          for (int index = range.start; index < range.end; ++index) {
            make_samples(made, static_cast<std::size_t>(to_make[static_cast<std::size_t>(index)]));
          }
        },
        at_once);
  }
  for (Section& section : made.sections) {
    if (section.layer && same_lattice) continue;
    section.layer = std::make_shared<SampledLayer>(section_layer(made.lattice, section.placed()));
    ++made.layers_made;
  }
  for (const int i : to_make) {
    const Gap& gap = made.gaps[static_cast<std::size_t>(i)];
    made.layers_made += static_cast<int>(gap.layers.size());
    for (const LayerPtr& layer : gap.layers) {
      if (touches_border(*layer)) return false;
    }
  }

  made.layers.clear();
  for (std::size_t i = 0; i < made.sections.size(); ++i) {
    made.layers.push_back(made.sections[i].layer);
    if (i < made.gaps.size()) {
      made.layers.insert(made.layers.end(), made.gaps[i].layers.begin(), made.gaps[i].layers.end());
    }
  }
  return true;
}

void ContourSurface::Maker::make_meshes(State& made, const Progress& progress) const {
  const int count = static_cast<int>(made.layers.size());
  std::unordered_map<const SampledLayer*, int> place_before;
  for (std::size_t k = 0; k < state_.layers.size(); ++k) {
    place_before.emplace(state_.layers[k].get(), static_cast<int>(k));
  }
  const auto layer_at = [](const std::vector<LayerPtr>& layers, int k) {
    return k >= 0 && k < static_cast<int>(layers.size()) ? layers[static_cast<std::size_t>(k)].get() : nullptr;
  };
  // A layer's mesh is kept where all that it depends on is the same as before.
  made.meshes.assign(made.layers.size(), nullptr);
  for (int k = 0; k < count; ++k) {
    const auto before = place_before.find(layer_at(made.layers, k));
    if (before == place_before.end()) continue;
    bool same = true;
    for (int d = -kLayerReach; d <= kLayerReach && same; ++d) {
      same = layer_at(made.layers, k + d) == layer_at(state_.layers, before->second + d);
    }
    if (same) made.meshes[static_cast<std::size_t>(k)] = state_.meshes[static_cast<std::size_t>(before->second)];
  }

  std::vector<const SampledLayer*> stack;
  for (const LayerPtr& layer : made.layers) stack.push_back(layer.get());
  MesherOptions mesher = options_.mesher;
  mesher.cap_ends = true;
  for (int first = 0; first < count;) {
    if (made.meshes[static_cast<std::size_t>(first)]) {
      ++first;
      continue;
    }
    int last = first + 1;
    while (last < count && !made.meshes[static_cast<std::size_t>(last)]) ++last;
    report(progress, 0.8 + 0.2 * first / count);
    std::vector<LayerMesh> meshes = mesh_layers(stack, first, last, mesher);
    for (int k = first; k < last; ++k) {
      made.meshes[static_cast<std::size_t>(k)] =
          std::make_shared<LayerMesh>(std::move(meshes[static_cast<std::size_t>(k - first)]));
    }
    first = last;
  }
}

void ContourSurface::Maker::finish(State& made) const {
  SweepSigns signs;
  std::vector<const LayerMesh*> meshes;
  std::size_t layer = 0;
  for (std::size_t i = 0; i < made.gaps.size(); ++i) {
    const std::size_t end = layer + made.gaps[i].layers.size() + 1;
    signs.add_gap(made.sections[i].place.plane, made.sections[i + 1].place.plane, made.lattice,
                  std::span(made.layers).subspan(layer, end - layer + 1));
    layer = end;
  }
  for (const MeshPtr& mesh : made.meshes) meshes.push_back(mesh.get());
  made.mesh = join(meshes);
  const double backward = signs.apply(meshes, made.mesh);
  if (backward > kWorthAWord) {
    made.warnings.push_back(format_real(std::round(100.0 * backward)) +
                            " % of what the sweep passed was passed backward and counts negative");
  }
}

void ContourSurface::Maker::update(const Structure& structure, const Progress& progress) {
  State made;
  made.sections = sections_of(structure, made.warnings);
  made.spacing_mm = state_.spacing_mm > 0.0 ? state_.spacing_mm
                    : options_.spacing_mm   ? *options_.spacing_mm
                                            : default_spacing(made.sections);
  require_gaps(structure, made);
  Bounds bounds;
  for (const Section& section : made.sections) bounds.extend(bounds_of(section));
  const Lattice lattice = options_.mesher.lattice();
  bool made_layers = false;
  for (double margin = kMargin; !made_layers; margin *= 2.0) {
    if (margin > kMaxMargin) {
      fail(structure, "the surface runs far out of its outlines; outline a frame in between where they differ most");
    }
    made.lattice = contour_lattice(lattice, made.spacing_mm, bounds.low, bounds.high, margin);
    require_memory(structure, made);
    if (margin == kMargin) {
      make_shapes(made);
      find_gaps(made);
    }
    made_layers = make_layers(made, progress);
  }
  make_meshes(made, progress);
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
int ContourSurface::layers() const { return static_cast<int>(maker_->state().layers.size()); }
int ContourSurface::layers_made() const { return maker_->state().layers_made; }

std::optional<double> ContourSurface::volume_ml() const {
  if (!maker_->state().has_volume) return std::nullopt;
  return volume_mm3(mesh()) / 1000.0;
}

}  // namespace fathom
