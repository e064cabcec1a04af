#pragma once

#include <string>

#include "core/progress.h"
#include "sim/laboratory/study_results.h"

namespace fathom {

/// How a study is run.
struct StudyRun {
  static constexpr int kMostThreads = 1024;

  std::string version;  ///< of the program, kept with the results
  std::string build;    ///< which build of that version, kept too
  StudyOptions options;
  Shard shard;      ///< runs only this part
  int threads = 1;  ///< cases at a time; the results do not depend on it

  /// Throws Error when a value is out of range.
  void check() const;
};

/// Runs the cases of a shard. `progress` is called from this thread only. Throws Error of the first case that failed,
/// with its name; Cancelled, once the cases that run have ended.
StudyResults run_study(const Study& study, const StudyRun& run, const Progress& progress = {});

}  // namespace fathom
