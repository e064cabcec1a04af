#include <utility>

#include "core/error.h"
#include "core/json.h"
#include "exam/document.h"
#include "registration/dividing_planes.h"
#include "registration/find_sweeps.h"

namespace fathom {

std::vector<Sweep> Document::stated_sweeps() const {
  return content_.sweeps.empty() ? find_sweeps(*scan_) : content_.sweeps;
}

void Document::change_division(const char* name, std::vector<Sweep> sweeps, std::vector<DividingPlane> planes) {
  // What cannot be a partition is refused here.
  if (!planes.empty()) SpacePartition(sweep_shapes(sweeps, *scan_), planes);
  change(name, DivisionChange{content_.sweeps, std::move(sweeps), content_.planes, std::move(planes)});
}

void Document::add_plane(const DividingPlane& plane) {
  std::vector<DividingPlane> planes = content_.planes;
  planes.push_back(plane);
  change_division("Add dividing plane", stated_sweeps(), std::move(planes));
}

void Document::move_plane(std::size_t plane, const DividingPlane& to) {
  std::vector<DividingPlane> planes = content_.planes;
  if (plane >= planes.size()) throw Error("there is no such dividing plane; choose one that there is");
  planes[plane] = to;
  change_division("Move dividing plane", stated_sweeps(), std::move(planes));
}

void Document::remove_plane(std::size_t plane) {
  std::vector<DividingPlane> planes = content_.planes;
  if (plane >= planes.size()) throw Error("there is no such dividing plane; choose one that there is");
  planes.erase(planes.begin() + static_cast<std::ptrdiff_t>(plane));
  change_division("Remove dividing plane", stated_sweeps(), std::move(planes));
}

std::vector<std::string> Document::place_planes() {
  std::vector<std::string> warnings;
  std::vector<Sweep> sweeps = stated_sweeps();
  std::vector<DividingPlane> planes = place_dividing_planes(sweep_shapes(sweeps, *scan_), &warnings).planes();
  change_division("Place dividing planes", std::move(sweeps), std::move(planes));
  return warnings;
}

void Document::split_sweep(std::size_t sweep, int frame) {
  std::vector<Sweep> sweeps = stated_sweeps();
  fathom::split_sweep(sweeps, sweep, frame);
  change_division("Split sweep", std::move(sweeps), content_.planes);
}

void Document::join_sweeps(std::size_t sweep) {
  std::vector<Sweep> sweeps = stated_sweeps();
  fathom::join_sweeps(sweeps, sweep);
  change_division("Join sweeps", std::move(sweeps), content_.planes);
}

void Document::remove_sweep(std::size_t sweep) {
  std::vector<Sweep> sweeps = stated_sweeps();
  drop_sweep(sweeps, sweep);
  if (sweeps.empty()) throw Error("the last sweep cannot be dropped; the scan would have none");
  change_division("Drop sweep", std::move(sweeps), content_.planes);
}

void Document::set_sweeps(std::vector<Sweep> sweeps) {
  // The rules of the file hold here, too.
  const nlohmann::json json = nlohmann::json::parse(planes_json({sweeps, content_.planes}));
  planes_of(JsonValue(json, "sweeps"));
  require_sweeps(sweeps, *scan_, title());
  change_division("Set sweeps", std::move(sweeps), content_.planes);
}

}  // namespace fathom
