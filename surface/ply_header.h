#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surface/mesh_source.h"

/// What a PLY file says of itself before its numbers.
namespace fathom::ply {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t bytes_of(Type type);
bool is_whole(Type type);

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

bool uses(const Element& element, Use use);

/// Reads to the end of the header. Throws Error when it is none, or not one of a mesh, or says something twice.
Header read_header(MeshSource& source);

}  // namespace fathom::ply
