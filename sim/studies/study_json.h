#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/random.h"
#include "sim/studies/study.h"

// What the results of cases are made of.
namespace fathom {

/// A figure that may not exist: null for what is not finite.
inline nlohmann::ordered_json number_json(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

/// Back again; NaN for null.
inline double number_of(const nlohmann::ordered_json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

/// How often a case is repeated: those that look at images, which take long, a tenth as often.
inline int repetitions(const StudyOptions& options, bool images) {
  return images ? std::max(1, options.samples / 10) : options.samples;
}

/// `{"runs": [...]}` of `run(seed)`, each with a seed of its own that follows from the case's.
template <typename Run>
nlohmann::ordered_json repeated(int runs, std::uint64_t seed, Run run) {
  Random seeds(seed);
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  for (int i = 0; i < runs; ++i) results.push_back(run(static_cast<std::uint64_t>(0x1p53 * seeds.uniform())));
  return {{"runs", std::move(results)}};
}

}  // namespace fathom
