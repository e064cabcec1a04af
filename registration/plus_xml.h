#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

namespace fathom {

/// The 4x4 matrix of the transform `from` -> `to` in a PLUS configuration or result file, given as its text. Only
/// `Transform` elements directly under a `CoordinateDefinitions` or `CalibrationResults` count. `file` is for
/// messages. Empty where there is none. Throws Error when the XML is damaged, or when the transform stands twice with
/// different numbers or has not 16 finite numbers.
std::optional<Eigen::Matrix4d> plus_transform(const std::string& xml, const std::string& from, const std::string& to,
                                              const std::string& file);

}  // namespace fathom
