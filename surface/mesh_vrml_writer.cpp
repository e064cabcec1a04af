#include "surface/mesh_text.h"
#include "surface/mesh_vrml.h"

namespace fathom {

void write_vrml(const Mesh& mesh, AtomicFile& file, const std::array<std::uint8_t, 3>& color,
                const Progress& progress) {
  constexpr double kFull = 255.0;
  TextPieces text(file, mesh, progress);
  text.add(kVrmlMagic);
  text.add("\n# millimetres\nShape {\n appearance Appearance { material Material { diffuseColor ");
  text.add(Eigen::Vector3d(color[0] / kFull, color[1] / kFull, color[2] / kFull));
  // Not solid: an open mesh is to be seen from both sides.
  text.add(" } }\n geometry IndexedFaceSet {\n  solid FALSE\n  coord Coordinate { point [\n");
  for (const Eigen::Vector3d& vertex : mesh.vertices) text.add_line("", vertex, ",\n");
  text.add("  ] }\n");
  if (!mesh.normals.empty()) {
    text.add("  normal Normal { vector [\n");
    for (const Eigen::Vector3d& normal : mesh.normals) text.add_line("", normal, ",\n");
    text.add("  ] }\n");
  }
  text.add("  coordIndex [\n");
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    for (const std::int32_t vertex : triangle) {
      text.add(static_cast<std::int64_t>(vertex));
      text.add(",");
    }
    text.end_line("-1,\n");
  }
  text.add("  ]\n }\n}\n");
  text.finish();
}

}  // namespace fathom
