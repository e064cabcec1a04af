#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "exam/edit.h"
#include "exam/history.h"

namespace fathom {

/// What can be undone, as it is kept beside an exam.
struct SavedHistory {
  std::vector<History::Item> edits;
  std::size_t done = 0;            ///< how many of them are done; the rest were undone
  std::vector<std::uint64_t> ids;  ///< of the structures, which the edits name
};

/// The text of a history file for this content. Of a long history the newest edits, to 24 MB of memory, are kept.
std::string history_json(const History& history, const ExamContent& content);

/// Reads such a file and checks it against the content that it should belong to, by undoing and doing everything on a
/// copy. `frame_counts` are those of the recordings. Throws Error where it is damaged, of a newer version or does not
/// fit, also where another program changed the exam.
SavedHistory read_history(const std::filesystem::path& path, const ExamContent& content,
                          const std::vector<int>& frame_counts);

/// Throws Error, naming `file`, when an edit stands on recordings or frames that there are not.
void require_frames(const Edit& edit, const std::vector<int>& frame_counts, const std::string& file);

/// Whether names differ and marks exclude each other as they must in a file.
bool could_be_saved(const ExamContent& content);

}  // namespace fathom
