#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/numbers.h"
#include "core/printable.h"
#include "surface/mesh_builder.h"
#include "surface/mesh_text.h"
#include "surface/mesh_vrml.h"
#include "surface/vrml_tokens.h"

namespace fathom {

namespace {

constexpr std::size_t kMostNames = 100'000;     // of vertices, by DEF
constexpr std::size_t kDeepestNesting = 1'000;  // of nodes

/// Where vertices or normals of one node lie among all that were read.
struct Range {
  std::size_t first = 0;
  std::size_t count = 0;
};

class VrmlReader {
 public:
  explicit VrmlReader(MeshSource& source) : source_(source), tokens_(source), builder_(source) {}

  Mesh read() {
    if (source_.first_bytes(kVrmlMagic.size()) != kVrmlMagic) {
      source_.fail("is not VRML 2.0, which begins with \"" + std::string(kVrmlMagic) + "\"; write it in that version");
    }
    std::vector<std::string> nodes;  // that are open, outermost first; "[" for a list
    std::string before;
    std::string before_that;
    while (true) {
      const std::string token = tokens_.next();
      if (token.empty()) break;
      if (token == "Inline") tokens_.fail("takes shapes from another file; export them all into one");
      if (before_that == "DEF") note_name(before, token);
      if (before == "USE" && shape_names_.contains(token)) {
        tokens_.fail("uses a shape a second time; export the mesh without USE");
      }
      if (token == "IndexedFaceSet" && before != "DEF" && before != "USE") {
        tokens_.expect("{");
        read_face_set();
      } else if (token == "{" || token == "[") {
        if (nodes.size() == kDeepestNesting) tokens_.fail("is nested deeper than 1000 brackets; the file is damaged");
        nodes.push_back(token == "[" ? token : before);
      } else if (token == "}" || token == "]") {
        if (nodes.empty() || (nodes.back() == "[") != (token == "]"))
          tokens_.fail("closes what was not opened; the file is damaged");
        nodes.pop_back();
      } else if (!nodes.empty() && nodes.back() == "Transform") {
        require_standing(token);
      }
      before_that = std::exchange(before, token);
    }
    if (!nodes.empty()) source_.fail_cut_short();
    if (!has_face_sets_) source_.fail("holds no IndexedFaceSet, so no mesh; export it as one");
    return finish();
  }

 private:
  // The fields by which a Transform does something; `token` is the name of one, or anything else.
  void require_standing(const std::string& token) {
    const int numbers = token == "translation" || token == "scale" ? 3 : token == "rotation" ? 4 : 0;
    for (int i = 0; i < numbers; ++i) {
      const double value = real(tokens_.next());
      const bool matters = token != "rotation" || i == 3;  // an axis alone does not turn
      if (matters && value != (token == "scale" ? 1.0 : 0.0)) {
        tokens_.fail("moves, turns or scales a shape by a Transform; export the mesh without");
      }
    }
  }

  // Shapes, and what may hold some, by their names.
  void note_name(const std::string& name, const std::string& node) {
    if (node != "Shape" && node != "Transform" && node != "Group" && node != "IndexedFaceSet") return;
    if (shape_names_.size() == kMostNames) source_.fail("has more than 100000 names; export the mesh without DEF");
    shape_names_.insert(name);
  }

  double real(const std::string& token) const {
    const auto value = parse_real(token);
    if (token.empty()) source_.fail_cut_short();
    if (!value) tokens_.fail("has \"" + printable(token) + "\" in place of a finite number; write the mesh anew");
    return *value;
  }

  void read_face_set() {
    has_face_sets_ = true;
    Range vertices;
    std::optional<Range> normals;
    std::vector<std::int32_t> corners;
    std::vector<std::int32_t> normal_corners;
    bool has_corners = false;
    bool counter_clockwise = true;
    bool normals_of_vertices = true;
    while (true) {
      const std::string token = tokens_.next();
      if (token.empty()) source_.fail_cut_short();
      if (token == "}") break;
      if (token == "coord") {
        vertices = read_vectors("Coordinate", "point", vertex_names_);
      } else if (token == "normal") {
        normals = read_vectors("Normal", "vector", normal_names_);
      } else if (token == "coordIndex") {
        if (has_corners) tokens_.fail("has a coordIndex a second time; the file is damaged: copy it again");
        has_corners = true;
        read_indices(corners);
      } else if (token == "normalIndex") {
        read_indices(normal_corners);
      } else if (token == "ccw") {
        counter_clockwise = truth();
      } else if (token == "normalPerVertex") {
        normals_of_vertices = truth();
      } else if (token == "{" || token == "[") {
        pass_over();
      } else if (token == "]") {
        tokens_.fail("closes what was not opened; the file is damaged");
      }
    }
    if (!has_corners) tokens_.fail("ends an IndexedFaceSet without a coordIndex; it is no mesh of faces");
    // Normals go with vertices only where both are used once and in the same order.
    const bool in_step = normals && normals_of_vertices && normals->count == vertices.count &&
                         vertices.first == normals->first &&
                         vertices.first + vertices.count == static_cast<std::size_t>(builder_.vertex_count()) &&
                         (normal_corners.empty() || normal_corners == corners);
    normals_in_step_ = normals_in_step_ && in_step;
    add_faces(corners, vertices, counter_clockwise);
  }

  bool truth() {
    const std::string& token = tokens_.next();
    if (token == "TRUE" || token == "FALSE") return token == "TRUE";
    tokens_.fail("has \"" + printable(token) + "\" in place of TRUE or FALSE; write the mesh anew");
  }

  /// "Coordinate { point [ ... ] }", also behind "DEF name", or "USE name", or NULL.
  Range read_vectors(std::string_view node, std::string_view field, std::map<std::string, Range>& names) {
    std::string token = tokens_.next();
    if (token == "NULL") return {};
    if (token == "USE") {
      const auto found = names.find(tokens_.next());
      if (found == names.end()) tokens_.fail("uses what is not defined before; write the mesh anew");
      return found->second;
    }
    std::string name;
    if (token == "DEF") {
      name = tokens_.next();
      token = tokens_.next();
    }
    if (token.empty()) source_.fail_cut_short();
    if (token != node)
      tokens_.fail("has \"" + printable(token) + "\" in place of a " + std::string(node) + "; write the mesh anew");
    tokens_.expect("{");
    Range range = {count_of(node), 0};
    for (token = tokens_.next(); token != "}"; token = tokens_.next()) {
      if (token.empty()) source_.fail_cut_short();
      if (token != field || range.count > 0) {
        tokens_.fail("has \"" + printable(token) + "\" in a " + std::string(node) + "; write the mesh anew");
      }
      tokens_.expect("[");
      read_list_of_vectors(node);
      range.count = count_of(node) - range.first;
    }
    if (!name.empty()) {
      if (names.size() == kMostNames) source_.fail("has more than 100000 names; export the mesh without DEF");
      names[name] = range;
    }
    return range;
  }

  std::size_t count_of(std::string_view node) const {
    return node == "Normal" ? builder_.mesh().normals.size() : builder_.mesh().vertices.size();
  }

  void read_list_of_vectors(std::string_view node) {
    std::array<double, 3> vector = {};
    std::size_t axis = 0;
    for (const std::string* token = &tokens_.next(); *token != "]"; token = &tokens_.next()) {
      vector[axis] = real(*token);
      if (++axis < 3) continue;
      axis = 0;
      if (node == "Normal") {
        builder_.add_normal(vector);
      } else {
        builder_.add_vertex(vector);
      }
    }
    if (axis != 0) tokens_.fail("ends a list whose length is not a multiple of three; the file is damaged");
  }

  void read_indices(std::vector<std::int32_t>& indices) {
    const std::string& first = tokens_.next();
    if (first != "[") {  // a list of one needs no brackets
      indices.push_back(index(first));
      return;
    }
    for (const std::string* token = &tokens_.next(); *token != "]"; token = &tokens_.next()) {
      indices.push_back(index(*token));
    }
  }

  std::int32_t index(const std::string& token) const {
    const auto number = parse_integer(token);
    if (token.empty()) source_.fail_cut_short();
    if (!number || *number < -1 || *number >= 2147483647) {
      tokens_.fail("has \"" + printable(token) + "\" as an index; it must be a whole number from -1 to 2147483646");
    }
    return static_cast<std::int32_t>(*number);
  }

  void pass_over() {
    for (std::size_t depth = 1; depth > 0;) {
      const std::string& token = tokens_.next();
      if (token.empty()) source_.fail_cut_short();
      if (token == "{" || token == "[") ++depth;
      if (token == "}" || token == "]") --depth;
    }
  }

  void add_faces(const std::vector<std::int32_t>& corners, const Range& vertices, bool counter_clockwise) {
    std::vector<std::int64_t> face;
    const auto add = [&] {
      if (!counter_clockwise) std::reverse(face.begin(), face.end());
      builder_.add_polygon(face);
      face.clear();
    };
    for (const std::int32_t corner : corners) {
      if (corner == -1) {
        add();
        continue;
      }
      if (static_cast<std::size_t>(corner) >= vertices.count) {
        tokens_.fail("ends a face set in which a face names vertex " + std::to_string(corner) +
                     ", but there are only " + std::to_string(vertices.count) + "; the file is damaged: copy it again");
      }
      face.push_back(static_cast<std::int64_t>(vertices.first) + corner);
    }
    add();  // the last -1 may be left out
  }

  Mesh finish() {
    if (!normals_in_step_) builder_.drop_normals();
    return builder_.finish();
  }

  MeshSource& source_;
  VrmlTokens tokens_;
  MeshBuilder builder_;
  std::map<std::string, Range> vertex_names_;
  std::map<std::string, Range> normal_names_;
  std::set<std::string> shape_names_;
  bool has_face_sets_ = false;
  bool normals_in_step_ = true;
};

}  // namespace

Mesh read_vrml(MeshSource& source) { return VrmlReader(source).read(); }

}  // namespace fathom
