#include "sim/studies/mesher_study.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "sim/studies/formula_surfaces.h"
#include "sim/studies/mesher_report.h"
#include "sim/studies/rendering_study.h"
#include "surface/mesh_check.h"
#include "surface/mesh_measure.h"
#include "surface/mesh_quality.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

/// An object on a lattice.
struct Setting {
  const FormulaSurface* surface = nullptr;
  double spacing_mm = 0.0;  ///< 0: at which marching cubes make the published number of triangles
};

std::vector<Setting> settings() {
  std::vector<Setting> settings;
  for (const FormulaSurface& surface : formula_surfaces()) {
    if (surface.published) settings.push_back({&surface, 0.0});
    if (surface.name == "sphere") {
      for (const double radius : {8.0, 16.0, 32.0}) settings.push_back({&surface, 1.0 / radius});  // in layer distances
    } else if (!surface.published) {
      for (const double inverse : {24.0, 48.0}) settings.push_back({&surface, 1.0 / inverse});
    }
  }
  return settings;
}

constexpr int kPlacements = 8;
constexpr std::size_t kShadings = 2;  // normals from triangles, from the field

/// The triangles that are not at the border, where an open surface's rim is held in it.
Mesh off_the_rim(Mesh mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const Mesh::Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[std::minmax(t[i], t[(i + 1) % 3])];
  }
  std::set<std::int32_t> rim;
  for (const auto& [edge, count] : edges) {
    if (count == 1) rim.insert({edge.first, edge.second});
  }
  std::erase_if(mesh.triangles, [&rim](const Mesh::Triangle& t) {
    return std::any_of(t.begin(), t.end(), [&rim](std::int32_t v) { return rim.contains(v); });
  });
  return mesh;
}

/// Where the lattice's middle lies, in layer distances: what the quality of single triangles at edges depends on.
std::vector<Eigen::Vector3d> placements() {
  std::vector<Eigen::Vector3d> all;
  for (int i = 0; i < kPlacements; ++i) {
    // Three irrational steps fill the cell evenly.
    const Eigen::Vector3d at = (0.5 + i) * Eigen::Vector3d(0.8191725, 0.6710436, 0.5497005);
    all.push_back(at - at.array().floor().matrix());
  }
  return all;
}

Json mesh_json(const Setting& setting, const MeshMethod& method) {
  const FormulaSurface& surface = *setting.surface;
  const double spacing_mm = setting.spacing_mm > 0.0 ? setting.spacing_mm : published_spacing_mm(surface);
  const Mesh mesh = formula_mesh(surface, method.options(), spacing_mm);
  double p95 = 0.0;
  double above_2 = 0.0;
  int without_area = 0;
  for (const Eigen::Vector3d& aside : placements()) {
    const MeshQuality quality = mesh_quality(off_the_rim(formula_mesh(surface, method.options(), spacing_mm, aside)));
    p95 = std::max(p95, quality.radius_ratio_p95);
    above_2 += quality.above_2 / kPlacements;
    without_area += quality.zero_area_triangles;
  }
  return {{"kind", "mesh"},
          {"object", surface.name},
          {"published", setting.spacing_mm == 0.0},
          {"mesher", method.name},
          {"spacing_mm", spacing_mm},
          {"vertices", mesh.vertices.size()},
          {"triangles", mesh.triangles.size()},
          {"volume_mm3", surface.open ? Json(nullptr) : Json(volume_mm3(mesh))},
          {"area_mm2", area_mm2(mesh)},
          {"radius_ratio_p95", p95},
          {"above_2_percent", 100.0 * above_2},
          {"zero_area_triangles", without_area},
          {"euler_characteristic", mesh_topology(mesh).euler_characteristic()}};
}

Json shading_json(ShadingNormals normals, const MeshMethod& method) {
  constexpr double kSpacing = 0.1275;  // marching cubes make the published number of triangles
  const RenderingVariation variation = rendering_variation(method.options(), kSpacing, normals);
  return {{"kind", "shading"},
          {"normals", normals == ShadingNormals::kField ? "field" : "triangles"},
          {"mesher", method.name},
          {"triangles", variation.triangles},
          {"mean_image", variation.mean_image},
          {"mean_sphere", variation.mean_sphere},
          {"largest_sphere", variation.largest_sphere},
          {"border_percent", variation.border_percent}};
}

class MesherStudy final : public Study {
 public:
  std::string name() const override { return "3"; }
  std::string title() const override { return "marching cubes, tetrahedra and regularised tetrahedra"; }

  int cases(const StudyOptions&) const override {
    return static_cast<int>((settings().size() + kShadings) * kMeshMethods.size());
  }

  std::string case_name(const StudyOptions&, int index) const override {
    const auto [setting, method] = places(index);
    const std::vector<Setting> all = settings();
    const std::string what = setting < all.size() ? all[setting].surface->name : "shading";
    return what + ", " + kMeshMethods[method].name;
  }

  Json run_case(const StudyOptions&, int index) const override {
    const auto [setting, method] = places(index);
    const std::vector<Setting> all = settings();
    if (setting < all.size()) return mesh_json(all[setting], kMeshMethods[method]);
    return shading_json(setting == all.size() ? ShadingNormals::kTriangles : ShadingNormals::kField,
                        kMeshMethods[method]);
  }

  Json rows(const StudyOptions&, const std::vector<Json>& results) const override { return results; }

  StudyReport report(const StudyOptions&, const std::vector<Json>& results) const override {
    return mesher_report(results);
  }

 private:
  static std::pair<std::size_t, std::size_t> places(int index) {
    const auto i = static_cast<std::size_t>(index);
    return {i / kMeshMethods.size(), i % kMeshMethods.size()};
  }
};

}  // namespace

const Study& mesher_study() {
  static const MesherStudy study;
  return study;
}

}  // namespace fathom
