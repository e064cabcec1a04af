#include "exam/area_graph.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "core/html.h"
#include "core/numbers.h"

namespace fathom {

namespace {

// Of the drawing, in its own units, of which the page takes 96 for an inch.
constexpr double kWidth = 640.0;
constexpr double kHeight = 200.0;
constexpr double kLeft = 56.0;
constexpr double kRight = 620.0;
constexpr double kTop = 12.0;
constexpr double kBottom = 160.0;
constexpr int kMostTicks = 8;

// 1, 2 or 5 times a power of ten, so that few ticks reach from 0 to `largest`.
double tick_step(double largest) {
  const double rough = largest / kMostTicks;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * power) return factor * power;
  }
  return 10.0 * power;
}

struct Axis {
  double step;
  int ticks;  // behind 0
  double end;
  explicit Axis(double largest)
      : step(tick_step(largest)), ticks(static_cast<int>(std::ceil(largest / step - 1e-9))), end(step * ticks) {}

  std::string label(double value) const {
    return format_rounded(value, std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9))));
  }
};

std::string text(double x, double y, const char* anchor, const std::string& words, const std::string& more = {}) {
  return "<text x=\"" + format_rounded(x, 1) + "\" y=\"" + format_rounded(y, 1) + "\" text-anchor=\"" + anchor + "\"" +
         more + ">" + html_text(words) + "</text>\n";
}

std::string line(double x0, double y0, double x1, double y1, const char* color) {
  return "<path d=\"M" + format_rounded(x0, 1) + " " + format_rounded(y0, 1) + "L" + format_rounded(x1, 1) + " " +
         format_rounded(y1, 1) + "\" stroke=\"" + color + "\"/>\n";
}

struct Graph {
  Axis along;
  Axis area;

  double x(double along_mm) const { return kLeft + (kRight - kLeft) * along_mm / along.end; }
  double y(double area_cm2) const { return kBottom - (kBottom - kTop) * area_cm2 / area.end; }

  std::string axes() const {
    std::string svg;
    for (int i = 0; i <= area.ticks; ++i) {
      const double value = i * area.step;
      svg += line(kLeft, y(value), kRight, y(value), i == 0 ? "#444" : "#ddd");
      svg += text(kLeft - 6.0, y(value) + 4.0, "end", area.label(value));
    }
    for (int i = 0; i <= along.ticks; ++i) {
      const double value = i * along.step;
      svg += line(x(value), kBottom, x(value), kBottom + 4.0, "#444");
      svg += text(x(value), kBottom + 18.0, "middle", along.label(value));
    }
    svg += text(0.5 * (kLeft + kRight), kHeight - 4.0, "middle", "along the sweep (mm)");
    const double middle = 0.5 * (kTop + kBottom);
    return svg + text(14.0, middle, "middle", "area (cm\u00b2)",
                      " transform=\"rotate(-90 14 " + format_rounded(middle, 1) + ")\"");
  }

  std::string path(const std::vector<SectionRow>& rows) const {
    std::string d;
    for (const SectionRow& row : rows) {
      d += (d.empty() ? "M" : "L") + format_rounded(x(row.along_mm), 1) + " " + format_rounded(y(row.area_cm2), 1);
    }
    return d;
  }
};

}  // namespace

std::string area_graph_svg(std::span<const SectionRow> rows, const std::string& color) {
  std::map<std::size_t, std::vector<SectionRow>> sweeps;
  double farthest_mm = 0.0;
  double largest_cm2 = 0.0;
  for (const SectionRow& row : rows) {
    sweeps[row.sweep].push_back(row);
    farthest_mm = std::max(farthest_mm, row.along_mm);
    largest_cm2 = std::max(largest_cm2, row.area_cm2);
  }
  if (!(farthest_mm > 0.0) || !(largest_cm2 > 0.0)) return {};
  const Graph graph{Axis(farthest_mm), Axis(largest_cm2)};
  std::string svg = "<svg viewBox=\"0 0 " + format_rounded(kWidth, 0) + " " + format_rounded(kHeight, 0) +
                    "\" width=\"640\" height=\"200\" role=\"img\" font-size=\"11\" fill=\"#111\">\n"
                    "<title>Area along the sweep</title>\n" +
                    graph.axes();
  for (const auto& [sweep, sections] : sweeps) {
    const std::string path = graph.path(sections);
    if (sweeps.size() == 1) {
      svg += "<path d=\"" + path + "L" + format_rounded(graph.x(sections.back().along_mm), 1) + " " +
             format_rounded(kBottom, 1) + "L" + format_rounded(kLeft, 1) + " " + format_rounded(kBottom, 1) +
             "Z\" fill=\"" + html_text(color) + "\" fill-opacity=\"0.3\"/>\n";
    } else {
      const SectionRow& largest = *std::max_element(
          sections.begin(), sections.end(), [](const auto& a, const auto& b) { return a.area_cm2 < b.area_cm2; });
      svg += text(graph.x(largest.along_mm), graph.y(largest.area_cm2) + 16.0, "middle", std::to_string(sweep + 1));
    }
    svg += "<path d=\"" + path + "\" fill=\"none\" stroke=\"#222\" stroke-width=\"1.5\"/>\n";
    for (const SectionRow& row : sections) {
      svg += "<circle cx=\"" + format_rounded(graph.x(row.along_mm), 1) + "\" cy=\"" +
             format_rounded(graph.y(row.area_cm2), 1) + "\" r=\"2.2\"><title>frame " + std::to_string(row.frame) +
             "</title></circle>\n";
    }
  }
  return svg + "</svg>\n";
}

}  // namespace fathom
