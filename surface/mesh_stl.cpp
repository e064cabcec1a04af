#include "surface/mesh_stl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "core/error.h"
#include "core/printable.h"
#include "surface/mesh_builder.h"

namespace fathom {

namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kTriangleBytes = 50;  // 12 floats and two bytes for "attributes"
constexpr std::size_t kTrianglesBetweenReports = 1 << 16;

/// Numbers positions so that equal ones get one number: a hash table with open addresses.
class VertexNumbers {
 public:
  explicit VertexNumbers(MeshBuilder& builder) : builder_(builder), slots_(1 << 10, kFree) {}

  std::int64_t number_of(std::array<double, 3> position) {
    for (double& x : position) x += 0.0;  // -0 becomes 0
    if (2 * static_cast<std::size_t>(builder_.vertex_count()) >= slots_.size()) grow();
    std::int32_t& slot = find(position);
    if (slot == kFree) {
      slot = static_cast<std::int32_t>(builder_.vertex_count());
      builder_.add_vertex(position);
    }
    return slot;
  }

 private:
  static constexpr std::int32_t kFree = -1;

  std::int32_t& find(const std::array<double, 3>& position) {
    std::uint64_t hash = 0;
    for (const double x : position) {
      // Splitmix64's mixing: every bit of the input changes half of the output's.
      hash += std::bit_cast<std::uint64_t>(x) + 0x9e3779b97f4a7c15;
      hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9;
      hash = (hash ^ (hash >> 27)) * 0x94d049bb133111eb;
      hash ^= hash >> 31;
    }
    for (std::size_t i = hash & (slots_.size() - 1);; i = (i + 1) & (slots_.size() - 1)) {
      if (slots_[i] == kFree) return slots_[i];
      const Eigen::Vector3d& other = builder_.mesh().vertices[static_cast<std::size_t>(slots_[i])];
      if (other.x() == position[0] && other.y() == position[1] && other.z() == position[2]) return slots_[i];
    }
  }

  void grow() {
    slots_.assign(2 * slots_.size(), kFree);
    for (std::int64_t v = 0; v < builder_.vertex_count(); ++v) {
      const Eigen::Vector3d& at = builder_.mesh().vertices[static_cast<std::size_t>(v)];
      find({at.x(), at.y(), at.z()}) = static_cast<std::int32_t>(v);
    }
  }

  MeshBuilder& builder_;
  std::vector<std::int32_t> slots_;
};

template <typename T>
T little_endian(const std::byte* bytes) {
  std::array<std::byte, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

std::uint64_t stated_triangles(MeshSource& source) {
  const std::string_view head = source.first_bytes(kHeaderBytes + 4);
  if (head.size() < kHeaderBytes + 4) return std::numeric_limits<std::uint64_t>::max();
  return little_endian<std::uint32_t>(reinterpret_cast<const std::byte*>(head.data()) + kHeaderBytes);
}

Mesh read_binary(MeshSource& source, std::uint64_t count) {
  MeshBuilder builder(source);
  VertexNumbers numbers(builder);
  source.bytes(kHeaderBytes + 4);
  for (std::uint64_t t = 0; t < count; ++t) {
    const std::byte* const triangle = source.bytes(kTriangleBytes);
    std::array<std::int64_t, 3> corners = {};
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<double, 3> position = {};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        position[axis] = static_cast<double>(little_endian<float>(triangle + 12 * (c + 1) + 4 * axis));
        if (!std::isfinite(position[axis])) {
          source.fail("triangle " + std::to_string(t) + " has a corner that is not finite; write the mesh anew");
        }
      }
      corners[c] = numbers.number_of(position);
    }
    builder.add_polygon(corners);
  }
  return builder.finish();
}

/// The words of a text, without the lines: they do not matter in STL.
class Words {
 public:
  explicit Words(MeshSource& source) : source_(source) {}

  std::string next() {
    std::string_view word = take_word(line_);
    while (word.empty()) {
      const auto line = source_.next_line();
      if (!line) source_.fail_cut_short();
      line_ = *line;
      word = take_word(line_);
    }
    return lower(word);
  }

  void expect(std::string_view expected) {
    if (const std::string word = next(); word != expected) {
      source_.fail_in_line("has \"" + printable(word) + "\" in place of \"" + std::string(expected) +
                           "\"; the file is damaged: copy it again");
    }
  }

  std::array<double, 3> vector() {
    std::array<double, 3> numbers = {};
    for (double& number : numbers) {
      const std::string word = next();
      std::string_view rest = word;
      number = take_real(rest, source_);
    }
    return numbers;
  }

  /// Passes over what else stands in the line, such as a name.
  void end_line() { line_ = {}; }

  /// The next line that holds a word; false at the end of the file.
  bool next_line() {
    while (const auto line = source_.next_line()) {
      line_ = *line;
      if (std::string_view rest = line_; !take_word(rest).empty()) return true;
    }
    return false;
  }

 private:
  static std::string lower(std::string_view word) {
    std::string text(word);
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return text;
  }

  MeshSource& source_;
  std::string_view line_;
};

Mesh read_text(MeshSource& source) {
  MeshBuilder builder(source);
  VertexNumbers numbers(builder);
  Words words(source);
  while (words.next_line()) {  // one solid may follow another
    words.expect("solid");
    words.end_line();
    for (std::string word = words.next(); word != "endsolid"; word = words.next()) {
      if (word != "facet") {
        source.fail_in_line("has \"" + printable(word) + "\" in place of a facet; the file is damaged: copy it again");
      }
      words.expect("normal");
      for (int i = 0; i < 3; ++i) words.next();  // some write NaN for a triangle without area
      words.expect("outer");
      words.expect("loop");
      std::array<std::int64_t, 3> corners = {};
      for (std::int64_t& corner : corners) {
        words.expect("vertex");
        corner = numbers.number_of(words.vector());
      }
      words.expect("endloop");
      words.expect("endfacet");
      builder.add_polygon(corners);
    }
    words.end_line();
  }
  return builder.finish();
}

void append_float(std::string& bytes, double value) {
  auto raw = std::bit_cast<std::array<char, sizeof(float)>>(static_cast<float>(value));
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

void append_vector(std::string& bytes, const Eigen::Vector3d& vector) {
  for (const double x : vector) append_float(bytes, x);
}

}  // namespace

Mesh read_stl(MeshSource& source) {
  const std::uint64_t count = stated_triangles(source);
  constexpr std::uint64_t kFixedBytes = kHeaderBytes + 4;
  // A binary header may begin with "solid" as well, so the length decides.
  if (count <= (1ull << 32) && source.size() == kFixedBytes + count * kTriangleBytes) return read_binary(source, count);
  std::string_view head = source.first_bytes(kHeaderBytes);
  const std::string_view first = take_word(head);
  if (first.starts_with("solid") || first.starts_with("SOLID") || first.starts_with("Solid")) return read_text(source);
  if (source.size() < kFixedBytes) source.fail("is too short for an STL file; it was cut short: copy it again");
  source.fail("claims " + std::to_string(count) + " triangles, which is not what its length of " +
              std::to_string(source.size()) + " bytes holds; it was cut short, or is no STL file: copy it again");
}

void write_stl(const Mesh& mesh, AtomicFile& file, const Progress& progress) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    if (vertex.cwiseAbs().maxCoeff() > kLargest) {
      throw Error(printable(file.target().string(), 300) +
                  ": the mesh has coordinates beyond what STL can hold; choose another format, such as .ply");
    }
  }
  std::string head = "Fathom mesh, millimetres";  // must not begin with "solid", or some would take it for text
  head.resize(kHeaderBytes, ' ');
  const auto count = std::bit_cast<std::array<char, 4>>(static_cast<std::uint32_t>(mesh.triangles.size()));
  head.append(count.data(), count.size());
  if constexpr (std::endian::native == std::endian::big) std::reverse(head.end() - 4, head.end());
  file.write(head);
  std::string bytes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kTrianglesBetweenReports == 0) {
      report(progress, static_cast<double>(t) / static_cast<double>(mesh.triangles.size()));
    }
    std::array<Eigen::Vector3d, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      // As stored, so that the normal is that of the triangle which is read.
      corners[c] = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][c])].cast<float>().cast<double>();
    }
    const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).stableNormalized();
    bytes.clear();
    append_vector(bytes, normal.allFinite() ? normal : Eigen::Vector3d::Zero());
    for (const Eigen::Vector3d& corner : corners) append_vector(bytes, corner);
    bytes.append(2, '\0');
    file.write(bytes);
  }
  report(progress, 1.0);
}

}  // namespace fathom
