#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "segmentation/seeds.h"

namespace fathom {

/// Seeds as typed and those of a file.
struct SeedInput {
  std::vector<std::vector<double>> typed;  ///< frame, x, y
  std::string file;

  /// Throws CLI::RequiredError where there are none, CLI::ValidationError where what is typed has no frame; Error as
  /// `read_seeds`.
  std::vector<FrameSeeds> read() const;

  /// Throws as `read`, and Error when seeds stand on another recording than the first `count`.
  void require_recordings(std::size_t count) const;
};

/// Adds `--seed` and `--seeds`.
void add_seeds(CLI::App& command, SeedInput& seeds, const std::string& group);

}  // namespace fathom
