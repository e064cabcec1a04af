#include "sim/laboratory/laboratory_folder.h"

#include <algorithm>
#include <fstream>
#include <utility>

#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/staged_folder.h"
#include "core/text_file.h"
#include "sim/laboratory/gnuplot.h"
#include "sim/laboratory/laboratory_page.h"
#include "sim/laboratory/table_text.h"

namespace fathom {

namespace {

constexpr const char* kPage = "index.html";
constexpr const char* kMarkdown = "results.md";

/// What a study makes of values, which may come from a file and be anything.
template <typename Make>
auto made_from(const StudyResults& results, Make make) {
  try {
    return make(study_of(results.study), values_in_order(results));
  } catch (const nlohmann::json::exception&) {
  } catch (const std::out_of_range&) {
  }
  throw Error((results.source.empty() ? "study " + results.study : results.source) +
              ": the values of its cases are not those of study " + results.study + "; run it again");
}

std::vector<unsigned char> bytes_of(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMostBytes = 64u << 20;
  const std::string text = read_text_file(file, kMostBytes);
  return {text.begin(), text.end()};
}

void write_bytes(const std::filesystem::path& file, const std::vector<unsigned char>& bytes) {
  write_text_file(file, std::string(bytes.begin(), bytes.end()));
}

void write_tables(const PageStudy& study, const std::filesystem::path& folder) {
  for (const StudyTable& table : study.report.tables) {
    const std::string stem = study.results.study + "." + table.name;
    write_text_file(folder / (stem + ".txt"), table_text(table));
    write_text_file(folder / (stem + ".csv"), table_csv(table));
  }
}

void write_pictures(PageStudy& study, const std::filesystem::path& folder) {
  for (const StudyPicture& picture : study.report.pictures) {
    PageImage image{picture.title, "image/png", {}};
    if (!cv::imencode(".png", picture.image, image.bytes)) {
      throw Error("study " + study.results.study + ": no PNG can be made of picture " + picture.name + "; try again");
    }
    write_bytes(folder / (study.results.study + "." + picture.name + ".png"), image.bytes);
    study.pictures.push_back(std::move(image));
  }
}

/// Returns why there are none; then those of an earlier run are `outdated`.
std::string write_plots(PageStudy& study, const std::filesystem::path& folder,
                        std::vector<std::filesystem::path>& outdated) {
  std::vector<PlotFile> files;
  for (const StudyPlot& plot : study.report.plots) {
    files.push_back({&plot, folder / (study.results.study + "." + plot.name + ".svg")});
  }
  std::string fault = draw_plots(files);
  if (!fault.empty()) {
    for (const PlotFile& file : files) outdated.push_back(file.file.filename());
    return fault;
  }
  for (const PlotFile& file : files) study.plots.push_back({file.plot->title, "image/svg+xml", bytes_of(file.file)});
  return "";
}

void add_once(std::vector<std::string>& notes, const std::string& note) {
  if (!note.empty() && std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
}

PageStudy written_study(const StudyResults& results, const std::filesystem::path& folder,
                        std::vector<std::string>& notes, std::vector<std::filesystem::path>& outdated) {
  PageStudy study;
  study.results = results;
  study.title = study_of(results.study).title();
  study.report = study_report(results);
  write_tables(study, folder);
  write_pictures(study, folder);
  add_once(notes, write_plots(study, folder, outdated));
  return study;
}

}  // namespace

nlohmann::ordered_json study_rows(const StudyResults& results) {
  return made_from(results,
                   [&](const Study& study, const auto& values) { return study.rows(results.options, values); });
}

StudyReport study_report(const StudyResults& results) {
  return made_from(results,
                   [&](const Study& study, const auto& values) { return study.report(results.options, values); });
}

void require_current(const StudyResults& results, const std::string& version) {
  const std::string file = results.source.empty() ? "study " + results.study : results.source;
  if (results.version != version) {
    throw Error(file + ": was made by version " + results.version + " of this program, which is " + version +
                "; use that version, or run the study again");
  }
  const int cases = study_of(results.study).cases(results.options);
  if (results.cases != cases) {
    throw Error(file + ": says that study " + results.study + " has " + std::to_string(results.cases) +
                " cases, but it has " + std::to_string(cases) + "; run it again");
  }
}

struct LaboratoryFolder::Parts {
  std::filesystem::path folder;
  std::string version;
  StagedFolder staged;
};

LaboratoryFolder::LaboratoryFolder(const std::filesystem::path& folder, std::string version)
    : parts_(new Parts{folder, std::move(version), StagedFolder(folder)}) {}

LaboratoryFolder::~LaboratoryFolder() = default;

std::vector<std::string> LaboratoryFolder::write(const std::vector<StudyResults>& results) {
  const std::filesystem::path& staging = parts_->staged.path();
  std::vector<std::string> notes;
  std::vector<std::string> page_notes;
  std::vector<PageStudy> studies;
  std::vector<std::filesystem::path> outdated;
  bool page = false;
  for (const StudyResults& one : results) {
    require_current(one, parts_->version);
    write_text_file(staging / results_file_name(one), results_text(one));
    page = page || one.complete();
  }
  for (const Study* study : all_studies()) {
    if (!page) break;  // a part changes nothing of it
    const auto found = std::find_if(results.begin(), results.end(), [&](const StudyResults& one) {
      return one.complete() && one.study == study->name();
    });
    if (found != results.end()) {
      studies.push_back(written_study(*found, staging, page_notes, outdated));
      continue;
    }
    // Made by an earlier run.
    const std::filesystem::path file = parts_->folder / (study->name() + ".json");
    if (!std::filesystem::exists(file)) continue;
    try {
      const StudyResults earlier = read_results(file);
      require_current(earlier, parts_->version);
      if (!earlier.complete()) throw Error(file.string() + ": is only a part of the study; merge it with the others");
      studies.push_back(written_study(earlier, staging, page_notes, outdated));
    } catch (const Error& error) {
      add_once(notes, "not on the page: " + std::string(error.what()));
    }
  }
  page_notes.insert(page_notes.end(), notes.begin(), notes.end());
  if (!studies.empty()) {
    write_text_file(staging / kMarkdown, laboratory_markdown(studies, page_notes));
    write_text_file(staging / kPage, laboratory_page(studies, page_notes));
  }
  parts_->staged.commit(kPage);
  std::error_code ignored;
  for (const auto& name : outdated) std::filesystem::remove(parts_->folder / name, ignored);
  return page_notes;
}

std::vector<std::filesystem::path> results_files(const std::vector<std::string>& names) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : names) {
    std::error_code code;
    if (!std::filesystem::is_directory(name, code)) {
      files.emplace_back(name);
      continue;
    }
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(name, code)) {
      if (entry.path().extension() == ".json") found.push_back(entry.path());
    }
    if (code) throw Error(name + ": cannot be read: " + code.message() + "; check its permissions");
    if (found.empty()) throw Error(name + ": holds no results (*.json); name a folder of `fathom accuracy --out`");
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

}  // namespace fathom
