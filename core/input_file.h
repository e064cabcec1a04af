#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace fathom {

/// A regular file open for reading at any position, from several threads.
class InputFile {
 public:
  /// Throws Error when the file is missing, is a folder, pipe or device, or may not be read.
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Length in bytes when the file was opened.
  std::uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }
  /// The file as named in messages: one line, whatever its name holds.
  const std::string& name() const { return name_; }
  int descriptor() const { return descriptor_; }

  /// Reads up to out.size() bytes from `position`; fewer only at the end of the file. Returns how many. Throws Error
  /// when the disk fails.
  std::size_t read_some(std::uint64_t position, std::span<std::byte> out) const;

  /// Throws Error with the file's name before `what`.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::filesystem::path path_;
  std::string name_;
  std::uint64_t size_ = 0;
  int descriptor_ = -1;
};

}  // namespace fathom
