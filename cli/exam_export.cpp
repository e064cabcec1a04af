#include "cli/exam_export.h"

#include <iostream>
#include <memory>

#include "cli/command.h"
#include "cli/image_area.h"
#include "cli/mesh_output.h"
#include "cli/output.h"
#include "core/error.h"
#include "core/text_file.h"
#include "exam/export_exam.h"

namespace fathom {

namespace {

struct ExportCommand {
  std::string exam;
  std::string out;
  ImageArea area;
  ExportOptions options;
  std::string mesh = "ply";
  bool json = false;
};

DocumentSnapshot open(const ExportCommand& command) {
  if (!is_exam(command.exam)) {
    throw Error(command.exam + ": is no exam; `fathom exam create` makes one");
  }
  DocumentOptions options;
  options.autosave = false;
  return Document(command.exam, options).snapshot();
}

ReportOptions report_options(const ExportCommand& command, const DocumentSnapshot& document) {
  ReportOptions options = command.options.report;
  options.program = "Fathom " FATHOM_VERSION;
  if (command.area.clip.empty() && command.area.sector.empty()) return options;
  const RecordingHeader& header = document.scan->recordings.front()->header();
  options.area = SafeArea{command.area.rectangle().value_or(cv::Rect(0, 0, header.width, header.height)), {}};
  if (!command.area.sector.empty() && !document.calibration.empty()) {
    options.area->fan = command.area.fan(read_calibration(document.calibration));
  }
  return options;
}

void run_report(const ExportCommand& command) {
  const DocumentSnapshot document = open(command);
  const ReportOptions options = report_options(command, document);
  const ReportContent content = report_content(document, progress_bar("measuring"));
  write_text_file(command.out, report_html(document, content, options));
  if (command.json) {
    print_json(results_json(results_to_show(document, content, options)));
  } else {
    std::cout << command.out << ": " << document.structures.size()
              << (document.structures.size() == 1 ? " structure\n" : " structures\n");
  }
}

void run_export(ExportCommand command) {
  const DocumentSnapshot document = open(command);
  command.options.report = report_options(command, document);
  command.options.mesh_extension = "." + command.mesh;
  const std::vector<std::string> names = export_exam(document, command.out, command.options, progress_bar("exporting"));
  if (command.json) {
    print_json({{"out", command.out}, {"files", names}});
    return;
  }
  std::cout << "written to " << command.out << ":";
  for (const std::string& name : names) std::cout << " " << name;
  std::cout << "\n";
}

void add_common(CLI::App& command, ExportCommand& options) {
  command.add_option("EXAM", options.exam, "The exam's folder")->required();
  command.add_flag("--anonymous", options.options.report.anonymous,
                   "Without patient, operator, date, notes and names of files; B-scans black outside of --clip and "
                   "--fan, and left out without these");
  add_image_area(command, options.area);
  command.add_flag("--json", options.json, "Print one JSON object");
}

}  // namespace

void add_exam_report(CLI::App& exam) {
  auto options = std::make_shared<ExportCommand>();
  CLI::App* command = exam.add_subcommand("report", "Measure, and write a report to print: one HTML file");
  add_common(*command, *options);
  command->add_option("--out", options->out, "The HTML file to write")->required();
  command->callback([options] { run_report(*options); });
}

void add_exam_export(CLI::App& exam) {
  auto options = std::make_shared<ExportCommand>();
  CLI::App* command =
      exam.add_subcommand("export", "Measure, and write results, surfaces, pictures and report into a folder");
  add_common(*command, *options);
  command->add_option("--out", options->out, "The folder to write to")->required();
  command->add_option("--mesh", options->mesh, "Kind of the surfaces' files")
      ->check(CLI::IsMember({"ply", "stl", "obj", "off", "wrl"}))
      ->capture_default_str();
  command->add_flag("--recordings", options->options.recordings,
                    "A copy of the exam as well; an anonymous one needs --clip or --fan");
  command->callback([options] { run_export(*options); });
}

}  // namespace fathom
