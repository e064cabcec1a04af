#include "acquisition/volume_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/header_text.h"
#include "acquisition/nrrd_geometry.h"
#include "core/numbers.h"

namespace fathom {

namespace {

// A nanometre and a kilometre: beyond these a number is damage, and products of such sizes stay far from overflow.
constexpr double kSmallestSide_mm = 1e-6;
constexpr double kLargestSide_mm = 1e6;
constexpr double kFarthest_mm = 1e9;
constexpr double kFlattest = 1e-6;  // volume of a voxel, over that of a box with its sides

/// The field of a header under the first of its names that is given.
std::optional<std::pair<std::string, std::string>> find_field(const RecordingHeader& header,
                                                              std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    for (const auto& field : header.fields) {
      if (field.first == name) return field;
    }
  }
  return std::nullopt;
}

/// As many numbers as `values` has, in place of those in it, where the field is given.
void read_numbers(const RecordingHeader& header, std::initializer_list<std::string_view> names,
                  std::span<double> values, const InputFile& file) {
  const auto field = find_field(header, names);
  if (field && !parse_reals(field->second, values)) {
    file.fail(field->first + " is \"" + printable(field->second) + "\"; a volume has " + std::to_string(values.size()) +
              " finite numbers there");
  }
}

bool is_millimetres(std::string_view unit) {
  constexpr std::array<std::string_view, 6> kNames = {"",           "mm",          "millimeter",
                                                      "millimetre", "millimeters", "millimetres"};
  return std::any_of(kNames.begin(), kNames.end(),
                     [&](std::string_view name) { return equal_ignoring_case(unit, name); });
}

/// Units are one word, or in NRRD one quoted for each axis.
void check_units(const RecordingHeader& header, std::initializer_list<std::string_view> names, const InputFile& file) {
  const auto field = find_field(header, names);
  if (!field) return;
  std::string text = field->second;
  std::replace(text.begin(), text.end(), '"', ' ');
  for (const std::string_view unit : words(text)) {
    if (!is_millimetres(unit)) {
      file.fail(field->first + " is \"" + printable(field->second) + "\"; only volumes in millimetres can be read");
    }
  }
}

void check_spacing(const Eigen::Vector3d& spacing_mm, std::string_view name, const InputFile& file) {
  if (!(spacing_mm.minCoeff() > 0.0))
    file.fail(std::string(name) + " must be three numbers greater than 0; write the file again");
}

Eigen::Affine3d metaimage_geometry(const SequenceFile& sequence, const InputFile& file) {
  const RecordingHeader& header = sequence.header;
  Eigen::Vector3d spacing_mm = Eigen::Vector3d::Ones();
  Eigen::Vector3d offset_mm = Eigen::Vector3d::Zero();
  // Three numbers are the direction of one axis: the columns of the matrix, one behind the other, as Eigen has them.
  Eigen::Matrix3d directions = Eigen::Matrix3d::Identity();
  // MetaIO's other names for the same fields.
  read_numbers(header, {"ElementSpacing", "ElementSize"}, {spacing_mm.data(), 3}, file);
  read_numbers(header, {"Offset", "Position", "Origin"}, {offset_mm.data(), 3}, file);
  read_numbers(header, {"TransformMatrix", "Rotation", "Orientation"}, {directions.data(), 9}, file);
  check_units(header, {"DistanceUnits"}, file);
  check_spacing(spacing_mm, "ElementSpacing", file);
  Eigen::Affine3d reference_from_voxel = Eigen::Affine3d::Identity();
  reference_from_voxel.linear() = directions * spacing_mm.asDiagonal();
  reference_from_voxel.translation() = offset_mm;
  return reference_from_voxel;
}

/// Signs that bring coordinates to LPS.
Eigen::Vector3d lps_from(const std::string& space, const InputFile& file) {
  const auto is = [&](std::string_view name) { return equal_ignoring_case(space, name); };
  if (is("right-anterior-superior") || is("RAS")) return {-1.0, -1.0, 1.0};
  if (is("left-anterior-superior") || is("LAS")) return {1.0, -1.0, 1.0};
  // Coordinates of a device, or without a name, are taken as they are.
  if (space.empty() || is("left-posterior-superior") || is("LPS") || is("scanner-xyz") || is("3D-right-handed") ||
      is("3D-left-handed")) {
    return Eigen::Vector3d::Ones();
  }
  file.fail("its space is \"" + printable(space) + "\"; only LPS, RAS, LAS, scanner-xyz and 3D can be read");
}

Eigen::Affine3d nrrd_geometry(const SequenceFile& sequence, const InputFile& file) {
  const NrrdSpace& stated = *sequence.nrrd_space;
  const auto read_vector = [&](const std::vector<double>& from, std::string_view name) {
    if (from.size() != 3)
      file.fail("its " + std::string(name) + " must be vectors of three finite numbers; write the file again");
    return Eigen::Vector3d(from[0], from[1], from[2]);
  };
  Eigen::Affine3d space_from_voxel = Eigen::Affine3d::Identity();
  if (!stated.directions.empty()) {
    const auto vectors = parse_nrrd_vectors(stated.directions);
    if (vectors.size() != 3) {
      file.fail("its space directions are \"" + printable(stated.directions) + "\"; a volume has three vectors there");
    }
    for (int axis = 0; axis < 3; ++axis) {
      space_from_voxel.linear().col(axis) = read_vector(vectors[static_cast<std::size_t>(axis)], "space directions");
    }
  } else if (!stated.spacings.empty()) {
    Eigen::Vector3d spacing_mm;
    if (!parse_reals(stated.spacings, std::span(spacing_mm.data(), 3))) {
      file.fail("its spacings are \"" + printable(stated.spacings) + "\"; a volume has three finite numbers there");
    }
    check_spacing(spacing_mm, "spacings", file);
    space_from_voxel.linear() = spacing_mm.asDiagonal();
  }
  if (!stated.origin.empty()) {
    const auto vectors = parse_nrrd_vectors(stated.origin);
    if (vectors.size() != 1) file.fail("its space origin is \"" + printable(stated.origin) + "\"; it must be a vector");
    space_from_voxel.translation() = read_vector(vectors[0], "space origin");
  }
  check_units(sequence.header, {"space units"}, file);
  check_units(sequence.header, {"units"}, file);
  return Eigen::Scaling(lps_from(stated.space, file)) * space_from_voxel;
}

std::string numbers(const Eigen::Ref<const Eigen::VectorXd>& values, char separator) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += separator;
    text += format_real(value);
  }
  return text;
}

}  // namespace

std::optional<std::string> fault_of_volume_geometry(const Eigen::Affine3d& reference_from_voxel) {
  const Eigen::Matrix3d axes = reference_from_voxel.linear();
  const Eigen::Vector3d origin_mm = reference_from_voxel.translation();
  if (!axes.allFinite() || !origin_mm.allFinite()) return "the numbers that say where its voxels lie are not finite";
  const Eigen::Vector3d sides_mm = axes.colwise().stableNorm();
  if (sides_mm.minCoeff() < kSmallestSide_mm || sides_mm.maxCoeff() > kLargestSide_mm) {
    return "its voxels are " + format_real(sides_mm[0]) + " x " + format_real(sides_mm[1]) + " x " +
           format_real(sides_mm[2]) + " mm; sides must be between 1e-6 and 1e6 mm";
  }
  if (origin_mm.cwiseAbs().maxCoeff() > kFarthest_mm) return "its voxels lie farther than 1e9 mm away";
  const Eigen::Matrix3d directions = axes.array().rowwise() / sides_mm.transpose().array();
  if (std::abs(directions.determinant()) < kFlattest) return "its three axes lie in one plane";
  return std::nullopt;
}

Eigen::Affine3d volume_geometry(const SequenceFile& sequence, const InputFile& file) {
  const Eigen::Affine3d reference_from_voxel =
      sequence.nrrd_space ? nrrd_geometry(sequence, file) : metaimage_geometry(sequence, file);
  if (const auto fault = fault_of_volume_geometry(reference_from_voxel)) {
    file.fail(*fault + "; the header is damaged");
  }
  return reference_from_voxel;
}

std::string metaimage_volume_lines(const Eigen::Affine3d& reference_from_voxel) {
  const Eigen::Matrix3d axes = reference_from_voxel.linear();
  const Eigen::Vector3d spacing_mm = axes.colwise().norm();
  const Eigen::Matrix3d directions = axes.array().rowwise() / spacing_mm.transpose().array();
  return "TransformMatrix = " + numbers(directions.reshaped(), ' ') +
         "\nOffset = " + numbers(reference_from_voxel.translation(), ' ') +
         "\nCenterOfRotation = 0 0 0\nElementSpacing = " + numbers(spacing_mm, ' ') + '\n';
}

std::string nrrd_volume_lines(const Eigen::Affine3d& reference_from_voxel) {
  std::string text = "space: left-posterior-superior\nspace directions:";
  for (int axis = 0; axis < 3; ++axis) text += " (" + numbers(reference_from_voxel.linear().col(axis), ',') + ')';
  return text + "\nspace origin: (" + numbers(reference_from_voxel.translation(), ',') + ")\n";
}

}  // namespace fathom
