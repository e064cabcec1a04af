#include "exam/confidence.h"

#include <nlohmann/json.hpp>

#include "measurement/calibration_spread.h"
#include "measurement/planimetry.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kWorthAsking = 1e-3;  // of the volume: less is not worth a stroke

Json number_or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

}  // namespace

Confidence confidence(const Structure& structure, std::span<const CrossSection> sections, const Recording& recording,
                      const FrameLocator& locator, const ConfidenceOptions& options, const Progress& progress) {
  Confidence result;
  if (!measure_planimetry(sections).volumes.quadric_ml) return result;
  const auto calibration_ml = calibration_spread_ml(structure, recording, options.calibration, options.names, progress);
  result.interval = volume_interval(sections, section_places(structure, sections, locator, options.calibration),
                                    options.errors, calibration_ml.value_or(0.0));
  result.next = where_next(sections, locator);
  result.missing_ends = missing_ends(sections, structure.absent, locator);
  return result;
}

std::optional<NextOutline> next_worth_outlining(const Confidence& confidence) {
  const auto& [interval, next, ends] = confidence;
  if (!next || !interval || next->gain_ml < kWorthAsking * interval->high_ml) return std::nullopt;
  return next;
}

void add_confidence(const Confidence& confidence, Json& item) {
  const auto& interval = confidence.interval;
  item["volume_interval_ml"] = interval ? Json{interval->low_ml, interval->high_ml} : Json(nullptr);
  item["volume_interval_parts_ml"] = nullptr;
  if (interval) {
    item["volume_interval_parts_ml"] = {{"spacing", interval->spacing_ml},
                                        {"outlining", interval->outlining_ml},
                                        {"tracker", interval->tracker_ml},
                                        {"calibration", interval->calibration_ml}};
  }
  item["where_next"] = nullptr;
  if (const auto& next = confidence.next) {
    item["where_next"] = {{"frame", next->frame}, {"uncertain_ml", next->now_ml}, {"gain_ml", next->gain_ml}};
  }
  item["missing_ends"] = Json::array();
  for (const MissingEnd& end : confidence.missing_ends) {
    Json entry = {{"frame", end.frame},
                  {"end", end.first ? "first" : "last"},
                  {"volume_ml", number_or_null(end.volume_ml)},
                  {"interval_ml", nullptr}};
    if (end.volume_ml) entry["interval_ml"] = {0.0, end.high_ml};
    item["missing_ends"].push_back(std::move(entry));
  }
}

}  // namespace fathom
