#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "cli/build_id.h"
#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/error.h"
#include "sim/laboratory/laboratory_folder.h"
#include "sim/laboratory/study_run.h"
#include "sim/laboratory/table_text.h"

namespace fathom {

namespace {

struct AccuracyCommand {
  std::vector<std::string> tables;
  bool all = false;
  std::string shard;
  StudyRun run;
  std::vector<std::string> files;
  std::string out;
  bool json = false;
};

std::vector<const Study*> chosen(const AccuracyCommand& command) {
  if (command.all) return all_studies();
  std::vector<const Study*> studies;
  for (const std::string& name : command.tables) {
    const Study* study = &study_of(name);
    if (std::find(studies.begin(), studies.end(), study) == studies.end()) studies.push_back(study);
  }
  return studies;
}

nlohmann::ordered_json goals_json(const StudyReport& report) {
  auto goals = nlohmann::ordered_json::array();
  for (const StudyGoal& goal : report.goals) {
    goals.push_back({{"goal", goal.what}, {"wanted", goal.wanted}, {"measured", goal.measured}, {"met", goal.met}});
  }
  return goals;
}

// With several studies every row says of which it is.
void print_as_json(const std::vector<StudyResults>& results) {
  nlohmann::ordered_json json;
  json["rows"] = nlohmann::ordered_json::array();
  json["studies"] = nlohmann::ordered_json::array();
  for (const StudyResults& one : results) {
    nlohmann::ordered_json item = {{"study", one.study},
                                   {"version", one.version},
                                   {"build", one.build},
                                   {"samples", one.options.samples},
                                   {"seed", one.options.seed},
                                   {"cases", one.cases},
                                   {"shard", {one.shard.index, one.shard.count}},
                                   {"cases_run", one.values.size()}};
    if (one.complete()) {
      item["goals"] = goals_json(study_report(one));
      for (nlohmann::ordered_json& row : study_rows(one)) {
        nlohmann::ordered_json named;
        if (results.size() > 1) named["study"] = one.study;
        named.update(row);
        json["rows"].push_back(std::move(named));
      }
    }
    json["studies"].push_back(std::move(item));
  }
  print_json(json);
}

void print_as_text(const std::vector<StudyResults>& results) {
  for (const StudyResults& one : results) {
    if (one.complete()) {
      const std::string title = one.study + ": " + study_of(one.study).title();
      std::cout << report_markdown(title, study_report(one), "#") << "\n";
    } else {
      std::cout << one.study << ": " << one.values.size() << " of " << one.cases << " cases, in "
                << results_file_name(one) << "; join all parts by `fathom accuracy merge`\n";
    }
  }
}

void show(const AccuracyCommand& command, const std::vector<StudyResults>& results, LaboratoryFolder* folder) {
  std::vector<std::string> notes;
  if (folder != nullptr) notes = folder->write(results);
  command.json ? print_as_json(results) : print_as_text(results);
  for (const std::string& note : notes) std::cerr << "fathom: note: " << note << "\n";
}

void run(AccuracyCommand& command) {
  if (!command.shard.empty()) command.run.shard = parse_shard(command.shard);
  command.run.version = FATHOM_VERSION;
  command.run.build = build_id();
  command.run.check();
  const std::vector<const Study*> studies = chosen(command);
  std::unique_ptr<LaboratoryFolder> folder;
  if (!command.out.empty()) folder = std::make_unique<LaboratoryFolder>(command.out, command.run.version);
  // Studies differ, but their numbers of cases are all that is known of how long they take.
  double all = 0.0;
  for (const Study* study : studies) all += study->cases(command.run.options);
  const Progress bar = progress_bar("measuring");
  std::vector<StudyResults> results;
  double done = 0.0;
  for (const Study* study : studies) {
    const double next = done + study->cases(command.run.options);
    results.push_back(run_study(*study, command.run, part_of(bar, done / all, next / all)));
    done = next;
  }
  show(command, results, folder.get());
}

void merge(const AccuracyCommand& command) {
  LaboratoryFolder folder(command.out, FATHOM_VERSION);
  std::map<std::string, std::vector<StudyResults>> parts;
  for (const std::filesystem::path& file : results_files(command.files)) {
    StudyResults part = read_results(file);
    require_current(part, FATHOM_VERSION);
    parts[part.study].push_back(std::move(part));
  }
  std::vector<StudyResults> results;
  for (const Study* study : all_studies()) {
    const auto found = parts.find(study->name());
    if (found == parts.end()) continue;
    // One file alone keeps its name, for messages.
    const std::string source = found->second.size() == 1 ? found->second.front().source : "";
    results.push_back(merged(found->second));
    results.back().source = source;
  }
  show(command, results, &folder);
}

void list(const AccuracyCommand& command) {
  std::vector<std::vector<std::string>> rows{{"study", "cases", "title"}};
  auto json = nlohmann::ordered_json::array();
  for (const Study* study : all_studies()) {
    const int cases = study->cases(command.run.options);
    rows.push_back({study->name(), std::to_string(cases), study->title()});
    json.push_back({{"study", study->name()}, {"title", study->title()}, {"cases", cases}});
  }
  command.json ? print_json({{"studies", json}}) : print_table(rows);
}

/// Accepts what `read` does not throw Error for.
CLI::Validator accepted_by(void (*read)(const std::string&), const std::string& form) {
  return CLI::Validator(
      [read](std::string& text) {
        try {
          read(text);
          return std::string();
        } catch (const Error& error) {
          return std::string(error.what());
        }
      },
      form);
}

void add_merge(CLI::App& accuracy) {
  auto options = std::make_shared<AccuracyCommand>();
  CLI::App* command = accuracy.add_subcommand("merge", "Join the parts of studies that were run in shards");
  command->add_option("results", options->files, "Files of results, or folders with them")->required();
  command->add_option("--out", options->out, "The folder to write, as that of a run")->required();
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { merge(*options); });
}

void add_list(CLI::App& accuracy) {
  auto options = std::make_shared<AccuracyCommand>();
  CLI::App* command = accuracy.add_subcommand("list", "The studies that there are");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { list(*options); });
}

}  // namespace

void add_accuracy(CLI::App& app) {
  auto options = std::make_shared<AccuracyCommand>();
  options->run.threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, StudyRun::kMostThreads);
  CLI::App* command = app.add_subcommand("accuracy", "Measure simulated scans of known truth: studies of accuracy");
  command->require_subcommand(0, 1);
  CLI::Option* tables = command->add_option("--table", options->tables, "A study; may be repeated (see `list`)")
                            ->expected(1)
                            ->take_all()
                            ->check(accepted_by([](const std::string& text) { study_of(text); }, "STUDY"));
  CLI::Option* all = command->add_flag("--all", options->all, "All studies")->excludes(tables);
  StudyRun& study_run = options->run;
  command->add_option("--samples", study_run.options.samples, "Repetitions of a case where chance plays a part")
      ->check(CLI::Range(1, kMostSamples))
      ->capture_default_str();
  command->add_option("--seed", study_run.options.seed, "Seed of all random numbers")
      ->check(whole_number())
      ->capture_default_str();
  CLI::Option* out = command->add_option("--out", options->out, "The folder to write: results, tables, plots, a page");
  command->add_option("--shard", options->shard, "Run only the part I of N, as I/N with I from 0; then `merge`")
      ->needs(out)
      ->check(accepted_by([](const std::string& text) { parse_shard(text); }, "I/N"));
  command->add_option("--threads", study_run.threads, "Cases at a time; the results do not depend on it")
      ->check(CLI::Range(1, StudyRun::kMostThreads))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print one JSON object");
  add_list(*command);
  add_merge(*command);
  command->callback([options, command, tables, all] {
    if (!command->get_subcommands().empty()) return;
    if (tables->count() == 0 && all->count() == 0) {
      throw CLI::RequiredError("--table STUDY or --all");
    }
    run(*options);
  });
}

}  // namespace fathom
