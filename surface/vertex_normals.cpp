#include "surface/vertex_normals.h"

#include <Eigen/Geometry>

namespace fathom {

std::vector<Eigen::Vector3d> vertex_normals(const Mesh& mesh) {
  std::vector<Eigen::Vector3d> normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
  const auto at = [](std::int32_t vertex) { return static_cast<std::size_t>(vertex); };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d twice_area =
        (mesh.vertices[at(b)] - mesh.vertices[at(a)]).cross(mesh.vertices[at(c)] - mesh.vertices[at(a)]);
    for (const std::int32_t vertex : {a, b, c}) normals[at(vertex)] += twice_area;
  }
  for (Eigen::Vector3d& normal : normals) normal.normalize();  // leaves zero as it is
  return normals;
}

}  // namespace fathom
