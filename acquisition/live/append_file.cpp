#include "acquisition/live/append_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "core/error.h"
#include "core/printable.h"

namespace fathom {

namespace {
constexpr mode_t kReadWriteForAll = 0666;  // before the umask, as for any new file
constexpr std::size_t kLongestName = 300;
}  // namespace

void fail_to_write(const std::filesystem::path& path, const char* what) {
  const int code = errno;
  const char* advice = code == ENOSPC || code == EDQUOT  ? "; free some space or record elsewhere"
                       : code == EACCES || code == EROFS ? "; choose a folder that you may write to"
                       : code == ENOENT                  ? "; create the folder above it first"
                       : code == EEXIST                  ? "; choose another name, nothing was overwritten"
                                                         : "; choose another place to record to";
  throw Error(printable(path.string(), kLongestName) + ": " + what + ": " + std::strerror(code) + advice);
}

AppendFile::AppendFile(const std::filesystem::path& path) : path_(path) {
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, kReadWriteForAll);
  if (descriptor_ < 0) fail_to_write(path, "cannot be created");
  ::flock(descriptor_, LOCK_EX | LOCK_NB);  // where there are no locks nobody can tell: it is a courtesy
}

AppendFile::~AppendFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void AppendFile::append(std::string_view text) { append(std::as_bytes(std::span(text))); }

void AppendFile::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_to_write(path_, "cannot be written");
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    size_ += static_cast<std::uint64_t>(count);
  }
}

void AppendFile::sync() {
  if (::fdatasync(descriptor_) != 0) fail_to_write(path_, "cannot be written");
}

void AppendFile::cut(std::uint64_t bytes) {
  if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) fail_to_write(path_, "cannot be shortened");
  size_ = bytes;
}

void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

bool is_being_written(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool busy = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return busy;
}

void ReservedSpace::hold(std::uint64_t bytes) {
  if (bytes <= held_) return;
  if (descriptor_ < 0) {
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kReadWriteForAll);
    if (descriptor_ < 0) fail_to_write(path_, "cannot be created");
  }
  errno = ::posix_fallocate(descriptor_, 0, static_cast<off_t>(bytes));  // returns its error instead
  if (errno != 0) fail_to_write(path_, "cannot be written");
  held_ = bytes;
}

void ReservedSpace::release() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(path_.c_str());
  descriptor_ = -1;
  held_ = 0;
}

}  // namespace fathom
