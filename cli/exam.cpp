#include <iostream>
#include <memory>

#include "cli/command.h"
#include "cli/exam_export.h"
#include "cli/output.h"
#include "core/error.h"
#include "exam/make_exam.h"

namespace fathom {

namespace {

struct ExamCommand {
  std::string folder;
  std::vector<std::string> recordings;
  std::string calibration;
  std::string contours;
  ExamParts parts;
  bool json = false;
};

void run(ExamCommand command, bool create) {
  ExamParts& parts = command.parts;
  parts.recordings.assign(command.recordings.begin(), command.recordings.end());
  parts.calibration = command.calibration;
  parts.contours = command.contours;
  const Progress progress = progress_bar("copying");
  const Exam exam =
      create ? create_exam(command.folder, parts, progress) : update_exam(read_exam(command.folder), parts, progress);
  if (command.json) {
    print_json(nlohmann::ordered_json::parse(exam_text(exam)));
    return;
  }
  std::cout << exam_json(exam).string() << ": " << exam.recordings.size()
            << (exam.recordings.size() == 1 ? " recording, " : " recordings, ")
            << (exam.calibration.empty() ? "no calibration, " : "calibration " + exam.calibration + ", ")
            << (exam.structures.empty() ? "no contours" : "contours " + exam.structures) << "\n";
}

void add(CLI::App& parent, const std::string& name, const std::string& about, bool create) {
  auto options = std::make_shared<ExamCommand>();
  CLI::App* command = parent.add_subcommand(name, about);
  command->add_option("EXAM", options->folder, "The exam's folder")->required();
  auto* recording = command
                        ->add_option("--recording", options->recordings,
                                     create ? "A recording; may be repeated" : "One more recording; may be repeated")
                        ->expected(1)
                        ->take_all();
  if (create) recording->required();
  command->add_option("--calibration", options->calibration, "The probe's calibration");
  command->add_option("--contours", options->contours, "The contours file");
  command->add_option("--patient", options->parts.patient, "Who was examined");
  command->add_option("--operator", options->parts.operator_name, "Who examined");
  command->add_option("--date", options->parts.date, "When");
  command->add_option("--notes", options->parts.notes, "What else is worth knowing");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, create] { run(*options, create); });
}

}  // namespace

void add_exam(CLI::App& app) {
  CLI::App* command = app.add_subcommand("exam", "Keep recordings, calibration, contours and results in one folder");
  command->require_subcommand(1);
  add(*command, "create", "Make an exam; files from elsewhere are copied into it", true);
  add(*command, "update", "Add recordings to an exam, or replace its calibration, contours and texts", false);
  add_exam_report(*command);
  add_exam_export(*command);
}

}  // namespace fathom
