#include "sim/laboratory/gnuplot.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/numbers.h"
#include "core/text_file.h"

extern char** environ;

namespace fathom {

namespace {

constexpr int kCommandNotFound = 127;  // where posix_spawn finds out in the child

// Colours that are told apart on white, in print, and by most who confuse red and green (Okabe and Ito, less yellow).
constexpr std::array<const char*, 7> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#000000"};

// In single quotes nothing but the quote itself has a meaning, given `noenhanced`.
std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) {
    if (c == '\'') safe += '\'';
    safe += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return safe + "'";
}

bool has_bars(const StudySeries& series) {
  return !series.points.empty() && series.low.size() == series.points.size() &&
         series.high.size() == series.points.size();
}

std::string data_of(const StudySeries& series) {
  const bool bars = has_bars(series);
  std::string text;
  for (std::size_t i = 0; i < series.points.size(); ++i) {
    const auto [x, y] = series.points[i];
    if (!std::isfinite(x) || !std::isfinite(y)) {
      text += "\n";  // a gap in the line
      continue;
    }
    text += format_real(x) + " " + format_real(y);
    if (bars) text += " " + format_real(series.low[i]) + " " + format_real(series.high[i]);
    text += "\n";
  }
  return text;
}

// What is asked for; where all values are one but for rounding, what does not make mountains of it.
std::optional<std::pair<double, double>> y_range_of(const StudyPlot& plot) {
  if (plot.y_range) return plot.y_range;
  constexpr double kRounding = 1e-6;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const StudySeries& series : plot.series) {
    for (const double y : series.low) low = std::min(low, y);
    for (const double y : series.high) high = std::max(high, y);
    for (const auto& [x, y] : series.points) {
      if (!std::isfinite(y)) continue;
      low = std::min(low, y);
      high = std::max(high, y);
    }
  }
  if (low > high || high - low > kRounding * std::max(std::abs(low), std::abs(high))) return std::nullopt;
  return std::pair(low - std::max(1.0, std::abs(low)), high + std::max(1.0, std::abs(high)));
}

std::string script_of(const PlotFile& file) {
  const StudyPlot& plot = *file.plot;
  std::string script = "reset\nset grid lc rgb '#d0d0d0'\nset key below\nset xzeroaxis lc rgb '#606060'\n";
  script += "set output " + quoted(file.file.string()) + "\nset title " + quoted(plot.title) + "\nset xlabel " +
            quoted(plot.x_label) + " offset 0,0.4\nset ylabel " + quoted(plot.y_label) + "\n";
  if (const auto range = y_range_of(plot)) {
    script += "set yrange [" + format_real(range->first) + ":" + format_real(range->second) + "]\n";
  }
  std::string commands;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const StudySeries& series = plot.series[i];
    if (series.points.empty()) continue;
    const std::string name = "$series" + std::to_string(i);
    const std::string style = std::string(" lw 1.5 lc rgb '") + kColors[i % kColors.size()] + "'";
    script += name + " << END_OF_DATA\n" + data_of(series) + "END_OF_DATA\n";
    commands += commands.empty() ? "plot " : ", ";
    if (has_bars(series)) commands += name + " using 1:2:3:4 with yerrorbars pt -1" + style + " notitle, ";
    commands += name + " using 1:2 with linespoints pt " + std::to_string(i + 4) + " ps 0.6" + style + " title " +
                quoted(series.name);
  }
  // Without a point there is nothing to scale the axes by.
  return script + (commands.empty() ? "set xrange [0:1]\nset yrange [0:1]\nplot NaN notitle" : commands) +
         "\nunset output\n";
}

// Runs the program on a file; its status, or what posix_spawn says as a negative number.
int run_gnuplot(const std::string& script, const std::string& log) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  std::string name = "gnuplot";
  std::string defaults = "--default-settings";  // not the user's own
  std::string file = script;
  char* const arguments[] = {name.data(), defaults.data(), file.data(), nullptr};
  pid_t child = 0;
  const int fault = ::posix_spawnp(&child, name.c_str(), &actions, nullptr, arguments, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (fault != 0) return -fault;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : kCommandNotFound + 1;
}

}  // namespace

std::string draw_plots(const std::vector<PlotFile>& plots) {
  if (plots.empty()) return "";
  std::filesystem::path script = plots.front().file;
  script += ".gp";
  std::filesystem::path log = plots.front().file;
  log += ".log";
  std::string text =
      "set encoding utf8\nset terminal svg size 820,480 noenhanced font 'sans-serif,13' background '#ffffff'\n"
      "set datafile missing NaN\n";
  for (const PlotFile& plot : plots) text += script_of(plot);
  write_text_file(script, text);
  const int status = run_gnuplot(script.string(), log.string());
  std::error_code ignored;
  std::filesystem::remove(script, ignored);
  std::filesystem::remove(log, ignored);
  if (status == 0) return "";
  for (const PlotFile& plot : plots) std::filesystem::remove(plot.file, ignored);
  if (status == -ENOENT || status == kCommandNotFound) {
    return "there are no plots, as the program gnuplot is not installed; install it (Debian: gnuplot-nox) and make the "
           "page again by `fathom accuracy merge`";
  }
  return "there are no plots, as the program gnuplot failed (status " + std::to_string(status) +
         "); check its installation and make the page again by `fathom accuracy merge`";
}

}  // namespace fathom
