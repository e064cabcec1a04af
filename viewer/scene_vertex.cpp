#include "viewer/scene_vertex.h"

#include <Eigen/Geometry>

namespace fathom {

std::vector<SceneVertex> scene_vertices(const Mesh& mesh) {
  std::vector<Eigen::Vector3d> normals = mesh.normals;
  if (normals.size() != mesh.vertices.size()) {
    normals.assign(mesh.vertices.size(), Eigen::Vector3d::Zero());
    for (const Mesh::Triangle& triangle : mesh.triangles) {
      const auto corner = [&](int k) {
        return mesh.vertices[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
      };
      const Eigen::Vector3d face = (corner(1) - corner(0)).cross(corner(2) - corner(0));
      for (const std::int32_t vertex : triangle) normals[static_cast<std::size_t>(vertex)] += face;
    }
  }
  std::vector<SceneVertex> vertices;
  vertices.reserve(3 * mesh.triangles.size());
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    for (const std::int32_t index : triangle) {
      const auto i = static_cast<std::size_t>(index);
      SceneVertex vertex;
      vertex.position = mesh.vertices[i].cast<float>();
      vertex.normal = normals[i].normalized().cast<float>();
      vertices.push_back(vertex);
    }
  }
  return vertices;
}

}  // namespace fathom
