#include "sim/studies/formula_surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom {

namespace {

constexpr double kPeaksScale = 1.6;
constexpr double kClosedScale = 25.0;
constexpr double kTorusMiddle_mm = 0.65;
constexpr double kTorusTube_mm = 0.35;

double sphere(const Eigen::Vector3d& p) { return 1.0 - p.norm(); }

double torus(const Eigen::Vector3d& p) {
  return kTorusTube_mm - std::hypot(std::hypot(p.x(), p.y()) - kTorusMiddle_mm, p.z());
}

double bumpy_sphere(const Eigen::Vector3d& p) {
  const double r = p.norm() + 1e-9;
  return 0.8 + 0.08 * std::sin(5.0 * p.x() / r) * std::sin(4.0 * p.y() / r + 1.0) * std::sin(5.0 * p.z() / r + 2.0) - r;
}

// Equation (3.17), its first factor as in the function of that name.
double peaks(const Eigen::Vector3d& p) {
  const double x = p.x(), y = p.y(), z = kPeaksScale * p.z();
  return 3.0 * (1.0 - x) * (1.0 - x) * std::exp(-x * x - (y + 1.0) * (y + 1.0)) -
         10.0 * (x / 5.0 - x * x * x - std::pow(y, 5)) * std::exp(-x * x - y * y) -
         std::exp(-(x + 1.0) * (x + 1.0) - y * y) / 3.0 - z;
}

// Equation (3.18).
double closed(const Eigen::Vector3d& p) {
  const double x = p.x(), y = p.y(), z = kClosedScale * p.z();
  const auto hole = [y](double along) { return along * along + y * y - 1.44; };
  const double rim = 1.0 - x * x / 36.0 - y * y / 12.25;
  const double value = rim * hole(x - 3.9) * hole(x) * hole(x + 3.9) - z * z;
  return rim < 0.0 ? std::min(value, rim) : value;
}

}  // namespace

const std::vector<FormulaSurface>& formula_surfaces() {
  static const std::vector<FormulaSurface> surfaces = {
      {"sphere",
       sphere,
       {1.0, 1.0, 1.0},
       4.0 / 3.0 * std::numbers::pi,
       PublishedMeshes{2320, 4956, 1316, 99.63, 99.77},
       false},
      {"peaks", peaks, {3.0, 3.0, 5.4}, {}, PublishedMeshes{6130, 16498, 4238, {}, 99.81}, true},
      {"closed", closed, {6.3, 3.8, 1.85}, {}, PublishedMeshes{8196, 18744, 5008, 99.38, 99.06}, false},
      {"torus",
       torus,
       {1.0, 1.0, 0.4},
       2.0 * std::numbers::pi * std::numbers::pi * kTorusMiddle_mm * kTorusTube_mm * kTorusTube_mm,
       {},
       false},
      {"bumpy", bumpy_sphere, {0.9, 0.9, 0.9}, {}, {}, false}};
  return surfaces;
}

Mesh formula_mesh(const FormulaSurface& surface, const MesherOptions& mesher, double spacing_mm,
                  const Eigen::Vector3d& aside) {
  IsosurfaceOptions options;
  options.spacing_mm = spacing_mm;
  options.mesher = mesher;
  // A box of whole steps, so that the lattice is not squeezed to end on its borders.
  Eigen::Vector3d steps = Eigen::Vector3d::Constant(spacing_mm);
  if (mesher.lattice() == Lattice::kBodyCentred) steps.x() *= std::numbers::sqrt2;
  const double room_mm = surface.open ? 0.0 : 2.5 * spacing_mm;
  Eigen::Vector3d half = surface.reach_mm + Eigen::Vector3d::Constant(room_mm);
  half = 0.5 * steps.cwiseProduct((2.0 * half.cwiseQuotient(steps)).array().ceil().matrix());
  const Eigen::Vector3d middle = spacing_mm * aside;
  return isosurface(surface.field, Eigen::AlignedBox3d(middle - half, middle + half), options);
}

double published_spacing_mm(const FormulaSurface& surface) {
  MesherOptions cubes;
  cubes.mesher = Mesher::kCubes;
  double spacing_mm = surface.reach_mm.maxCoeff() / 20.0;
  for (int round = 0; round < 8; ++round) {
    const auto count = static_cast<double>(formula_mesh(surface, cubes, spacing_mm).triangles.size());
    const double share = count / surface.published->cubes;
    if (std::abs(share - 1.0) < 0.02) break;
    spacing_mm *= std::sqrt(share);
  }
  return spacing_mm;
}

}  // namespace fathom
