#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "core/numbers.h"
#include "surface/mesh_builder.h"
#include "surface/mesh_ply.h"
#include "surface/ply_header.h"

namespace fathom {

namespace {

using namespace ply;

constexpr double kMostInList = 1'000'000;  // corners of a polygon, as a rule

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
  const Header header = read_header(source);
  return BodyReader(source, header).read();
}

}  // namespace fathom
