#include "cli/live_verdict.h"

#include <iostream>
#include <numbers>

#include "cli/options.h"
#include "cli/output.h"
#include "core/error.h"
#include "registration/judge_folder.h"

namespace fathom {

namespace {

nlohmann::ordered_json or_null(const auto& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

std::string yes_or_no(const std::optional<bool>& value) { return !value ? "-" : *value ? "yes" : "no"; }

}  // namespace

void add_verdict_input(CLI::App& command, VerdictInput& input) {
  command.add_option("--calibration", input.calibration,
                     "The probe's, for the verdict on the sweep: Fathom's JSON, or a PLUS XML");
  command
      .add_option("--region", input.region,
                  "What the sweep shall pass on both sides: a box x0,y0,z0,x1,y1,z1 in reference coordinates, mm")
      ->delimiter(',')
      ->expected(6)
      ->check(finite());
  command
      .add_option("--max-step-mm", input.options.max_step_mm,
                  "A longer way of an image's corner from frame to frame is too fast")
      ->check(above(0))
      ->capture_default_str();
  add_frame_names(command, input.names);
}

std::optional<Calibration> calibration_of(const VerdictInput& input) {
  if (!input.region.empty() && input.calibration.empty()) throw CLI::RequiredError("--calibration (for --region)");
  if (input.calibration.empty()) return std::nullopt;
  return read_calibration(input.calibration, input.names.probe);
}

SweepVerdict verdict_on(const std::filesystem::path& folder, const VerdictInput& input,
                        const std::optional<Calibration>& calibration) {
  VerdictOptions options = input.options;
  if (!input.region.empty()) {
    options.region_mm.emplace();
    options.region_mm->extend(Eigen::Vector3d::Map(input.region.data()));
    options.region_mm->extend(Eigen::Vector3d::Map(input.region.data() + 3));
  }
  return judge_folder(folder, calibration ? &*calibration : nullptr, input.names, options);
}

nlohmann::ordered_json verdict_json(const SweepVerdict& verdict) {
  nlohmann::ordered_json json{{"good", verdict.good()},
                              {"valid_frames", verdict.valid_frames},
                              {"gaps", verdict.gaps},
                              {"longest_gap_s", verdict.longest_gap_s},
                              {"dropouts", verdict.dropouts},
                              {"longest_dropout_s", verdict.longest_dropout_s},
                              {"too_fast", verdict.too_fast},
                              {"largest_step_mm", or_null(verdict.largest_step_mm)},
                              {"speed_mm_s", or_null(verdict.speed_mm_s)}};
  json["jitter_mm"] = nullptr;
  json["jitter_deg"] = nullptr;
  json["still_s"] = nullptr;
  if (verdict.jitter) {
    json["jitter_mm"] = verdict.jitter->position_mm;
    json["jitter_deg"] = verdict.jitter->angle_deg;
    json["still_s"] = verdict.jitter->still_s;
  }
  json["passes_start"] = or_null(verdict.passes_start);
  json["passes_end"] = or_null(verdict.passes_end);
  json["warnings"] = verdict.warnings;
  return json;
}

void print_verdict(const SweepVerdict& verdict) {
  std::cout << "verdict: " << (verdict.good() ? "good" : "look at the warnings below") << "\n";
  const auto jitter = [&](double TrackerJitter::*member) {
    return number_text(verdict.jitter ? std::optional((*verdict.jitter).*member) : std::nullopt, 2);
  };
  print_table({{"valid frames", std::to_string(verdict.valid_frames) + " of " + std::to_string(verdict.frames)},
               {"gaps", std::to_string(verdict.gaps)},
               {"dropouts", std::to_string(verdict.dropouts)},
               {"steps that are too long", std::to_string(verdict.too_fast)},
               {"largest step (mm)", number_text(verdict.largest_step_mm, 2)},
               {"speed (mm/s)", number_text(verdict.speed_mm_s, 1)},
               {"jitter while still (mm)", jitter(&TrackerJitter::position_mm)},
               {"jitter while still (degrees)", jitter(&TrackerJitter::angle_deg)},
               {"passes the region's start", yes_or_no(verdict.passes_start)},
               {"passes the region's end", yes_or_no(verdict.passes_end)}});
  for (const std::string& warning : verdict.warnings) std::cout << "warning: " << warning << "\n";
}

nlohmann::ordered_json shape_json(const std::optional<ImageShape>& shape) {
  if (!shape) return nullptr;
  const cv::Rect& box = shape->box;
  nlohmann::ordered_json json{{"box_px", {box.x, box.y, box.width, box.height}}, {"fan", nullptr}};
  if (const auto& fan = shape->fan) {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    json["fan"] = {fan->origin_px.x(),
                   fan->origin_px.y(),
                   fan->min_radius_px,
                   fan->max_radius_px,
                   kDegrees * fan->min_angle_rad,
                   kDegrees * fan->max_angle_rad};
  }
  return json;
}

std::string shape_text(const std::optional<ImageShape>& shape) {
  if (!shape) return "not found: too little moved in it";
  const cv::Rect& box = shape->box;
  return (shape->fan ? "a fan within " : "a rectangle of ") + std::to_string(box.width) + " x " +
         std::to_string(box.height) + " pixels at " + std::to_string(box.x) + ", " + std::to_string(box.y);
}

}  // namespace fathom
