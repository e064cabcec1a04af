#include "sim/studies/mesher_report.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include <nlohmann/json.hpp>

#include "core/numbers.h"
#include "sim/studies/formula_surfaces.h"
#include "surface/shaded_picture.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kCubes = 0;
constexpr std::size_t kTetrahedra = 1;
constexpr std::size_t kRegularised = 2;
constexpr std::size_t kByCurvature = 3;

/// The meshes of one object on one lattice, or the pictures of one way to shade.
using Group = std::span<const Json>;

std::vector<Group> groups_of(const std::vector<Json>& results, const char* kind) {
  std::vector<Group> groups;
  for (std::size_t i = 0; i + kMeshMethods.size() <= results.size(); i += kMeshMethods.size()) {
    if (results[i].at("kind") == kind) groups.push_back(Group(results).subspan(i, kMeshMethods.size()));
  }
  return groups;
}

double number(const Json& json, const char* key) { return json.at(key).get<double>(); }

double share(const Group& group, std::size_t method, std::size_t of, const char* key) {
  return number(group[method], key) / number(group[of], key);
}

const FormulaSurface& surface_of(const Group& group) {
  const auto& all = formula_surfaces();
  return *std::find_if(all.begin(), all.end(),
                       [&](const FormulaSurface& s) { return group[0].at("object") == s.name; });
}

bool is_published(const Group& group) { return group[0].at("published").get<bool>(); }

std::string in_brackets(const std::string& text, const std::optional<std::string>& published) {
  return published ? text + " (" + *published + ")" : text;
}

StudyTable triangles_table(const std::vector<Group>& groups) {
  StudyTable table;
  table.name = "triangles";
  table.title = "Triangles, and what is left of volume and area (table 3.2 and 3.3)";
  table.columns = {"object", "spacing", "MC", "MT", "RMT", "RMT / MT", "RMT / MC", "volume, % of MT", "area, % of MT"};
  table.remark =
      "RMT with vertices in the middle of their cuts; in brackets: published. Objects are of size 1 (sphere, torus, "
      "bumpy) "
      "or as their equations are; the first three on the lattice on which marching cubes make the published number of "
      "triangles.";
  for (const Group& group : groups) {
    const auto& published = is_published(group) ? surface_of(group).published : std::nullopt;
    const auto count = [&](std::size_t method, int PublishedMeshes::*printed) {
      const auto text = published ? std::optional(std::to_string((*published).*printed)) : std::nullopt;
      return in_brackets(std::to_string(group[method].at("triangles").get<int>()), text);
    };
    const bool open = surface_of(group).open;
    table.rows.push_back(
        {surface_of(group).name, format_rounded(number(group[0], "spacing_mm"), 4),
         count(kCubes, &PublishedMeshes::cubes), count(kTetrahedra, &PublishedMeshes::tetrahedra),
         count(kRegularised, &PublishedMeshes::regularised),
         format_rounded(share(group, kRegularised, kTetrahedra, "triangles"), 3),
         format_rounded(share(group, kRegularised, kCubes, "triangles"), 3),
         open ? "-"
              : in_brackets(format_rounded(100.0 * share(group, kRegularised, kTetrahedra, "volume_mm3"), 2),
                            published && published->volume_percent
                                ? std::optional(format_rounded(*published->volume_percent, 2))
                                : std::nullopt),
         in_brackets(format_rounded(100.0 * share(group, kRegularised, kTetrahedra, "area_mm2"), 2),
                     published ? std::optional(format_rounded(published->area_percent, 2)) : std::nullopt)});
  }
  return table;
}

/// A table with a row a group and a figure a method.
template <typename Cell>
StudyTable by_method(const char* name, const char* title, const char* remark, const std::vector<Group>& groups,
                     Cell cell) {
  StudyTable table;
  table.name = name;
  table.title = title;
  table.remark = remark;
  table.columns = {"object", "spacing"};
  for (const MeshMethod& method : kMeshMethods) table.columns.emplace_back(method.label);
  for (const Group& group : groups) {
    std::vector<std::string> cells = {surface_of(group).name, format_rounded(number(group[0], "spacing_mm"), 4)};
    for (const Json& mesh : group) cells.push_back(cell(group, mesh));
    table.rows.push_back(std::move(cells));
  }
  return table;
}

StudyTable shading_table(const std::vector<Group>& groups) {
  StudyTable table;
  table.name = "shading";
  table.title = "Variation of shading of a sphere seen from 20 directions, grey levels of 255 (table 3.4)";
  table.columns = {"normals", "mesh", "triangles", "mean, picture", "mean, sphere", "largest", "border pixels (%)"};
  table.remark =
      "Published: mean over the sphere MC 2.83, MT 2.85, RMT 1.21. That is the variation of normals taken from the "
      "triangles. With the field's own normals all vary far less, as only the interpolation across a triangle is left.";
  for (const Group& group : groups) {
    for (std::size_t m = 0; m < group.size(); ++m) {
      const Json& v = group[m];
      table.rows.push_back({v.at("normals").get<std::string>(), kMeshMethods[m].label,
                            std::to_string(v.at("triangles").get<int>()), format_rounded(number(v, "mean_image"), 2),
                            format_rounded(number(v, "mean_sphere"), 2), format_rounded(number(v, "largest_sphere"), 2),
                            format_rounded(number(v, "border_percent"), 2)});
    }
  }
  return table;
}

/// The worst of a figure over some meshes, and whether it keeps to a limit.
class Worst {
 public:
  explicit Worst(double limit) : limit_(limit) {}
  void add(double value, const std::string& where) {
    if (value <= worst_) return;
    worst_ = value;
    where_ = where;
  }
  StudyGoal goal(std::string what, std::string wanted, int decimals) const {
    return {std::move(what), std::move(wanted), format_rounded(worst_, decimals) + ", " + where_, worst_ <= limit_};
  }

 private:
  double limit_;
  double worst_ = -1e300;
  std::string where_;
};

std::string place_of(const Group& group, std::size_t method) {
  return surface_of(group).name + " at " + format_rounded(number(group[0], "spacing_mm"), 4) + ", " +
         kMeshMethods[method].label;
}

void add_goals(const std::vector<Group>& meshes, const std::vector<Group>& shadings, StudyReport& report) {
  Worst of_tetrahedra(0.30);
  Worst of_cubes_sphere(0.60);
  Worst of_cubes(0.70);
  Worst p95(1.6);
  Worst above_smooth(0.1);
  Worst above_edged(0.3);
  Worst beyond_cubes(0.1);
  Worst lost_of_tetrahedra(0.5);
  int wrong_topology = 0;
  int without_area = 0;
  for (const Group& group : meshes) {
    const FormulaSurface& surface = surface_of(group);
    for (const std::size_t m : {kRegularised, kByCurvature}) {
      const Json& mesh = group[m];
      const std::string place = place_of(group, m);
      wrong_topology += mesh.at("euler_characteristic") != group[kTetrahedra].at("euler_characteristic") ? 1 : 0;
      without_area += mesh.at("zero_area_triangles").get<int>();
      p95.add(number(mesh, "radius_ratio_p95"), place);
      const bool edged = surface.name == "peaks" || surface.name == "closed";
      (edged ? above_edged : above_smooth).add(number(mesh, "above_2_percent"), place);
      if (is_published(group)) {
        of_tetrahedra.add(share(group, m, kTetrahedra, "triangles"), place);
        (edged ? of_cubes : of_cubes_sphere).add(share(group, m, kCubes, "triangles"), place);
      }
      if (surface.volume_mm3) {
        const auto error = [&](std::size_t of) {
          return 100.0 * std::abs(number(group[of], "volume_mm3") / *surface.volume_mm3 - 1.0);
        };
        beyond_cubes.add(error(m) - 2.0 * error(kCubes), place);
      }
      if (surface.name == "sphere") {
        lost_of_tetrahedra.add(100.0 * (1.0 - share(group, m, kTetrahedra, "volume_mm3")), place);
      }
    }
  }
  const auto count_goal = [](std::string what, int count) {
    return StudyGoal{std::move(what), "none", std::to_string(count), count == 0};
  };
  report.goals = {of_tetrahedra.goal("triangles, RMT of MT, published objects", "<= 0.30", 3),
                  of_cubes_sphere.goal("triangles, RMT of MC, sphere", "<= 0.60", 3),
                  of_cubes.goal("triangles, RMT of MC, closed and peaks", "<= 0.70", 3),
                  p95.goal("radius ratio of RMT, 95th percentile", "<= 1.6", 3),
                  above_smooth.goal("triangles of RMT with a radius ratio above 2, smooth objects (%)", "<= 0.1", 3),
                  above_edged.goal("the same, objects with edges or tips (%)", "<= 0.3", 3),
                  beyond_cubes.goal("error of RMT's volume beyond twice that of MC, in percent", "<= 0.1", 3),
                  lost_of_tetrahedra.goal("volume of the sphere that RMT loses of MT's (%)", "<= 0.5", 3),
                  count_goal("meshes of another topology than MT's", wrong_topology),
                  count_goal("triangles without area", without_area)};
  for (const Group& group : shadings) {
    const double variation = share(group, kRegularised, kCubes, "mean_sphere");
    const std::string normals = group[0].at("normals");
    report.goals.push_back({"variation of shading, RMT of MC, normals from the " + normals, "<= 0.45",
                            format_rounded(variation, 2), variation <= 0.45});
  }
}

/// The same triangles, each with corners of its own, so that each is shaded as the flat piece that it is.
Mesh with_flat_triangles(const Mesh& mesh) {
  Mesh flat;
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    const auto first = static_cast<std::int32_t>(flat.vertices.size());
    for (const std::int32_t vertex : triangle) flat.vertices.push_back(mesh.vertices[static_cast<std::size_t>(vertex)]);
    flat.triangles.push_back({first, first + 1, first + 2});
  }
  return flat;
}

/// The meshes as they look, flat triangles shaded: their edges show.
void add_pictures(const std::vector<Group>& groups, StudyReport& report) {
  for (const Group& group : groups) {
    if (!is_published(group)) continue;
    for (const std::size_t m : {kCubes, kTetrahedra, kRegularised}) {
      const FormulaSurface& surface = surface_of(group);
      const Mesh mesh =
          with_flat_triangles(formula_mesh(surface, kMeshMethods[m].options(), number(group[m], "spacing_mm")));
      OrthographicView view;
      view.direction = {-0.5, 0.6, -0.62};
      view.up = Eigen::Vector3d::UnitZ();
      view.width_px = 320;
      view.height_px = 320;
      Shading shading;
      shading.samples_per_px = 3;
      shading.background = cv::Scalar::all(255.0);
      const ColoredMesh painted{&mesh, cv::Scalar(205, 190, 120)};
      report.pictures.push_back({surface.name + "-" + kMeshMethods[m].name, surface.name + ", " + kMeshMethods[m].label,
                                 shaded_picture(std::span(&painted, 1), view, shading).picture});
    }
  }
}

}  // namespace

StudyReport mesher_report(const std::vector<Json>& results) {
  const std::vector<Group> meshes = groups_of(results, "mesh");
  const std::vector<Group> shadings = groups_of(results, "shading");
  StudyReport report;
  report.tables = {triangles_table(meshes),
                   by_method("quality", "Radius ratio: 95th percentile; share of triangles above 2 (%)",
                             "1 is equilateral. On eight lattices, placed differently: the worst 95th percentile, and "
                             "the mean share. Triangles at "
                             "the rim of an open surface are left out.",
                             meshes,
                             [](const Group&, const Json& mesh) {
                               return format_rounded(number(mesh, "radius_ratio_p95"), 2) + "; " +
                                      format_rounded(number(mesh, "above_2_percent"), 3);
                             }),
                   by_method("volume", "Error of the volume (%)", "Where there is a formula for the true one.", meshes,
                             [](const Group& group, const Json& mesh) {
                               const auto& truth = surface_of(group).volume_mm3;
                               return truth ? format_signed(100.0 * (number(mesh, "volume_mm3") / *truth - 1.0), 3)
                                            : std::string("-");
                             }),
                   shading_table(shadings)};
  add_goals(meshes, shadings, report);
  add_pictures(meshes, report);
  return report;
}

}  // namespace fathom
