#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/mesh_output.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/numbers.h"
#include "surface/equation.h"
#include "surface/isosurface.h"

namespace fathom {

namespace {

struct EqnsurfCommand {
  std::string equation;
  std::string bounds;
  IsosurfaceOptions surface;
  MeshOutput output;
};

// Six numbers between commas, three rising pairs; empty where the text is anything else.
std::optional<Eigen::AlignedBox3d> parse_bounds(std::string text) {
  if (std::count(text.begin(), text.end(), ',') != 5) return std::nullopt;
  std::replace(text.begin(), text.end(), ',', ' ');
  const auto numbers = parse_reals(text);
  if (!numbers || numbers->size() != 6) return std::nullopt;
  const std::vector<double>& n = *numbers;
  if (n[0] >= n[1] || n[2] >= n[3] || n[4] >= n[5]) return std::nullopt;
  return Eigen::AlignedBox3d(Eigen::Vector3d(n[0], n[2], n[4]), Eigen::Vector3d(n[1], n[3], n[5]));
}

CLI::Validator six_bounds() {
  return CLI::Validator(
      [](std::string& text) {
        return parse_bounds(text) ? std::string()
                                  : std::string("must be six numbers x0,x1,y0,y1,z0,z1 with x0 < x1, y0 < y1, z0 < z1");
      },
      "");
}

void run(const EqnsurfCommand& command) {
  make_mesh(command.output, "--cap closes it along the bounds, or choose wider ones", [&command] {
    const auto equation = std::make_shared<const Equation>(command.equation);
    return [&command, equation] {
      const RowField field = [&equation](const Eigen::Vector3d& start_mm, const Eigen::Vector3d& step_mm,
                                         std::span<double> values) { equation->values(start_mm, step_mm, values); };
      return isosurface(field, parse_bounds(command.bounds).value(), command.surface, progress_bar("meshing"));
    };
  });
}

}  // namespace

void add_eqnsurf(CLI::App& app) {
  auto options = std::make_shared<EqnsurfCommand>();
  options->surface.inside_below = true;
  IsosurfaceOptions& surface = options->surface;
  CLI::App* command = app.add_subcommand("eqnsurf", "Make a surface mesh from an equation of x, y and z");
  command
      ->add_option("EQUATION", options->equation,
                   "One side of the equation, the other being 0: \"x^2+y^2+z^2-1\". Inside is below 0")
      ->required();
  command->add_option("--bounds", options->bounds, "The box to look at, in mm: x0,x1,y0,y1,z0,z1")
      ->required()
      ->check(six_bounds());
  command->add_option("--spacing", surface.spacing_mm, "Distance of the lattice's layers, in mm")
      ->required()
      ->check(above(0));
  command->add_option("--threshold", surface.value, "Inside is below this value instead of 0")->check(finite());
  command->add_flag("--cap", surface.cap, "Close the surface along the bounds");
  add_mesher_options(*command, surface.mesher);
  add_mesh_output_options(*command, options->output);
  command->footer(
      "Equations are made of x, y, z, numbers, pi, e, + - * / ^ ( ),\ncomparisons (< <= > >= == != && ||), a ? b : c, "
      "and\n" +
      equation_functions() +
      ".\nAngles are radians, log is natural. An equation that begins with a minus sign goes last, behind --.");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
