#include "surface/ply_header.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "core/printable.h"

namespace fathom::ply {

namespace {

constexpr std::array<std::pair<std::string_view, Type>, 16> kTypes = {{{"char", Type::int8},
                                                                       {"int8", Type::int8},
                                                                       {"uchar", Type::uint8},
                                                                       {"uint8", Type::uint8},
                                                                       {"short", Type::int16},
                                                                       {"int16", Type::int16},
                                                                       {"ushort", Type::uint16},
                                                                       {"uint16", Type::uint16},
                                                                       {"int", Type::int32},
                                                                       {"int32", Type::int32},
                                                                       {"uint", Type::uint32},
                                                                       {"uint32", Type::uint32},
                                                                       {"float", Type::float32},
                                                                       {"float32", Type::float32},
                                                                       {"double", Type::float64},
                                                                       {"float64", Type::float64}}};

constexpr std::size_t kMostProperties = 1000;  // of all elements: more than any file has, and little memory

Use use_of(std::string_view element, std::string_view name, bool is_list) {
  constexpr std::array<std::pair<std::string_view, Use>, 6> kOfVertex = {
      {{"x", Use::x}, {"y", Use::y}, {"z", Use::z}, {"nx", Use::nx}, {"ny", Use::ny}, {"nz", Use::nz}}};
  if (element == "vertex" && !is_list) {
    for (const auto& [known, use] : kOfVertex) {
      if (name == known) return use;
    }
  }
  if (element == "face" && is_list && (name == "vertex_indices" || name == "vertex_index")) return Use::corners;
  if (element == "face" && !is_list && name == "sweep_sign") return Use::sweep_sign;
  return Use::none;
}

class HeaderReader {
 public:
  explicit HeaderReader(MeshSource& source) : source_(source) {}

  Header read() {
    const std::string_view magic = source_.first_bytes(4);
    if (magic != "ply\n" && magic != "ply\r") {
      source_.fail("is not a PLY file, although its name says so; name it by its format");
    }
    source_.next_line();
    bool has_format = false;
    while (true) {
      auto line = source_.next_line();
      if (!line) source_.fail("its header has no end_header; it was cut short: copy it again");
      const std::string_view word = take_word(*line);
      if (word == "end_header") break;
      if (word == "format") {
        read_format(*line);
        has_format = true;
      } else if (word == "element") {
        read_element(*line);
      } else if (word == "property") {
        read_property(*line);
      } else if (!word.empty() && word != "comment" && word != "obj_info") {
        source_.fail_in_line("begins with \"" + printable(word) + "\", which no PLY header has; write the mesh anew");
      }
    }
    if (!has_format) source_.fail("its header does not say its format; the file is damaged: copy it again");
    check();
    return header_;
  }

 private:
  void read_format(std::string_view line) {
    const std::string_view format = take_word(line);
    if (format == "ascii") {
      header_.encoding = Encoding::text;
    } else if (format == "binary_little_endian") {
      header_.encoding = Encoding::little_endian;
    } else if (format == "binary_big_endian") {
      header_.encoding = Encoding::big_endian;
    } else {
      source_.fail_in_line("has the format \"" + printable(format) +
                           "\"; only ascii, binary_little_endian and binary_big_endian can be read");
    }
    if (const std::string_view version = take_word(line); version != "1.0") {
      source_.fail_in_line("has version \"" + printable(version) + "\" of PLY; only 1.0 can be read");
    }
  }

  void read_element(std::string_view line) {
    Element element;
    element.name = take_word(line);
    for (const Element& other : header_.elements) {
      if (other.name == element.name) {
        source_.fail_in_line("has an element a second time; the file is damaged: copy it again");
      }
    }
    element.count = static_cast<std::uint64_t>(take_count(line, printable(element.name), source_));
    charge();
    header_.elements.push_back(std::move(element));
  }

  void read_property(std::string_view line) {
    if (header_.elements.empty()) {
      source_.fail_in_line("has a property of no element; the file is damaged: copy it again");
    }
    Property property;
    std::string_view word = take_word(line);
    const bool is_list = word == "list";
    if (is_list) {
      property.count_type = type(take_word(line));
      if (!is_whole(*property.count_type)) {
        source_.fail_in_line("has a list whose length is no whole number; write the mesh anew");
      }
      word = take_word(line);
    }
    property.type = type(word);
    Element& element = header_.elements.back();
    property.use = use_of(element.name, take_word(line), is_list);
    if (property.use != Use::none && uses(element, property.use)) {
      source_.fail_in_line("has a property a second time; the file is damaged: copy it again");
    }
    if ((property.use == Use::corners || property.use == Use::sweep_sign) && !is_whole(property.type)) {
      source_.fail_in_line("has faces that are not whole numbers; write the mesh anew");
    }
    charge();
    element.properties.push_back(property);
  }

  Type type(std::string_view word) const {
    for (const auto& [name, type] : kTypes) {
      if (word == name) return type;
    }
    source_.fail_in_line("has the type \"" + printable(word) + "\", which PLY does not have; write the mesh anew");
  }

  void charge() {
    if (++charged_ > kMostProperties) source_.fail("has more than 1000 properties; leave out what is no mesh");
  }

  void check() const {
    bool has_vertices = false;
    bool has_faces = false;
    for (const Element& element : header_.elements) {
      has_vertices = has_vertices || (element.name == "vertex" && uses(element, Use::x) && uses(element, Use::y) &&
                                      uses(element, Use::z));
      has_faces = has_faces || (element.name == "face" && uses(element, Use::corners));
    }
    if (!has_vertices) source_.fail("has no vertices with x, y and z; write the mesh anew");
    if (!has_faces)
      source_.fail("has no faces with vertex_indices, so it is no mesh of triangles; write the mesh anew");
  }

  MeshSource& source_;
  Header header_;
  std::size_t charged_ = 0;
};

}  // namespace

std::size_t bytes_of(Type type) {
  constexpr std::array<std::size_t, 8> kBytes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

bool is_whole(Type type) { return type != Type::float32 && type != Type::float64; }

bool uses(const Element& element, Use use) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const Property& property) { return property.use == use; });
}

Header read_header(MeshSource& source) { return HeaderReader(source).read(); }

}  // namespace fathom::ply
