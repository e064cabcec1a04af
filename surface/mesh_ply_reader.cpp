#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/numbers.h"
#include "core/printable.h"
#include "surface/mesh_builder.h"
#include "surface/mesh_ply.h"

namespace fathom {

namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

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
constexpr double kMostInList = 1'000'000;      // corners of a polygon, as a rule

std::size_t bytes_of(Type type) {
  constexpr std::array<std::size_t, 8> kBytes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

bool is_whole(Type type) { return type != Type::float32 && type != Type::float64; }

/// What the reader does with a property.
enum class Use { none, x, y, z, nx, ny, nz, corners, sweep_sign };

struct Property {
  Type type = Type::float64;
  std::optional<Type> count_type;  ///< of a list
  Use use = Use::none;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { text, little_endian, big_endian };

struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
};

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

bool uses(const Element& element, Use use) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const Property& property) { return property.use == use; });
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

/// The numbers behind the header, whatever their encoding.
class Numbers {
 public:
  Numbers(MeshSource& source, Encoding encoding) : source_(source), encoding_(encoding) {}

  /// In text every entry of an element has a line of its own.
  void begin_entry() {
    if (encoding_ != Encoding::text) return;
    const auto line = next_line_with_words();
    if (!line) source_.fail_cut_short();
    line_ = *line;
  }

  void end_entry() {
    if (encoding_ != Encoding::text) return;
    if (!take_word(line_).empty()) source_.fail_in_line("has too many numbers; the file is damaged: copy it again");
  }

  double next(Type type) {
    if (encoding_ == Encoding::text) return next_in_text(type);
    switch (type) {
      case Type::int8:
        return next_as<std::int8_t>();
      case Type::uint8:
        return next_as<std::uint8_t>();
      case Type::int16:
        return next_as<std::int16_t>();
      case Type::uint16:
        return next_as<std::uint16_t>();
      case Type::int32:
        return next_as<std::int32_t>();
      case Type::uint32:
        return next_as<std::uint32_t>();
      case Type::float32:
        return static_cast<double>(next_as<float>());
      case Type::float64:
        break;
    }
    return next_as<double>();
  }

  void require_end() {
    const bool more = encoding_ == Encoding::text ? next_line_with_words().has_value() : source_.remaining() > 0;
    if (more) source_.fail("goes on behind the last of its elements; the file is damaged: copy it again");
  }

 private:
  std::optional<std::string_view> next_line_with_words() {
    while (const auto line = source_.next_line()) {
      if (std::string_view rest = *line; !take_word(rest).empty()) return line;
    }
    return std::nullopt;
  }

  double next_in_text(Type type) {
    const double value = take_real(line_, source_);
    if (is_whole(type) && value != std::floor(value)) {
      source_.fail_in_line("has " + format_real(value) + " in place of a whole number; write the mesh anew");
    }
    return value;
  }

  template <typename T>
  T next_as() {
    std::array<std::byte, sizeof(T)> bytes;
    std::memcpy(bytes.data(), source_.bytes(sizeof(T)), sizeof(T));
    const bool file_is_big = encoding_ == Encoding::big_endian;
    if (file_is_big != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }

  MeshSource& source_;
  Encoding encoding_;
  std::string_view line_;
};

/// Bytes that an entry of this element takes at least.
std::uint64_t least_bytes(const Element& element, Encoding encoding) {
  std::uint64_t bytes = 0;
  for (const Property& property : element.properties) {
    // In text a digit and what divides it from the next.
    bytes += encoding == Encoding::text ? 2 : bytes_of(property.count_type.value_or(property.type));
  }
  return bytes;
}

class BodyReader {
 public:
  BodyReader(MeshSource& source, const Header& header)
      : source_(source), header_(header), numbers_(source, header.encoding), builder_(source) {}

  Mesh read() {
    for (const Element& element : header_.elements) {
      if (element.properties.empty()) continue;
      builder_.require_room(element.count, least_bytes(element, header_.encoding),
                            element.name == "vertex" ? "vertices"
                            : element.name == "face" ? "faces"
                                                     : "things");
      for (std::uint64_t i = 0; i < element.count; ++i) read_entry(element);
    }
    numbers_.require_end();
    return builder_.finish();
  }

 private:
  void read_entry(const Element& element) {
    numbers_.begin_entry();
    for (const Property& property : element.properties) {
      if (property.count_type) {
        read_list(property);
      } else {
        values_[static_cast<std::size_t>(property.use)] = numbers_.next(property.type);
      }
    }
    numbers_.end_entry();
    if (element.name == "vertex") {
      builder_.add_vertex({value(Use::x), value(Use::y), value(Use::z)});
      if (uses(element, Use::nx) && uses(element, Use::ny) && uses(element, Use::nz)) {
        builder_.add_normal({value(Use::nx), value(Use::ny), value(Use::nz)});
      }
    } else if (element.name == "face") {
      // Not only useless: read out of step, much of a binary file looks like faces without corners.
      if (corners_.size() < 3) source_.fail("has a face of fewer than three corners; the file is damaged");
      builder_.add_polygon(corners_, uses(element, Use::sweep_sign) ? std::optional(sweep_sign()) : std::nullopt);
    }
  }

  void read_list(const Property& property) {
    const double count = numbers_.next(*property.count_type);
    if (count < 0.0 || count > kMostInList) {
      source_.fail("has a list of " + format_real(count) + " numbers; at most 1000000 can be read");
    }
    const bool is_face = property.use == Use::corners;
    if (is_face) corners_.clear();
    for (double i = 0.0; i < count; ++i) {
      const double number = numbers_.next(property.type);
      if (!is_face) continue;
      // Text may hold any number here; what is no index would not fit.
      if (std::abs(number) > std::numeric_limits<std::uint32_t>::max()) {
        source_.fail("a face names vertex " + format_real(number) + ", which cannot be; write the mesh anew");
      }
      corners_.push_back(static_cast<std::int64_t>(number));
    }
  }

  double value(Use use) const { return values_[static_cast<std::size_t>(use)]; }

  std::int8_t sweep_sign() const {
    const double sign = value(Use::sweep_sign);
    if (sign != 1.0 && sign != -1.0) {
      source_.fail("has a sweep sign of " + format_real(sign) + "; it must be 1 or -1");
    }
    return static_cast<std::int8_t>(sign);
  }

  MeshSource& source_;
  const Header& header_;
  Numbers numbers_;
  MeshBuilder builder_;
  std::array<double, 9> values_ = {};  ///< of the last entry, by Use
  std::vector<std::int64_t> corners_;
};

}  // namespace

Mesh read_ply(MeshSource& source) {
  const Header header = HeaderReader(source).read();
  return BodyReader(source, header).read();
}

}  // namespace fathom
