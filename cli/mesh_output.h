#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "surface/layer_mesher.h"
#include "surface/mesh.h"

namespace fathom {

/// Adds `--mesher rmt|mt|mc` and `--placement average|curvature`.
void add_mesher_options(CLI::App& command, MesherOptions& options);

/// Throws Error when the extension of `path` is not that of a mesh: known before the work begins.
void require_mesh_name(const std::string& path);

/// What a command that makes a mesh says about it.
struct MeshReport {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::optional<double> volume_ml;  ///< empty where the mesh encloses none; `warnings` say why
  double area_cm2 = 0.0;
  bool closed = false;
  double radius_ratio_p95 = 0.0;  ///< of the triangles, see MeshQuality; infinite where there are many without area
  double above_2 = 0.0;
  double seconds = 0.0;  ///< to make the mesh; set by the caller
  std::vector<std::string> warnings;
};

/// Measures a mesh. `how_to_close` ends the warning about an open one, such as "--cap closes it". Throws Error when the
/// mesh has no triangles.
MeshReport report_of(const Mesh& mesh, const std::string& how_to_close);

/// The keys of `fathom surface --json`, in their order, and `warnings`.
nlohmann::ordered_json mesh_report_json(const MeshReport& report);

/// Prints what --json asks for, else the same for people: a table, the file that was written, and the warnings.
void print_mesh_report(const MeshReport& report, const std::string& written_to, bool json);

/// Where a command's one mesh goes and how it is reported.
struct MeshOutput {
  std::string path;
  bool json = false;
};

/// Adds `--out` and `--json`.
void add_mesh_output_options(CLI::App& command, MeshOutput& output);

/// Opens the file, before the work begins; `prepare` reads what is needed and gives back what makes the mesh, which is
/// timed; then measures the mesh, writes and reports it. Nothing is written where something throws.
void make_mesh(const MeshOutput& output, const std::string& how_to_close,
               const std::function<std::function<Mesh()>()>& prepare);

}  // namespace fathom
