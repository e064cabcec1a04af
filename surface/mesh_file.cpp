#include "surface/mesh_file.h"

#include <algorithm>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/printable.h"
#include "surface/mesh_check.h"
#include "surface/mesh_obj.h"
#include "surface/mesh_off.h"
#include "surface/mesh_ply.h"
#include "surface/mesh_source.h"
#include "surface/mesh_stl.h"
#include "surface/mesh_vrml.h"

namespace fathom {

namespace {

enum class Format { ply, stl, obj, off, vrml };

std::optional<Format> format_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (extension == ".ply") return Format::ply;
  if (extension == ".stl") return Format::stl;
  if (extension == ".obj") return Format::obj;
  if (extension == ".off") return Format::off;
  if (extension == ".wrl") return Format::vrml;
  return std::nullopt;
}

std::string shown(const std::filesystem::path& path) {
  constexpr std::size_t kLongestName = 300;  // characters of a path in a message
  return printable(path.string(), kLongestName);
}

Format require_format(const std::filesystem::path& path) {
  const auto format = format_of(path);
  if (!format) {
    throw Error(shown(path) + ": \"" + printable(path.extension().string()) +
                "\" is not the ending of a mesh file; name one ending in .ply, .stl, .obj, .off or .wrl");
  }
  return *format;
}

void write(const Mesh& mesh, AtomicFile& file, Format format, const MeshWriteOptions& options,
           const Progress& progress) {
  require_valid(mesh, shown(file.target()));
  switch (format) {
    case Format::ply:
      return write_ply(mesh, file, progress);
    case Format::stl:
      return write_stl(mesh, file, progress);
    case Format::obj:
      return write_obj(mesh, file, progress);
    case Format::off:
      return write_off(mesh, file, progress);
    case Format::vrml:
      return write_vrml(mesh, file, options.color, progress);
  }
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& path) { return format_of(path).has_value(); }

bool keeps_sweep_signs(const std::filesystem::path& path) { return format_of(path) == Format::ply; }

Mesh read_mesh(const std::filesystem::path& path) {
  const Format format = require_format(path);
  MeshSource source(path);
  switch (format) {
    case Format::ply:
      return read_ply(source);
    case Format::stl:
      return read_stl(source);
    case Format::obj:
      return read_obj(source);
    case Format::off:
      return read_off(source);
    case Format::vrml:
      break;
  }
  return read_vrml(source);
}

void write_mesh(const Mesh& mesh, const std::filesystem::path& path, const MeshWriteOptions& options,
                const Progress& progress) {
  // The name that was given decides, not that of a file behind a link.
  const Format format = require_format(path);
  AtomicFile file(path);
  write(mesh, file, format, options, progress);
  file.commit();
}

void write_mesh(const Mesh& mesh, AtomicFile& file, const MeshWriteOptions& options, const Progress& progress) {
  write(mesh, file, require_format(file.target()), options, progress);
}

}  // namespace fathom
