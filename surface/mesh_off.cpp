#include "surface/mesh_off.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/printable.h"
#include "surface/mesh_builder.h"
#include "surface/mesh_text.h"

namespace fathom {

namespace {

constexpr std::uint64_t kLeastVertexBytes = 6;  // "0 0 0" and a line end
constexpr std::uint64_t kLeastFaceBytes = 2;    // "0" and a line end

/// The next line that holds something; there must be one.
std::string_view next_line(MeshSource& source) {
  const auto line = source.next_line_of_data();
  if (!line) source.fail_cut_short();
  return *line;
}

void read_face(std::string_view line, MeshSource& source, MeshBuilder& builder, std::vector<std::int64_t>& corners) {
  const std::int32_t count = take_count(line, "corners", source);
  corners.clear();
  for (std::int32_t i = 0; i < count; ++i) {
    const std::string_view word = take_word(line);
    const auto index = parse_integer(word);
    if (!index || *index < 0 || *index >= builder.vertex_count()) {
      source.fail_in_line("has \"" + printable(word) +
                          "\" as a corner of a face; it must be a whole number from 0 to " +
                          std::to_string(builder.vertex_count() - 1) + ": copy the file again");
    }
    corners.push_back(*index);
  }
  builder.add_polygon(corners);  // a colour may follow
}

}  // namespace

Mesh read_off(MeshSource& source) {
  std::string_view line = next_line(source);
  const std::string format(take_word(line));
  const bool has_normals = format == "NOFF" || format == "CNOFF";
  if (!has_normals && format != "OFF" && format != "COFF") {
    source.fail("begins with \"" + printable(format) + "\"; only OFF, NOFF, COFF and CNOFF can be read");
  }
  std::string_view rest = line;
  if (const std::string_view word = take_word(rest); word == "BINARY") {
    source.fail("is a binary OFF file; only text can be read: write it as text, or as .ply");
  } else if (word.empty()) {
    line = next_line(source);
  }
  const std::int32_t vertices = take_count(line, "vertices", source);
  const std::int32_t faces = take_count(line, "faces", source);
  MeshBuilder builder(source);
  builder.require_room(static_cast<std::uint64_t>(vertices), kLeastVertexBytes, "vertices");
  for (std::int32_t v = 0; v < vertices; ++v) {
    line = next_line(source);
    builder.add_vertex(take_vector(line, source));
    if (has_normals) builder.add_normal(take_vector(line, source));
  }
  builder.require_room(static_cast<std::uint64_t>(faces), kLeastFaceBytes, "faces");
  std::vector<std::int64_t> corners;
  for (std::int32_t f = 0; f < faces; ++f) read_face(next_line(source), source, builder, corners);
  if (source.next_line_of_data()) {
    source.fail_in_line("comes behind the last face; the file is damaged: copy it again");
  }
  source.require_promised_end();
  return builder.finish();
}

void write_off(const Mesh& mesh, AtomicFile& file, const Progress& progress) {
  TextPieces text(file, mesh, progress);
  text.add(mesh.normals.empty() ? "OFF\n" : "NOFF\n");
  text.add(kEndPromise);
  text.add("\n");
  text.add(static_cast<std::int64_t>(mesh.vertices.size()));
  text.add(" ");
  text.add(static_cast<std::int64_t>(mesh.triangles.size()));
  text.add(" 0\n");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    text.add(mesh.vertices[v]);
    if (!mesh.normals.empty()) {
      text.add(" ");
      text.add(mesh.normals[v]);
    }
    text.end_line();
  }
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    text.add("3");
    for (const std::int32_t vertex : triangle) {
      text.add(" ");
      text.add(static_cast<std::int64_t>(vertex));
    }
    text.end_line();
  }
  text.add(kEnd);
  text.add("\n");
  text.finish();
}

}  // namespace fathom
