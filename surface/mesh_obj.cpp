#include "surface/mesh_obj.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/printable.h"
#include "surface/mesh_builder.h"
#include "surface/mesh_text.h"

namespace fathom {

namespace {

class ObjReader {
 public:
  explicit ObjReader(MeshSource& source) : source_(source), builder_(source) {}

  Mesh read() {
    while (auto line = source_.next_line_of_data()) {
      if (line->ends_with('\\')) source_.fail_in_line("goes on in the next one; write every face in one line");
      const std::string_view word = take_word(*line);
      if (word == "v") {
        builder_.add_vertex(take_vector(*line, source_));
      } else if (word == "vn") {
        add_normal(*line);
      } else if (word == "f") {
        add_face(*line);
      } else if (!is_known(word)) {
        source_.fail_in_line("begins with \"" + printable(word) + "\", which no OBJ file has; the file is damaged");
      }
    }
    source_.require_promised_end();
    if (builder_.vertex_count() == 0 && !has_faces_) {
      // An empty mesh that Fathom wrote says that it is whole; any other text is none.
      if (!source_.end_was_promised()) source_.fail("has no vertices; it is no mesh, or was cut short: copy it again");
    }
    return with_normals();
  }

 private:
  static bool is_known(std::string_view word) {
    constexpr std::array<std::string_view, 16> kPassedOver = {
        "vt", "vp", "g",   "o",  "s",     "usemtl",   "mtllib",   "usemap",
        "l",  "p",  "lod", "mg", "bevel", "c_interp", "d_interp", "maplib"};
    for (const std::string_view known : kPassedOver) {
      if (word == known) return true;
    }
    return false;
  }

  void add_normal(std::string_view line) {
    const auto [x, y, z] = take_vector(line, source_);
    normals_.emplace_back(x, y, z);
  }

  void add_face(std::string_view line) {
    has_faces_ = true;
    corners_.clear();
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      const std::size_t first = word.find('/');
      const std::int64_t vertex = index(word.substr(0, first), builder_.vertex_count());
      corners_.push_back(vertex);
      const std::size_t second = first == std::string_view::npos ? first : word.find('/', first + 1);
      if (second == std::string_view::npos) continue;
      note_normal(vertex, index(word.substr(second + 1), static_cast<std::int64_t>(normals_.size())));
    }
    if (corners_.size() < 3) source_.fail_in_line("has a face of fewer than three vertices; the file is damaged");
    builder_.add_polygon(corners_);
  }

  std::int64_t index(std::string_view word, std::int64_t count) const {
    const auto number = parse_integer(word);
    const std::int64_t result = !number ? -1 : *number < 0 ? count + *number : *number - 1;
    constexpr std::int64_t kMost = 2147483647;
    if (result < 0 || result >= kMost) {
      source_.fail_in_line("has \"" + printable(word) +
                           "\" as an index of a face; it must count from 1, or from -1 back");
    }
    return result;
  }

  // The index of its normal, for each vertex that a face has named so far.
  void note_normal(std::int64_t vertex, std::int64_t normal) {
    if (vertex >= builder_.vertex_count() || normal >= static_cast<std::int64_t>(normals_.size())) {
      source_.fail_in_line("names a vertex or a normal that has not come yet; the file is damaged: copy it again");
    }
    normal_of_.resize(static_cast<std::size_t>(builder_.vertex_count()), kNone);
    std::int32_t& known = normal_of_[static_cast<std::size_t>(vertex)];
    if (known == kNone) known = static_cast<std::int32_t>(normal);
    const auto at = [&](std::int64_t i) { return normals_[static_cast<std::size_t>(i)]; };
    if (known != normal && at(known) != at(normal)) is_creased_ = true;
  }

  Mesh with_normals() {
    normal_of_.resize(static_cast<std::size_t>(builder_.vertex_count()), kNone);
    // Of vertices that no face names, where there is one normal for each.
    const bool in_step = normals_.size() == normal_of_.size();
    for (std::size_t v = 0; v < normal_of_.size() && !is_creased_; ++v) {
      if (normal_of_[v] == kNone && !in_step) break;
      const auto& normal = normals_[normal_of_[v] == kNone ? v : static_cast<std::size_t>(normal_of_[v])];
      builder_.add_normal({normal.x(), normal.y(), normal.z()});
    }
    return builder_.finish();
  }

  static constexpr std::int32_t kNone = -1;

  MeshSource& source_;
  MeshBuilder builder_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<std::int32_t> normal_of_;
  std::vector<std::int64_t> corners_;
  bool is_creased_ = false;  ///< a vertex has different normals in different faces
  bool has_faces_ = false;
};

}  // namespace

Mesh read_obj(MeshSource& source) { return ObjReader(source).read(); }

void write_obj(const Mesh& mesh, AtomicFile& file, const Progress& progress) {
  TextPieces text(file, mesh, progress);
  text.add(kEndPromise);
  text.add("\n");
  for (const Eigen::Vector3d& vertex : mesh.vertices) text.add_line("v ", vertex);
  for (const Eigen::Vector3d& normal : mesh.normals) text.add_line("vn ", normal);
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    text.add("f");
    for (const std::int32_t vertex : triangle) {
      const std::string number = std::to_string(static_cast<std::int64_t>(vertex) + 1);
      text.add(" ");
      text.add(number);
      if (mesh.normals.empty()) continue;
      text.add("//");
      text.add(number);
    }
    text.end_line();
  }
  text.add(kEnd);
  text.add("\n");
  text.finish();
}

}  // namespace fathom
