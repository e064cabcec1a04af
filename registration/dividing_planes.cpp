#include "registration/dividing_planes.h"

#include <array>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/json.h"

namespace fathom {

namespace {

constexpr double kSmallest_mm = 1e-6;  // closer than any tracker tells apart
constexpr double kRounding = 1e-15;    // of a normalised vector's length
constexpr double kUnitLength = 1e-3;   // normals in files are typed by people, with few digits
constexpr double kFarthest_mm = 1e6;   // a kilometre away is no plane of this patient
constexpr int kMaxFrame = 1 << 30;
constexpr std::size_t kMaxSweeps = 1000;  // nobody sweeps an organ more often

struct Side {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< along the way to the other sweep
  Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();
};

// The side of the hexahedron through the first and last frames that faces most along `way`.
Side facing_side(const SweepShape& sweep, const Eigen::Vector3d& way) {
  static constexpr std::array<std::array<std::size_t, 4>, 6> kSides{
      {{0, 1, 2, 3}, {0, 4, 5, 1}, {1, 5, 6, 2}, {5, 4, 7, 6}, {3, 2, 6, 7}, {4, 0, 3, 7}}};
  std::vector<Eigen::Vector3d> corners = sweep.first_corners_mm;
  corners.insert(corners.end(), sweep.last_corners_mm.begin(), sweep.last_corners_mm.end());
  const Eigen::Vector3d centre = sweep.centre_mm();
  Side best{way, centre};
  double largest = 0.0;
  for (const auto& [i, j, k, l] : kSides) {
    const Eigen::Vector3d p = corners[i];
    const Eigen::Vector3d q = corners[j];
    const Eigen::Vector3d r = corners[k];
    const Eigen::Vector3d s = corners[l];
    Eigen::Vector3d normal = (p - q - r + s).cross(p + q - r - s);
    // A sweep of one frame has four sides without an area.
    if (normal.norm() < kSmallest_mm * kSmallest_mm) continue;
    normal.normalize();
    const Eigen::Vector3d middle = 0.25 * (p + q + r + s);
    const double outward = normal.dot(middle - centre);
    const bool flat = std::abs(outward) < kSmallest_mm;
    if (flat ? normal.dot(way) < 0.0 : outward < 0.0) normal = -normal;
    if (normal.dot(way) > largest) {
      largest = normal.dot(way);
      best = {normal, middle};
    }
  }
  return best;
}

DividingPlane read_plane(const JsonValue& item) {
  const JsonValue numbers = item.at("normal");
  if (numbers.size() != 3) numbers.fail("must have three numbers");
  Eigen::Vector3d normal;
  for (int i = 0; i < 3; ++i) normal[i] = numbers[static_cast<std::size_t>(i)].number();
  const double off = std::abs(normal.norm() - 1.0);
  if (off > kUnitLength) numbers.fail("must be a unit vector; divide it by its length");
  const double offset_mm = item.at("offset_mm").number();
  if (std::abs(offset_mm) > kFarthest_mm) item.at("offset_mm").fail("is farther than 1 km away; it is in millimetres");
  // One that was normalised before it was written comes back to the bit.
  return {off > kRounding ? normal.normalized() : normal, -offset_mm};
}

// Whether no other sweep's centre lies in the ball that has the way between these two as its diameter: then another
// one separates them already.
bool are_neighbours(const std::vector<SweepShape>& sweeps, std::size_t i, std::size_t j) {
  const Eigen::Vector3d a = sweeps[i].centre_mm();
  const Eigen::Vector3d b = sweeps[j].centre_mm();
  for (std::size_t k = 0; k < sweeps.size(); ++k) {
    if (k == i || k == j) continue;
    const Eigen::Vector3d c = sweeps[k].centre_mm();
    if ((a - c).dot(b - c) < 0.0) return false;
  }
  return true;
}

Sweep read_sweep(const JsonValue& item) {
  Sweep sweep;
  if (item.has("recording")) sweep.recording = static_cast<std::size_t>(item.at("recording").integer(0, kMaxFrame));
  sweep.first = item.at("first").integer(0, kMaxFrame);
  sweep.last = item.at("last").integer(0, kMaxFrame);
  if (sweep.last < sweep.first) item.fail("ends before it begins");
  return sweep;
}

}  // namespace

DividingPlane plane_between(const SweepShape& a, const SweepShape& b) {
  Eigen::Vector3d way = b.centre_mm() - a.centre_mm();
  if (way.norm() < kSmallest_mm) throw Error("two sweeps have the same centre: no plane lies between them; drop one");
  way.normalize();
  const Side from = facing_side(a, way);
  const Side to = facing_side(b, -way);
  Eigen::Vector3d normal = from.normal - to.normal;
  if (normal.norm() < kSmallest_mm) normal = way;
  normal.normalize();
  return {normal, 0.5 * (from.middle_mm + to.middle_mm)};
}

SpacePartition place_dividing_planes(std::vector<SweepShape> sweeps, std::vector<std::string>* warnings) {
  std::vector<DividingPlane> planes;
  const bool few = sweeps.size() * (sweeps.size() - 1) / 2 <= SpacePartition::kMaxPlanes;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    for (std::size_t j = i + 1; j < sweeps.size(); ++j) {
      if (!few && !are_neighbours(sweeps, i, j)) continue;
      if (planes.size() == SpacePartition::kMaxPlanes) {
        throw Error("too many sweeps: more than 32 planes would lie between them; join or drop some");
      }
      try {
        planes.push_back(plane_between(sweeps[i], sweeps[j]));
      } catch (const Error&) {
        if (warnings == nullptr) continue;
        warnings->push_back("sweeps " + std::to_string(i + 1) + " and " + std::to_string(j + 1) +
                            " have the same centre: no plane lies between them; drop one or add a plane");
      }
    }
  }
  SpacePartition partition(std::move(sweeps), std::move(planes));
  partition.remove_redundant();
  return partition;
}

PlanesFile planes_of(const JsonValue& root) {
  PlanesFile file;
  if (root.has("dividing_planes")) {
    const JsonValue planes = root.at("dividing_planes");
    if (planes.size() > SpacePartition::kMaxPlanes) planes.fail("has more than 32 planes; remove some");
    for (std::size_t i = 0; i < planes.size(); ++i) file.planes.push_back(read_plane(planes[i]));
  }
  if (!root.has("sweeps")) return file;
  const JsonValue sweeps = root.at("sweeps");
  if (sweeps.size() > kMaxSweeps) sweeps.fail("has more than 1000 sweeps; drop those that are none");
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    const Sweep sweep = read_sweep(sweeps[i]);
    for (const Sweep& other : file.sweeps) {
      if (other.recording == sweep.recording && other.first <= sweep.last && sweep.first <= other.last) {
        sweeps[i].fail("shares frames with another sweep; let each frame belong to one");
      }
    }
    file.sweeps.push_back(sweep);
  }
  return file;
}

PlanesFile read_planes(const std::filesystem::path& path) {
  const nlohmann::json document = JsonValue::read_file(path);
  const JsonValue root(document, path);
  root.at("dividing_planes").size();
  return planes_of(root);
}

std::string planes_json(const PlanesFile& file) {
  nlohmann::ordered_json json;
  json["fathom_planes"] = 1;
  json["sweeps"] = nlohmann::ordered_json::array();
  for (const Sweep& sweep : file.sweeps) {
    json["sweeps"].push_back({{"recording", sweep.recording}, {"first", sweep.first}, {"last", sweep.last}});
  }
  json["dividing_planes"] = nlohmann::ordered_json::array();
  for (const DividingPlane& plane : file.planes) {
    const Eigen::Vector3d normal = plane.normal();
    json["dividing_planes"].push_back(
        {{"normal", {normal.x(), normal.y(), normal.z()}}, {"offset_mm", -plane.offset()}});
  }
  return json.dump(1, ' ') + "\n";
}

}  // namespace fathom
