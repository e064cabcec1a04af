#include "surface/layer_mesh.h"

#include <limits>

#include "core/error.h"

namespace fathom {

Mesh join(std::span<const LayerMesh* const> layers) {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (const LayerMesh* layer : layers) {
    vertices += layer->vertices.size();
    triangles += layer->triangles.size();
  }
  if (vertices > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw Error("the surface has more than 2147483647 vertices; choose a larger spacing");
  }
  Mesh mesh;
  mesh.vertices.reserve(vertices);
  mesh.normals.reserve(vertices);
  mesh.triangles.reserve(triangles);
  for (const LayerMesh* layer : layers) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), layer->vertices.begin(), layer->vertices.end());
    mesh.normals.insert(mesh.normals.end(), layer->normals.begin(), layer->normals.end());
    for (const Mesh::Triangle& triangle : layer->triangles) {
      mesh.triangles.push_back({first + triangle[0], first + triangle[1], first + triangle[2]});
    }
  }
  return mesh;
}

Mesh join(std::span<const LayerMesh> layers) {
  std::vector<const LayerMesh*> pointers;
  for (const LayerMesh& layer : layers) pointers.push_back(&layer);
  return join(pointers);
}

}  // namespace fathom
