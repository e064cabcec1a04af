#include "exam/structure_files.h"

#include <cstdint>
#include <set>
#include <string>

#include "core/error.h"
#include "surface/mesh_file.h"

namespace fathom {

std::vector<std::filesystem::path> structure_files(const std::filesystem::path& out,
                                                   const std::vector<Structure>& structures) {
  if (structures.size() == 1) return {out};
  std::vector<std::filesystem::path> files;
  std::set<std::string> used;
  for (const Structure& structure : structures) {
    std::string name = structure.name;
    for (char& c : name) {
      if (c == '/' || c == '\\') c = '_';
    }
    if (!used.insert(name).second) {
      throw Error("two structures would both be written to the file of '" + name +
                  "'; rename one, or choose one by --structure");
    }
    std::filesystem::path file = out;
    file.replace_filename(out.stem().string() + "." + name + out.extension().string());
    files.push_back(file);
  }
  return files;
}

void write_structure_mesh(const Mesh& mesh, const Structure& structure, AtomicFile& file, const Progress& progress) {
  MeshWriteOptions options;
  const unsigned long rgb = std::stoul(structure.color.substr(1), nullptr, 16);
  options.color = {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8 & 0xff),
                   static_cast<std::uint8_t>(rgb & 0xff)};
  write_mesh(mesh, file, options, progress);
}

}  // namespace fathom
