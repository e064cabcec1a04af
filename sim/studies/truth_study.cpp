#include "sim/studies/truth_study.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/numbers.h"
#include "core/random.h"
#include "sim/phantom.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kCells = 384;
constexpr double kGoal_percent = 0.05;
constexpr double kMm3PerMl = 1000.0;

/// A box that holds the solid, with some room: a solid beyond it would be counted too small.
Eigen::AlignedBox3d box_of(const Solid& solid) {
  constexpr double kRoom_mm = 0.05;
  Eigen::AlignedBox3d box;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector3d direction = side * Eigen::Vector3d::Unit(axis);
      box.extend((solid.contact(direction).point_mm + kRoom_mm * direction).eval());
    }
  }
  return box;
}

double percent_of(const Json& value) {
  return 100.0 * (value.at("counted_ml").get<double>() / value.at("true_ml").get<double>() - 1.0);
}

class TruthStudy final : public Study {
 public:
  std::string name() const override { return "truth"; }
  std::string title() const override { return "true volumes, by formula and by counting points"; }
  int cases(const StudyOptions&) const override { return static_cast<int>(object_names().size()); }
  std::string case_name(const StudyOptions&, int index) const override { return name_of(index); }

  Json run_case(const StudyOptions& options, int index) const override {
    const Phantom phantom = make_phantom(name_of(index));
    return {{"object", phantom.name},
            {"true_ml", phantom.solid->volume_mm3() / kMm3PerMl},
            {"counted_ml", counted_volume_mm3(*phantom.solid, kCells, case_seed(options, index)) / kMm3PerMl}};
  }

  Json rows(const StudyOptions&, const std::vector<Json>& results) const override {
    Json json = Json::array();
    for (const Json& value : results) {
      Json row = value;
      row["difference_percent"] = percent_of(value);
      json.push_back(std::move(row));
    }
    return json;
  }

  StudyReport report(const StudyOptions&, const std::vector<Json>& results) const override {
    StudyTable table;
    table.name = "volumes";
    table.title = "True volumes of all objects";
    table.columns = {"object", "by formula (ml)", "by counting (ml)", "difference (%)"};
    table.remark = "Counted: " + std::to_string(kCells) +
                   " cells along the longest extent, in each a point at a random place, inside or not. By formula: "
                   "closed forms, or warps that keep the volume.";
    double largest = 0.0;
    for (const Json& value : results) {
      const double percent = percent_of(value);
      largest = std::max(largest, std::abs(percent));
      table.rows.push_back({value.at("object").get<std::string>(), format_rounded(value.at("true_ml").get<double>(), 4),
                            format_rounded(value.at("counted_ml").get<double>(), 4), format_rounded(percent, 4)});
    }
    StudyReport report;
    report.tables.push_back(std::move(table));
    report.goals.push_back({"volumes by formula and by counting", "agree to 0.05 %",
                            "differ by at most " + format_rounded(largest, 4) + " %", largest <= kGoal_percent});
    return report;
  }

 private:
  static std::string name_of(int index) { return object_names().at(static_cast<std::size_t>(index)); }
};

}  // namespace

double counted_volume_mm3(const Solid& solid, int cells, std::uint64_t seed) {
  const Eigen::AlignedBox3d box = box_of(solid);
  const double cell_mm = box.sizes().maxCoeff() / cells;
  const Eigen::Vector3i counts = (box.sizes() / cell_mm).array().ceil().cast<int>();
  Random random(seed);
  std::int64_t inside = 0;
  for (int z = 0; z < counts.z(); ++z) {
    for (int y = 0; y < counts.y(); ++y) {
      for (int x = 0; x < counts.x(); ++x) {
        const double dx = random.uniform();
        const double dy = random.uniform();
        const double dz = random.uniform();
        const Eigen::Vector3d point = box.min() + cell_mm * Eigen::Vector3d(x + dx, y + dy, z + dz);
        if (solid.distance_bound_mm(point) <= 0.0) ++inside;
      }
    }
  }
  return static_cast<double>(inside) * cell_mm * cell_mm * cell_mm;
}

const Study& truth_study() {
  static const TruthStudy study;
  return study;
}

}  // namespace fathom
