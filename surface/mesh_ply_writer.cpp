#include <algorithm>
#include <array>
#include <bit>
#include <string>

#include "surface/mesh_ply.h"

namespace fathom {

namespace {

constexpr std::size_t kFacesBetweenReports = 1 << 16;

template <typename T>
void append(std::string& bytes, T value) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

}  // namespace

void write_ply(const Mesh& mesh, AtomicFile& file, const Progress& progress) {
  const bool has_normals = !mesh.normals.empty();
  const bool has_signs = !mesh.sweep_signs.empty();
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment millimetres\nelement vertex ";
  text += std::to_string(mesh.vertices.size()) + "\nproperty double x\nproperty double y\nproperty double z\n";
  if (has_normals) text += "property double nx\nproperty double ny\nproperty double nz\n";
  text += "element face " + std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\n";
  if (has_signs) text += "property char sweep_sign\n";
  file.write(text + "end_header\n");

  const std::size_t all = mesh.vertices.size() + mesh.triangles.size();
  std::string entry;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (v % kFacesBetweenReports == 0) report(progress, static_cast<double>(v) / static_cast<double>(all));
    entry.clear();
    for (const double x : mesh.vertices[v]) append(entry, x);
    if (has_normals) {
      for (const double x : mesh.normals[v]) append(entry, x);
    }
    file.write(entry);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kFacesBetweenReports == 0) {
      report(progress, static_cast<double>(mesh.vertices.size() + t) / static_cast<double>(all));
    }
    entry.assign(1, char{3});
    for (const std::int32_t vertex : mesh.triangles[t]) append(entry, vertex);
    if (has_signs) append(entry, mesh.sweep_signs[t]);
    file.write(entry);
  }
  report(progress, 1.0);
}

}  // namespace fathom
