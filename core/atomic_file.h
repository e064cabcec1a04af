#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace fathom {

/// A file that appears complete or not at all. Bytes go to a temporary name beside the target; `commit` makes them
/// durable and renames. Without a commit the destructor removes the temporary file and the target stays as it was.
///
/// A target that is a symbolic link is followed; an existing target keeps its permissions.
class AtomicFile {
 public:
  /// Throws Error when the target cannot be created: missing folder, no permission, a folder or device in its place.
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends bytes. Throws Error when the disk is full or fails.
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);

  /// Replaces bytes that were written already, from `offset`; appending goes on where it was. Throws Error.
  void overwrite(std::uint64_t offset, std::string_view text);

  /// Makes everything durable, under the temporary name still: after this, `commit` can hardly fail. Throws Error.
  void prepare();

  /// Prepares, unless that was done, then moves the bytes to the target's name. Throws Error, leaving the old file.
  void commit();

  /// Commits several files that belong together: none gets its name before the bytes of all are safe on disk.
  /// Files are renamed in the order given, so put the one that refers to the others last.
  static void commit_all(std::span<AtomicFile* const> files);
  static void commit_all(std::initializer_list<AtomicFile*> files) { commit_all(std::span(files)); }

  const std::filesystem::path& target() const { return target_; }

 private:
  void flush_buffer();
  void move_to_target();
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::string buffer_;
  int descriptor_ = -1;
};

}  // namespace fathom
