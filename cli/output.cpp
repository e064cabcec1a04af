#include "cli/output.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>

#include <unistd.h>

namespace fathom {

namespace {

volatile std::sig_atomic_t interrupted = 0;

constexpr int kBarColumns = 40;

// Characters, not bytes: UTF-8 continues a character by bytes of the form 10xxxxxx.
std::size_t columns_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

// The parts that volumes are sums of, where there are any.
void print_partitions(const std::vector<StructureResult>& results) {
  std::vector<std::vector<std::string>> rows{
      {"structure", "sweep", "sections", "linear (ml)", "cubic (ml)", "cubic 3D (ml)", "missing (ml)"}};
  for (const StructureResult& result : results) {
    for (const PartResult& part : result.partitions) {
      const PlanimetryVolumes& volumes = part.measurement.volumes;
      rows.push_back({result.name, std::to_string(part.sweep + 1), std::to_string(part.measurement.sections),
                      number_text(volumes.linear_ml, 2), number_text(volumes.cubic_ml, 2),
                      number_text(volumes.cubic_3d_ml, 2), number_text(part.missing_ml, 2)});
    }
  }
  if (rows.size() == 1) return;
  std::cout << "\n";
  print_table(rows);
}

// What the interval leaves open, and what would make it narrower.
void print_confidence(const StructureResult& result) {
  for (const MissingEnd& end : result.confidence.missing_ends) {
    std::cout << result.name << ": " << warning_of(end) << "\n";
  }
  const auto next = next_worth_outlining(result.confidence);
  if (!next) return;
  std::cout << result.name << ": outline frame " << next->frame << " next: the volume would be surer by about "
            << number_text(next->gain_ml, 2) << " ml\n";
}

}  // namespace

void print_json(const nlohmann::ordered_json& json) {
  // Names from files may hold bytes that are not UTF-8; they are replaced, so that the output is always JSON.
  std::cout << json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << "\n";
}

void print_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], columns_of(row[i]));
  }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string padding(widths[i] - columns_of(row[i]), ' ');
      line += (i == 0 ? "" : "  ") + (i == 0 ? row[i] + padding : padding + row[i]);
    }
    while (line.ends_with(' ')) line.pop_back();
    std::cout << line << "\n";
  }
}

std::string number_text(const std::optional<double>& value, int decimals) {
  if (!value) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, *value);
  return text;
}

void print_results(const std::vector<StructureResult>& results) {
  std::vector<std::vector<std::string>> rows{{"structure", "sections", "quadric (ml)", "95 % (ml)", "linear (ml)",
                                              "cubic (ml)", "cubic 3D (ml)", "surface (ml)", "surface curved (ml)"}};
  for (const StructureResult& result : results) {
    const PlanimetryVolumes& volumes = result.measurement.volumes;
    const auto& interval = result.confidence.interval;
    const std::string range =
        interval ? number_text(interval->low_ml, 2) + " to " + number_text(interval->high_ml, 2) : "-";
    rows.push_back({result.name, std::to_string(result.measurement.sections), number_text(volumes.quadric_ml, 2), range,
                    number_text(volumes.linear_ml, 2), number_text(volumes.cubic_ml, 2),
                    number_text(volumes.cubic_3d_ml, 2), number_text(result.surfaces.disc_guided_ml, 2),
                    number_text(result.surfaces.disc_guided_curved_ml, 2)});
  }
  print_table(rows);
  print_partitions(results);
  for (const StructureResult& result : results) {
    print_confidence(result);
    for (const std::string& warning : result.measurement.warnings) {
      std::cout << "warning: " << result.name << ": " << warning << "\n";
    }
  }
}

Progress progress_bar(const std::string& what) {
  const bool visible = ::isatty(STDERR_FILENO) != 0;
  return [what, visible, drawn = -1](double fraction) mutable {
    const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kBarColumns);
    if (visible && filled != drawn) {
      drawn = filled;
      const std::string bar = std::string(static_cast<std::size_t>(filled), '=') +
                              std::string(static_cast<std::size_t>(kBarColumns - filled), ' ');
      // The finished bar makes room for what the command prints.
      std::cerr << (filled == kBarColumns ? "\r\033[K" : "\r" + what + " [" + bar + "]") << std::flush;
    }
    return interrupted == 0;
  };
}

bool was_interrupted() { return interrupted != 0; }

void catch_interrupts() {
  // The second one ends the program at once: whoever asks twice has waited long enough.
  const auto note = [](int signal) {
    interrupted = 1;
    std::signal(signal, SIG_DFL);
  };
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  // A file that grows beyond what the user may write is an error to report, not a reason to die.
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace fathom
