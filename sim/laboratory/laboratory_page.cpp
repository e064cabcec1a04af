#include "sim/laboratory/laboratory_page.h"

#include <algorithm>

#include "core/html.h"
#include "sim/laboratory/table_text.h"

namespace fathom {

namespace {

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Accuracy laboratory</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body { font: 15px/1.45 sans-serif; max-width: 72em; margin: 2em auto; padding: 0 1em; color: #111; background: #fff; }
h1, h2, h3 { line-height: 1.2; }
h2 { border-top: 2px solid #444; padding-top: 0.6em; margin-top: 2em; }
table { border-collapse: collapse; margin: 0.6em 0 1em; font-size: 13px; font-variant-numeric: tabular-nums; }
th, td { border: 1px solid #bbb; padding: 0.2em 0.5em; text-align: left; vertical-align: top; }
th { background: #eee; }
tr { break-inside: avoid; }
.wide { overflow-x: auto; }
.met { color: #06601c; font-weight: bold; }
.missed { color: #a00000; font-weight: bold; }
.note { border-left: 4px solid #a00000; padding-left: 0.6em; }
figure { display: inline-block; margin: 0.5em 1em 0.5em 0; break-inside: avoid; max-width: 100%; }
figure img { max-width: 100%; }
figcaption { font-size: 13px; }
@media print {
  body { margin: 0; max-width: none; font-size: 11px; }
  table { font-size: 8px; }
  .wide { overflow-x: visible; }
  h2 { break-before: page; }
  nav { display: none; }
}
</style>
)";

std::string made_of(const StudyResults& results) {
  return "Fathom " + results.version + ", " + std::to_string(results.cases) + " cases, samples " +
         std::to_string(results.options.samples) + ", seed " + std::to_string(results.options.seed);
}

// Twelve digits are enough to tell builds apart by eye.
std::string build_of(const StudyResults& results) {
  return results.build.empty() ? "" : ", build " + results.build.substr(0, 12);
}

std::string command_of(const StudyResults& results) {
  return "fathom accuracy --table " + results.study + " --samples " + std::to_string(results.options.samples) +
         " --seed " + std::to_string(results.options.seed) + " --out FOLDER";
}

std::size_t met_of(const StudyReport& report) {
  return static_cast<std::size_t>(
      std::count_if(report.goals.begin(), report.goals.end(), [](const StudyGoal& goal) { return goal.met; }));
}

std::string goals_html(const StudyReport& report) {
  if (report.goals.empty()) return "";
  std::string html =
      "<h3>Goals</h3>\n<div class=\"wide\"><table>\n<thead><tr><th>goal</th><th>wanted</th><th>measured</th>"
      "<th></th></tr></thead>\n<tbody>\n";
  for (const StudyGoal& goal : report.goals) {
    html += "<tr><td>" + html_text(goal.what) + "</td><td>" + html_text(goal.wanted) + "</td><td>" +
            html_text(goal.measured) + "</td><td class=\"" + (goal.met ? "met\">met" : "missed\">not met") +
            "</td></tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

// Of columns to be set to the right: " n3 n4".
std::string column_classes(const StudyTable& table) {
  std::string classes;
  const std::vector<bool> numbers = number_columns(table);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i]) classes += " n" + std::to_string(i + 1);
  }
  return classes;
}

std::string column_rules(const std::vector<PageStudy>& studies) {
  std::size_t most = 0;
  for (const PageStudy& study : studies) {
    for (const StudyTable& table : study.report.tables) most = std::max(most, table.columns.size());
  }
  std::string rules = "<style>\n";
  for (std::size_t i = 1; i <= most; ++i) {
    const std::string number = std::to_string(i);
    rules += ".n" + number + " td:nth-child(" + number + ") { text-align: right; white-space: nowrap; }\n";
  }
  return rules + "</style>\n";
}

std::string tables_html(const StudyReport& report) {
  std::string html;
  for (const StudyTable& table : report.tables) {
    std::vector<std::vector<std::string>> rows = {table.columns};
    rows.insert(rows.end(), table.rows.begin(), table.rows.end());
    html += "<h3>" + html_text(table.title) + "</h3>\n<div class=\"wide" + column_classes(table) + "\">" +
            html_table(rows) + "</div>\n";
    if (!table.remark.empty()) html += "<p>" + html_text(table.remark) + "</p>\n";
  }
  return html;
}

std::string images_html(const std::string& heading, const std::vector<PageImage>& images) {
  if (images.empty()) return "";
  std::string html = "<h3>" + heading + "</h3>\n";
  for (const PageImage& image : images) {
    html += "<figure>" + html_image(image.type, image.bytes, image.title) + "<figcaption>" + html_text(image.title) +
            "</figcaption></figure>\n";
  }
  return html;
}

std::string overview_html(const std::vector<PageStudy>& studies) {
  std::string html =
      "<table>\n<thead><tr><th>study</th><th></th><th>goals met</th><th>made by</th></tr></thead>\n<tbody>\n";
  for (const PageStudy& study : studies) {
    const std::size_t met = met_of(study.report);
    const std::size_t all = study.report.goals.size();
    const std::string& name = study.results.study;
    html += "<tr><td><a href=\"#study-" + html_text(name) + "\">" + html_text(name) + "</a></td><td>" +
            html_text(study.title) + "</td><td class=\"" + (met == all ? "met" : "missed") + "\">" +
            (all == 0 ? "" : std::to_string(met) + " of " + std::to_string(all)) + "</td><td>" +
            html_text(made_of(study.results) + build_of(study.results)) + "</td></tr>\n";
  }
  return html + "</tbody></table>\n";
}

}  // namespace

std::string laboratory_page(const std::vector<PageStudy>& studies, const std::vector<std::string>& notes) {
  std::string html = kHead + column_rules(studies);
  html +=
      "</head><body>\n<h1>Accuracy laboratory</h1>\n<p>Simulated scans of objects whose true volume, place or delay is "
      "known. Every "
      "number here comes again, to the byte, with the command below its study's name.</p>\n";
  for (const std::string& note : notes) html += "<p class=\"note\">" + html_text(note) + "</p>\n";
  html += overview_html(studies);
  for (const PageStudy& study : studies) {
    const std::string& name = study.results.study;
    html += "<section id=\"study-" + html_text(name) + "\">\n<h2>" + html_text(name + ": " + study.title) +
            "</h2>\n<p>" + html_text(made_of(study.results) + build_of(study.results)) + "</p>\n<p><code>" +
            html_text(command_of(study.results)) + "</code></p>\n" + goals_html(study.report) +
            tables_html(study.report) + images_html("Plots", study.plots) + images_html("Pictures", study.pictures) +
            "</section>\n";
  }
  return html + "</body></html>\n";
}

std::string laboratory_markdown(const std::vector<PageStudy>& studies, const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += "Note: " + note + "\n\n";
  for (const PageStudy& study : studies) {
    text += report_markdown(study.results.study + ": " + study.title, study.report, "##") + "\n" +
            made_of(study.results) + ":\n\n```text\n" + command_of(study.results) + "\n```\n\n";
  }
  return text;
}

}  // namespace fathom
