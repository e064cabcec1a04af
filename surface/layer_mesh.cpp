#include "surface/layer_mesh.h"

#include <algorithm>
#include <limits>

#include "core/error.h"

namespace fathom {

void append(const LayerMesh& layer, Mesh& mesh) {
  const std::size_t first = mesh.vertices.size();
  // The triangles name vertices of the next layer, too, but those are added, or refused, before the mesh is used.
  if (first + layer.vertices.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw Error("the surface has more than 2147483647 vertices; choose a larger spacing");
  }
  mesh.vertices.insert(mesh.vertices.end(), layer.vertices.begin(), layer.vertices.end());
  mesh.normals.insert(mesh.normals.end(), layer.normals.begin(), layer.normals.end());
  const auto shift = static_cast<std::uint32_t>(first);
  const auto shifted = [shift](std::int32_t vertex) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(vertex) + shift);
  };
  const std::size_t triangles = mesh.triangles.size();
  mesh.triangles.resize(triangles + layer.triangles.size());
  std::transform(layer.triangles.begin(), layer.triangles.end(),
                 mesh.triangles.begin() + static_cast<std::ptrdiff_t>(triangles), [shifted](const Mesh::Triangle& t) {
                   return Mesh::Triangle{shifted(t[0]), shifted(t[1]), shifted(t[2])};
                 });
}

Mesh join(std::span<const LayerMesh* const> layers) {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (const LayerMesh* layer : layers) {
    vertices += layer->vertices.size();
    triangles += layer->triangles.size();
  }
  Mesh mesh;
  mesh.vertices.reserve(vertices);
  mesh.normals.reserve(vertices);
  mesh.triangles.reserve(triangles);
  for (const LayerMesh* layer : layers) append(*layer, mesh);
  return mesh;
}

Mesh join(std::span<const LayerMesh> layers) {
  std::vector<const LayerMesh*> pointers;
  for (const LayerMesh& layer : layers) pointers.push_back(&layer);
  return join(pointers);
}

}  // namespace fathom
