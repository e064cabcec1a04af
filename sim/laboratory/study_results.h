#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "sim/studies/study.h"

namespace fathom {

/// A part of a study: the cases whose number leaves `index` when divided by `count`.
struct Shard {
  int index = 0;
  int count = 1;

  bool holds(int number) const { return number % count == index; }
  bool whole() const { return count == 1; }
};

/// Shards are at most so many: more than any study has cases.
inline constexpr int kMostShards = 100000;
/// Repetitions of a case: more than this are typing errors.
inline constexpr int kMostSamples = 100000;

/// "0/3" is the first of three. Throws Error for anything else than two whole numbers, the first below the second.
Shard parse_shard(const std::string& text);

/// The results of some or all of a study's cases.
struct StudyResults {
  std::string version;  ///< of the program
  std::string build;    ///< which build of that version; parts of two builds are not merged
  std::string study;
  StudyOptions options;
  int cases = 0;  ///< of the whole study
  Shard shard;
  std::map<int, nlohmann::ordered_json> values;  ///< by the case's number
  std::string source;  ///< the file they were read from, for messages; empty when they were just made

  bool complete() const { return static_cast<int>(values.size()) == cases; }
};

/// "2.1.json", "2.1.shard-0-of-3.json".
std::string results_file_name(const StudyResults& results);

/// The text of a file of results (docs/accuracy.md). It depends on the results only, not on how they were come by.
std::string results_text(const StudyResults& results);

/// Throws Error when the file holds anything else than the results of every case of its shard, each once, of a study
/// that there is.
StudyResults read_results(const std::filesystem::path& file);

/// All parts of one study, at least one, as one run would have given them. Throws Error, naming the files, when they
/// are of different studies, versions, builds or options, when a case is in two of them, or when cases are missing.
StudyResults merged(const std::vector<StudyResults>& parts);

/// The values in the order of the cases, for Study::rows and Study::report. `results` are complete.
std::vector<nlohmann::ordered_json> values_in_order(const StudyResults& results);

}  // namespace fathom
