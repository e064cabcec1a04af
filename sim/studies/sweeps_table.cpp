#include "sim/studies/sweeps_table.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "sim/studies/study_json.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

struct Figure {
  const char* name;
  double SweepsMeasurement::*value;
};

constexpr Figure kFigures[] = {{"linear_percent", &SweepsMeasurement::linear_percent},
                               {"cubic_percent", &SweepsMeasurement::cubic_percent},
                               {"quadric_percent", &SweepsMeasurement::quadric_percent},
                               {"cut_off_mm", &SweepsMeasurement::cut_off_mm},
                               {"missing_percent", &SweepsMeasurement::missing_percent}};

Json json_of(const SweepsMeasurement& measurement) {
  Json json = {{"frames", measurement.frames}, {"sections", measurement.sections}};
  for (const Figure& figure : kFigures) json[figure.name] = number_json(measurement.*figure.value);
  return json;
}

SweepsMeasurement measurement_of(const Json& json) {
  SweepsMeasurement measurement;
  measurement.frames = json.at("frames").get<int>();
  measurement.sections = json.at("sections").get<int>();
  for (const Figure& figure : kFigures) measurement.*figure.value = number_of(json.at(figure.name));
  return measurement;
}

std::vector<SweepsCell> cells_of(const std::vector<Json>& results) {
  std::vector<SweepsCell> cells = published_sweeps_cells();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (const Json& measurement : results.at(i).at("measurements")) {
      cells[i].measurements.push_back(measurement_of(measurement));
    }
    summarise(cells[i]);
    cells[i].surface_percent = number_of(results[i].at("surface_percent"));
  }
  return cells;
}

Json sections_json(const std::optional<SweepsMeasurement>& measurement) {
  return measurement ? Json(measurement->sections) : Json(nullptr);
}

class SweepsTable final : public Study {
 public:
  std::string name() const override { return "4.1"; }
  std::string title() const override { return "volume from several sweeps"; }
  int cases(const StudyOptions&) const override { return static_cast<int>(published_sweeps_cells().size()); }

  std::string case_name(const StudyOptions&, int index) const override {
    const SweepsCell cell = published_sweeps_cells().at(static_cast<std::size_t>(index));
    return cell.object + " " + cell.pattern;
  }

  Json run_case(const StudyOptions&, int index) const override {
    const SweepsCell cell = measure_sweeps_cell(published_sweeps_cells().at(static_cast<std::size_t>(index)));
    Json measurements = Json::array();
    for (const SweepsMeasurement& measurement : cell.measurements) measurements.push_back(json_of(measurement));
    return {{"measurements", std::move(measurements)}, {"surface_percent", number_json(cell.surface_percent)}};
  }

  Json rows(const StudyOptions&, const std::vector<Json>& results) const override {
    Json json = Json::array();
    for (const SweepsCell& cell : cells_of(results)) {
      json.push_back({{"object", cell.object},
                      {"pattern", cell.pattern},
                      {"sections_within_2_percent",
                       {{"cubic_planimetry", sections_json(cell.sustained)},
                        {"cubic_planimetry_quadric", sections_json(cell.sustained_quadric)}}},
                      {"at_published", json_of(cell.at_published)},
                      {"surface_percent", number_json(cell.surface_percent)},
                      {"published",
                       {{"sections", cell.published_sections},
                        {"linear_percent", cell.published_linear},
                        {"surface_percent", cell.published_surface}}}});
    }
    return json;
  }

  StudyReport report(const StudyOptions&, const std::vector<Json>& results) const override {
    return sweeps_report(cells_of(results));
  }
};

}  // namespace

const Study& sweeps_table() {
  static const SweepsTable study;
  return study;
}

}  // namespace fathom
