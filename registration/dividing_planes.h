#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/json.h"
#include "registration/partition.h"

namespace fathom {

/// The plane between two sweeps: midway between the sides that face each other. Both normals are turned along the way
/// from the first sweep's centre to the second's. Throws Error when the centres coincide, so that nothing lies between.
/// Treece 2000, equation (4.1).
DividingPlane plane_between(const SweepShape& a, const SweepShape& b);

/// A partition with a plane between every two sweeps, as far as they separate any; of more than eight sweeps between
/// those that have none between them. Pairs of sweeps that cannot be
/// separated are named in `warnings`, if any. Throws Error for more sweeps than SpacePartition has planes for.
SpacePartition place_dividing_planes(std::vector<SweepShape> sweeps, std::vector<std::string>* warnings);

/// What a file of dividing planes holds; an exam.json has the same keys.
struct PlanesFile {
  std::vector<Sweep> sweeps;  ///< empty where the file names none
  std::vector<DividingPlane> planes;
};

/// What an object in a file holds under "sweeps" and "dividing_planes", either of which may be missing. Throws Error
/// for more than 32 planes or 1000 sweeps, when a normal has no length to 1e-3 of a unit vector's, or sweeps run
/// backward or overlap.
PlanesFile planes_of(const JsonValue& root);

/// Throws Error when the file is damaged, or has no "dividing_planes"; and as planes_of.
PlanesFile read_planes(const std::filesystem::path& path);

/// The text of such a file; reads back as the same.
std::string planes_json(const PlanesFile& planes);

}  // namespace fathom
