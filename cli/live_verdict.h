#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "registration/calibration.h"
#include "registration/image_shape.h"
#include "registration/pose_chain.h"
#include "registration/sweep_verdict.h"

namespace fathom {

/// What a verdict on a sweep needs, as typed.
struct VerdictInput {
  std::string calibration;
  std::vector<double> region;  ///< x0, y0, z0, x1, y1, z1, mm
  FrameNames names;
  VerdictOptions options;
};

/// Adds `--calibration`, `--region`, `--max-step-mm`, `--probe-frame` and `--reference-frame`.
void add_verdict_input(CLI::App& command, VerdictInput& input);

/// Empty where none was given. Throws Error as read_calibration.
std::optional<Calibration> calibration_of(const VerdictInput& input);

/// On a recording folder that is finished.
SweepVerdict verdict_on(const std::filesystem::path& folder, const VerdictInput& input,
                        const std::optional<Calibration>& calibration);

nlohmann::ordered_json verdict_json(const SweepVerdict& verdict);
void print_verdict(const SweepVerdict& verdict);

/// What was found of the images' shape: the box in pixels, and the fan as `--fan` of other commands takes it.
nlohmann::ordered_json shape_json(const std::optional<ImageShape>& shape);
std::string shape_text(const std::optional<ImageShape>& shape);

}  // namespace fathom
