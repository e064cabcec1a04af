#include "cli/mesh_output.h"

#include <chrono>
#include <iostream>
#include <map>

#include "cli/output.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "surface/mesh_check.h"
#include "surface/mesh_file.h"
#include "surface/mesh_measure.h"
#include "surface/mesh_quality.h"

namespace fathom {

namespace {

constexpr double kMm3PerMl = 1000.0;
constexpr double kMm2PerCm2 = 100.0;

// Why a mesh has no volume; empty where it has one.
std::string fault_of(const MeshTopology& topology, const std::string& how_to_close) {
  if (!topology.closed()) {
    return "the mesh is open along " + std::to_string(topology.boundary_edges) + " edges and so encloses no volume; " +
           how_to_close;
  }
  if (!topology.manifold()) {
    return "the mesh touches itself along edges or in vertices and so encloses no certain volume; use --mesher rmt";
  }
  if (!topology.oriented()) {
    return "the mesh is not consistently oriented and so encloses no certain volume; use --mesher rmt";
  }
  return {};
}

}  // namespace

void add_mesher_options(CLI::App& command, MesherOptions& options) {
  static const std::map<std::string, Mesher> kMeshers = {
      {"rmt", Mesher::kRegularised}, {"mt", Mesher::kTetrahedra}, {"mc", Mesher::kCubes}};
  static const std::map<std::string, VertexPlacement> kPlacements = {{"average", VertexPlacement::kAverage},
                                                                     {"curvature", VertexPlacement::kCurvature}};
  const auto named = [](const auto& choices) { return CLI::CheckedTransformer(choices).description(""); };
  command
      .add_option("--mesher", options.mesher,
                  "rmt: regularised marching tetrahedra (default); mt: marching tetrahedra; mc: marching cubes")
      ->transform(named(kMeshers))
      ->type_name("rmt|mt|mc");
  command
      .add_option("--placement", options.placement,
                  "Where rmt puts vertices: average (default), or curvature, which keeps edges sharper")
      ->transform(named(kPlacements))
      ->type_name("average|curvature");
}

void require_mesh_name(const std::string& path) {
  if (is_mesh_file(path)) return;
  throw Error(path + ": its extension is not that of a mesh; use .ply, .stl, .obj, .off or .wrl");
}

MeshReport report_of(const Mesh& mesh, const std::string& how_to_close) {
  const MeshTopology topology = mesh_topology(mesh);
  const MeshQuality quality = mesh_quality(mesh);
  MeshReport report;
  report.vertices = mesh.vertices.size();
  report.triangles = mesh.triangles.size();
  report.area_cm2 = area_mm2(mesh) / kMm2PerCm2;
  report.closed = topology.closed();
  report.radius_ratio_p95 = quality.radius_ratio_p95;
  report.above_2 = quality.above_2;
  if (const std::string fault = fault_of(topology, how_to_close); fault.empty()) {
    report.volume_ml = volume_mm3(mesh) / kMm3PerMl;
  } else {
    report.warnings.push_back(fault);
  }
  return report;
}

nlohmann::ordered_json mesh_report_json(const MeshReport& report) {
  nlohmann::ordered_json json;
  json["vertices"] = report.vertices;
  json["triangles"] = report.triangles;
  json["volume_ml"] = report.volume_ml ? nlohmann::ordered_json(*report.volume_ml) : nlohmann::ordered_json();
  json["area_cm2"] = report.area_cm2;
  json["closed"] = report.closed;
  json["radius_ratio_p95"] = report.radius_ratio_p95;  // JSON knows no infinity: null
  json["above_2"] = report.above_2;
  json["seconds"] = report.seconds;
  json["warnings"] = report.warnings;
  return json;
}

void print_mesh_report(const MeshReport& report, const std::string& written_to, bool json) {
  if (json) {
    print_json(mesh_report_json(report));
    return;
  }
  print_table({{"vertices", std::to_string(report.vertices)},
               {"triangles", std::to_string(report.triangles)},
               {"volume (ml)", number_text(report.volume_ml, 4)},
               {"area (cm2)", number_text(report.area_cm2, 3)},
               {"closed", report.closed ? "yes" : "no"},
               {"radius ratio, 95th percentile", number_text(report.radius_ratio_p95, 3)},
               {"radius ratio above 2 (%)", number_text(100.0 * report.above_2, 2)},
               {"seconds", number_text(report.seconds, 3)}});
  std::cout << "written to " << written_to << "\n";
  for (const std::string& warning : report.warnings) std::cout << "warning: " << warning << "\n";
}

void add_mesh_output_options(CLI::App& command, MeshOutput& output) {
  command.add_option("--out", output.path, "The mesh to write: .ply, .stl, .obj, .off or .wrl")->required();
  command.add_flag("--json", output.json, "Print one JSON object");
}

void make_mesh(const MeshOutput& output, const std::string& how_to_close,
               const std::function<std::function<Mesh()>()>& prepare) {
  require_mesh_name(output.path);
  AtomicFile file(output.path);
  const std::function<Mesh()> make = prepare();
  const auto began = std::chrono::steady_clock::now();
  const Mesh mesh = make();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  MeshReport report = report_of(mesh, how_to_close);
  report.seconds = took.count();
  write_mesh(mesh, file);
  file.commit();
  print_mesh_report(report, output.path, output.json);
}

}  // namespace fathom
