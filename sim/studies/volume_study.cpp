#include "sim/studies/volume_study.h"

#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kNumbersOfPlanes = kMostPlanes - kFewestPlanes + 1;

Json json_of(const std::optional<int>& planes) { return planes ? Json(*planes) : Json(nullptr); }

/// One value for each method, by its name.
template <typename Value>
Json by_method(const std::vector<MethodAccuracy>& methods, Value value) {
  Json json;
  for (std::size_t m = 0; m < methods.size(); ++m) json[kVolumeMethods[m].name] = value(methods[m]);
  return json;
}

Json published_json(const PlanimetryRow& row) {
  Json planes;
  Json errors;
  for (std::size_t m = 0; m < kVolumeMethods.size(); ++m) {
    if (!row.published[m]) continue;
    planes[kVolumeMethods[m].name] = json_of(row.published[m]->planes_below_1_percent);
    errors[kVolumeMethods[m].name] = row.published[m]->error_percent_at_20;
  }
  return {{"planes_below_1_percent", planes}, {"error_percent_at_20", errors}};
}

double error_percent(const Json& value, const char* method) {
  const Json& volume_ml = value.at("volume_ml").at(method);
  if (volume_ml.is_null()) return std::numeric_limits<double>::quiet_NaN();
  return 100.0 * (volume_ml.get<double>() / value.at("true_ml").get<double>() - 1.0);
}

std::vector<VolumeRow> rows_of(const std::vector<Json>& results) {
  std::vector<VolumeRow> rows;
  std::size_t first = 0;
  for (PlanimetryRow& printed : published_planimetry_rows()) {
    VolumeRow row{std::move(printed), {}};
    for (const VolumeMethod& method : kVolumeMethods) {
      std::vector<double> errors;
      for (std::size_t i = 0; i < kNumbersOfPlanes; ++i) {
        errors.push_back(error_percent(results.at(first + i), method.name));
      }
      row.methods.push_back(accuracy_of(std::move(errors)));
    }
    rows.push_back(std::move(row));
    first += kNumbersOfPlanes;
  }
  return rows;
}

class VolumeStudy final : public Study {
 public:
  std::string name() const override { return "2.1"; }
  std::string title() const override { return "volume against the number of planes"; }

  int cases(const StudyOptions&) const override {
    return static_cast<int>(published_planimetry_rows().size()) * kNumbersOfPlanes;
  }

  std::string case_name(const StudyOptions&, int index) const override {
    const SimulateOptions scan = scan_of(index);
    return scan.object + " " + scan.pattern + ", " + std::to_string(scan.frames) + " planes";
  }

  Json run_case(const StudyOptions&, int index) const override {
    const ScanVolumes volumes = measure_scan(scan_of(index), true);
    Json by_name;
    for (std::size_t m = 0; m < kVolumeMethods.size(); ++m) {
      const auto& volume_ml = volumes.volume_ml[m];
      by_name[kVolumeMethods[m].name] = volume_ml ? Json(*volume_ml) : Json(nullptr);
    }
    return {{"true_ml", volumes.true_ml}, {"volume_ml", by_name}};
  }

  Json rows(const StudyOptions&, const std::vector<Json>& results) const override {
    Json json = Json::array();
    for (const VolumeRow& row : rows_of(results)) {
      const auto& methods = row.methods;
      json.push_back(
          {{"object", row.printed.object},
           {"pattern", row.printed.pattern},
           {"planes_below_1_percent",
            by_method(methods, [](const MethodAccuracy& m) { return json_of(m.planes_below_1_percent); })},
           {"first_below_1_percent",
            by_method(methods, [](const MethodAccuracy& m) { return json_of(m.first_below_1_percent); })},
           {"error_percent_at_20", by_method(methods, [](const MethodAccuracy& m) { return m.error_percent_at_20; })},
           {"rms_percent_17_to_20", by_method(methods, [](const MethodAccuracy& m) { return m.rms_percent_17_to_20; })},
           {"error_percent", by_method(methods, [](const MethodAccuracy& m) { return m.error_percent; })},
           {"published", published_json(row.printed)}});
    }
    return json;
  }

  StudyReport report(const StudyOptions&, const std::vector<Json>& results) const override {
    return volume_report(rows_of(results));
  }

 private:
  static SimulateOptions scan_of(int index) {
    const std::vector<PlanimetryRow> rows = published_planimetry_rows();
    const PlanimetryRow& row = rows.at(static_cast<std::size_t>(index / kNumbersOfPlanes));
    SimulateOptions scan;
    scan.object = row.object;
    scan.pattern = row.pattern;
    scan.frames = kFewestPlanes + index % kNumbersOfPlanes;
    return scan;
  }
};

}  // namespace

const Study& volume_study() {
  static const VolumeStudy study;
  return study;
}

}  // namespace fathom
