#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/studies/study.h"

namespace fathom {

/// A plot to draw, and the SVG file to draw it to.
struct PlotFile {
  const StudyPlot* plot = nullptr;
  std::filesystem::path file;
};

/// Draws plots as SVG by the program gnuplot, which gets its script as a file beside them, through no shell. Returns
/// what the user must know when there are no plots, as gnuplot is not installed or fails; empty when all were drawn.
/// Throws Error when the script cannot be written.
std::string draw_plots(const std::vector<PlotFile>& plots);

}  // namespace fathom
