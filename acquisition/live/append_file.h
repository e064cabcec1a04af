#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace fathom {

/// A new file that only grows, so that what is in it can be trusted after a crash up to the last sync.
class AppendFile {
 public:
  /// Makes the file and locks it, so that others can tell that it is being written. Throws Error when it exists or
  /// cannot be made.
  explicit AppendFile(const std::filesystem::path& path);
  ~AppendFile();
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;

  /// Appends all bytes, or throws Error (a full disk, a pulled plug) and may have appended some.
  void append(std::span<const std::byte> bytes);
  void append(std::string_view text);

  /// Waits until everything is on the disk. Throws Error.
  void sync();

  /// Drops what lies behind the first `bytes`. Throws Error.
  void cut(std::uint64_t bytes);

  /// Bytes appended so far.
  std::uint64_t size() const { return size_; }

 private:
  std::filesystem::path path_;
  std::uint64_t size_ = 0;
  int descriptor_ = -1;
};

/// Waits until the names in a folder are on the disk, as far as its file system does that.
void sync_folder(const std::filesystem::path& folder);

/// Throws Error with what the system says (errno) of `path`, and what to do.
[[noreturn]] void fail_to_write(const std::filesystem::path& path, const char* what);

/// Whether a program that holds an AppendFile of this name is still running.
bool is_being_written(const std::filesystem::path& path);

/// Room on the disk that is held back, so that a recording can be finished when the disk is full.
class ReservedSpace {
 public:
  explicit ReservedSpace(std::filesystem::path path) : path_(std::move(path)) {}
  ~ReservedSpace() { release(); }
  ReservedSpace(const ReservedSpace&) = delete;
  ReservedSpace& operator=(const ReservedSpace&) = delete;

  /// Holds at least so much back. Throws Error when the disk has not so much.
  void hold(std::uint64_t bytes);
  void release();

 private:
  std::filesystem::path path_;
  std::uint64_t held_ = 0;
  int descriptor_ = -1;
};

}  // namespace fathom
