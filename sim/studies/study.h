#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

namespace fathom {

/// What a user chooses for all studies of one run.
struct StudyOptions {
  int samples = 20;        ///< repetitions of a case where chance plays a part, at least 1
  std::uint64_t seed = 1;  ///< every case draws from streams made of this and the case's number
};

/// A table: `columns` heads and rows of as many cells each, written as they shall be read.
struct StudyTable {
  std::string name;  ///< of its files: letters, digits, '.', '-'; unique within a study
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  std::string remark;  ///< below the table: why a row is worse than published, what a column means
};

/// Points joined by a line; where `low` and `high` are given (as long as `points`), with bars from quartile to
/// quartile.
struct StudySeries {
  std::string name;
  std::vector<std::pair<double, double>> points;
  std::vector<double> low;
  std::vector<double> high;
};

struct StudyPlot {
  std::string name;  ///< of its file, as a table's
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<StudySeries> series;
  std::optional<std::pair<double, double>> y_range = std::nullopt;  ///< empty: all points are shown
};

/// A picture: an object, a sweep, an image with its outlines. CV_8UC1 or CV_8UC3 (blue, green, red).
struct StudyPicture {
  std::string name;  ///< of its file, as a table's
  std::string title;
  cv::Mat image;
};

/// A number that was aimed for, and what came of it.
struct StudyGoal {
  std::string what;
  std::string wanted;
  std::string measured;
  bool met = false;
};

/// All that a study has to show.
struct StudyReport {
  std::vector<StudyTable> tables;
  std::vector<StudyPlot> plots;
  std::vector<StudyPicture> pictures;
  std::vector<StudyGoal> goals;
};

/// A seed for a case's own random numbers, unlike that of every other case and of every other seed.
std::uint64_t case_seed(const StudyOptions& options, int index);

/// A named study: independent cases, and what is made of all their results.
///
/// A case's result is a JSON value that depends on the study's options and the case's number only: not on other cases,
/// on the order in which they run, on the number of threads or on the time. So cases can be spread over machines, and
/// their results joined are those of one run, to the byte. No figure of time belongs in it.
class Study {
 public:
  Study(const Study&) = delete;
  Study& operator=(const Study&) = delete;
  virtual ~Study() = default;

  [[nodiscard]] virtual std::string name() const = 0;  ///< as on the command line: "2.1", "bladder"
  [[nodiscard]] virtual std::string title() const = 0;
  [[nodiscard]] virtual int cases(const StudyOptions& options) const = 0;
  /// A few words about a case, for the bar and for errors: "cone fan, 12 planes".
  [[nodiscard]] virtual std::string case_name(const StudyOptions& options, int index) const = 0;
  /// May be called from several threads at once. A volume that cannot be had is null; anything else throws Error.
  [[nodiscard]] virtual nlohmann::ordered_json run_case(const StudyOptions& options, int index) const = 0;
  /// The rows of the JSON output, one object each, from all cases' results in their order. Here and in `report` results
  /// may come from a file that somebody changed: read them by `at` and `get`, which throw, not by [] of a constant.
  [[nodiscard]] virtual nlohmann::ordered_json rows(const StudyOptions& options,
                                                    const std::vector<nlohmann::ordered_json>& results) const = 0;
  [[nodiscard]] virtual StudyReport report(const StudyOptions& options,
                                           const std::vector<nlohmann::ordered_json>& results) const = 0;

 protected:
  Study() = default;
};

/// All studies, in the order of their names' first mention in the user guide.
const std::vector<const Study*>& all_studies();

/// Throws Error, listing the names there are.
const Study& study_of(const std::string& name);

}  // namespace fathom
