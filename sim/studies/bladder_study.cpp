#include "sim/studies/bladder_study.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include "sim/studies/planimetry_study.h"
#include "sim/studies/study_json.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kSamplesPerPatient = 5;
constexpr int kScans = static_cast<int>(kBladderScans_min.size());
constexpr std::array<const char*, 2> kOutlines = {"true_outlines", "assisted"};

int patients_of(const StudyOptions& options) { return std::max(1, options.samples / kSamplesPerPatient); }

// Patients have seeds before those of all scans.
BladderPatient patient_of(const StudyOptions& options, int patient) {
  return BladderPatient(case_seed(options, patient));
}

std::uint64_t scan_seed(const StudyOptions& options, int index) {
  return case_seed(options, patients_of(options) + index);
}

Json volumes_json(const std::vector<std::optional<double>>& volumes_ml) {
  Json json;
  for (std::size_t m = 0; m < kBladderMethods.size(); ++m) {
    json[kVolumeMethods[kBladderMethods[m]].name] = volumes_ml[m] ? Json(*volumes_ml[m]) : Json(nullptr);
  }
  return json;
}

std::vector<BladderResults> results_of(const StudyOptions& options, const std::vector<Json>& results) {
  std::vector<BladderResults> patients;
  for (int patient = 0; patient < patients_of(options); ++patient) {
    BladderResults all{patient_of(options, patient), {}, {}, 0.0, 0.0};
    for (int scan = 0; scan < kScans; ++scan) {
      const Json& value = results.at(static_cast<std::size_t>(patient * kScans + scan));
      all.true_ml.push_back(value.at("true_ml").get<double>());
      all.clicks += value.at("clicks").get<double>() / kScans;
      all.dice += value.at("dice").get<double>() / kScans;
      for (std::size_t o = 0; o < kOutlines.size(); ++o) {
        for (std::size_t m = 0; m < kBladderMethods.size(); ++m) {
          const char* method = kVolumeMethods[kBladderMethods[m]].name;
          all.volume_ml[o][m].push_back(number_of(value.at(kOutlines[o]).at(method)));
        }
      }
    }
    patients.push_back(std::move(all));
  }
  return patients;
}

class BladderStudy final : public Study {
 public:
  std::string name() const override { return "bladder"; }
  std::string title() const override { return "volumes of a bladder that is emptied in parts"; }
  int cases(const StudyOptions& options) const override { return patients_of(options) * kScans; }

  std::string case_name(const StudyOptions&, int index) const override {
    return "patient " + std::to_string(index / kScans + 1) + ", scan " + std::to_string(index % kScans + 1);
  }

  Json run_case(const StudyOptions& options, int index) const override {
    const BladderScan scan = scan_bladder(patient_of(options, index / kScans), static_cast<std::size_t>(index % kScans),
                                          scan_seed(options, index));
    std::vector<OutliningTrial> trials;
    const Structure assisted = assisted_outlines(scan, &trials);
    double clicks = 0.0;
    double dice = 0.0;
    for (const OutliningTrial& trial : trials) {
      clicks += trial.clicks / static_cast<double>(trials.size());
      dice += trial.dice / static_cast<double>(trials.size());
    }
    return {{"true_ml", scan.scan.truth.volume_ml},
            {"outlines", trials.size()},
            {"clicks", clicks},
            {"dice", dice},
            {kOutlines[0], volumes_json(bladder_volumes_ml(scan, scan.true_outlines))},
            {kOutlines[1], volumes_json(bladder_volumes_ml(scan, assisted))}};
  }

  Json rows(const StudyOptions& options, const std::vector<Json>& results) const override {
    Json json = Json::array();
    const std::vector<BladderResults> patients = results_of(options, results);
    for (std::size_t p = 0; p < patients.size(); ++p) {
      for (std::size_t m = 0; m < kBladderMethods.size(); ++m) {
        const VoidingExperiment experiment = evaluate_voiding(patients[p].patient, patients[p].volume_ml[1][m]);
        for (std::size_t i = 0; i < kBladderVoids; ++i) {
          json.push_back({{"patient", p + 1},
                          {"void", i + 1},
                          {"method", kVolumeMethods[kBladderMethods[m]].name},
                          {"voided_ml", patients[p].patient.voided_ml(i)},
                          {"measured_void_ml", patients[p].patient.measured_void_ml(i)},
                          {"difference_ml", experiment.estimated_ml[i]},
                          {"difference_filling_known_ml", experiment.known_ml[i]}});
        }
      }
    }
    return json;
  }

  StudyReport report(const StudyOptions& options, const std::vector<Json>& results) const override {
    return bladder_report(results_of(options, results));
  }
};

/// The integral from each knot to the next of the natural cubic spline through values at knots.
template <std::size_t n>
std::array<double, n - 1> spline_integrals(const std::array<double, n>& knots, const std::array<double, n>& values) {
  constexpr int kSize = static_cast<int>(n);
  Eigen::Matrix<double, kSize, kSize> system = Eigen::Matrix<double, kSize, kSize>::Identity();
  Eigen::Matrix<double, kSize, 1> right = Eigen::Matrix<double, kSize, 1>::Zero();
  const auto step = [&](int i) { return knots[static_cast<std::size_t>(i) + 1] - knots[static_cast<std::size_t>(i)]; };
  const auto slope = [&](int i) {
    return (values[static_cast<std::size_t>(i) + 1] - values[static_cast<std::size_t>(i)]) / step(i);
  };
  for (int i = 1; i + 1 < kSize; ++i) {
    system(i, i - 1) = step(i - 1);
    system(i, i) = 2.0 * (step(i - 1) + step(i));
    system(i, i + 1) = step(i);
    right[i] = 6.0 * (slope(i) - slope(i - 1));
  }
  const Eigen::Matrix<double, kSize, 1> bends = system.partialPivLu().solve(right);  // second derivatives
  std::array<double, n - 1> integrals{};
  for (int i = 0; i + 1 < kSize; ++i) {
    const auto k = static_cast<std::size_t>(i);
    integrals[k] =
        step(i) * (values[k] + values[k + 1]) / 2.0 - std::pow(step(i), 3) * (bends[i] + bends[i + 1]) / 24.0;
  }
  return integrals;
}

}  // namespace

VoidingExperiment evaluate_voiding(const BladderPatient& patient, std::vector<double> measured_ml) {
  VoidingExperiment experiment;
  std::array<double, kBladderPairs> times{};
  std::array<double, kBladderPairs> means{};
  for (std::size_t i = 0; i < kBladderPairs; ++i) {
    const double between_min = kBladderScans_min[2 * i + 1] - kBladderScans_min[2 * i];
    times[i] = pair_time_min(i);
    means[i] = (measured_ml.at(2 * i) + measured_ml.at(2 * i + 1)) / 2.0;
    experiment.rate[i] = (measured_ml.at(2 * i + 1) - measured_ml.at(2 * i)) / between_min;
  }
  const auto filled_ml = spline_integrals(times, experiment.rate);
  for (std::size_t i = 0; i < kBladderVoids; ++i) {
    const double fell_ml = means[i] - means[i + 1];
    experiment.estimated_ml[i] = fell_ml + filled_ml[i];
    // What fills it within a pair is half of it in the mean, up to the swing of the rate, which is far below 0.1 ml.
    experiment.known_ml[i] = fell_ml + patient.filled_ml(times[i], times[i + 1]);
  }
  experiment.measured_ml = std::move(measured_ml);
  return experiment;
}

Regression regression_of(const std::vector<std::pair<double, double>>& points) {
  double mean_x = 0.0;
  double mean_y = 0.0;
  const double n = static_cast<double>(points.size());
  for (const auto& [x, y] : points) {
    mean_x += x / n;
    mean_y += y / n;
  }
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const auto& [x, y] : points) {
    xx += (x - mean_x) * (x - mean_x);
    xy += (x - mean_x) * (y - mean_y);
    yy += (y - mean_y) * (y - mean_y);
  }
  Regression regression;
  regression.slope = xy / xx;
  regression.intercept = mean_y - regression.slope * mean_x;
  regression.r = xy / std::sqrt(xx * yy);
  return regression;
}

const Study& bladder_study() {
  static const BladderStudy study;
  return study;
}

}  // namespace fathom
