#pragma once

#include <filesystem>

namespace fathom {

/// A set of files that appear together or not at all. They are made in a temporary folder beside the target;
/// `commit` moves them into the target, replacing files of the same names and leaving others alone. Without a commit
/// the destructor removes them.
class StagedFolder {
 public:
  /// Throws Error when no folder can be made beside `target`, or when `target` exists and is no folder.
  explicit StagedFolder(const std::filesystem::path& target);
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  /// Where to write the files.
  const std::filesystem::path& path() const { return staging_; }

  /// The file `last`, where it is one of them, is moved after all others, as it names them. Throws Error when the
  /// target cannot be made or written to.
  void commit(const std::filesystem::path& last = {});

 private:
  std::filesystem::path target_;
  std::filesystem::path staging_;
};

}  // namespace fathom
