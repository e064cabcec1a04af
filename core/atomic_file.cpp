#include "core/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"

namespace fathom {

namespace {

constexpr std::size_t kBufferBytes = 1 << 18;
constexpr mode_t kReadWriteForAll = 0666;  // before the umask, as for any new file

std::filesystem::path parent_folder(const std::filesystem::path& target) {
  const auto parent = target.parent_path();
  return parent.empty() ? std::filesystem::path(".") : parent;
}

// Follows links by hand, since the standard's canonical() stops at one whose file is yet to be made.
std::filesystem::path file_behind(std::filesystem::path target) {
  constexpr int kMaxLinks = 40;  // as in Linux
  std::error_code code;
  for (int i = 0; i < kMaxLinks && std::filesystem::is_symlink(target, code); ++i) {
    const auto next = std::filesystem::read_symlink(target, code);
    if (code) break;
    target = parent_folder(target) / next;  // an absolute link replaces the folder
  }
  if (std::filesystem::is_symlink(target, code)) {
    throw Error(target.string() + ": is a link that leads nowhere; choose another name to write to");
  }
  return target;
}

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& target) : target_(target) {
  std::error_code code;
  if (target.filename().empty()) throw Error(target.string() + ": is not a file name; name the file to write");
  // A link is followed, so that the file behind it is replaced and the link stays.
  if (std::filesystem::is_symlink(target, code)) {
    target_ = file_behind(target);
  }
  const auto status = std::filesystem::status(target_, code);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw Error(target_.string() + ": is not a regular file; choose another name to write to");
  }
  const bool replaces = std::filesystem::exists(status);
  if (replaces && ::access(target_.c_str(), W_OK) != 0) fail("cannot be overwritten");

  std::string name = (parent_folder(target_) / ("." + target_.filename().string() + ".XXXXXX")).string();
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) fail("cannot be created");
  temporary_ = name;

  mode_t mode;
  if (replaces) {
    mode = static_cast<mode_t>(status.permissions());
  } else {
    const mode_t mask = ::umask(0);
    ::umask(mask);
    mode = kReadWriteForAll & ~mask;
  }
  ::fchmod(descriptor_, mode);
  buffer_.reserve(kBufferBytes);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  write(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void AtomicFile::write(std::string_view text) {
  if (buffer_.size() + text.size() > kBufferBytes) flush_buffer();
  if (text.size() < kBufferBytes) {
    buffer_.append(text);
    return;
  }
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor_, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("cannot be written");
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

void AtomicFile::overwrite(std::uint64_t offset, std::string_view text) {
  flush_buffer();
  while (!text.empty()) {
    const ssize_t count = ::pwrite(descriptor_, text.data(), text.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("cannot be written");
    text.remove_prefix(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
}

void AtomicFile::flush_buffer() {
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t count = ::write(descriptor_, rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("cannot be written");
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
  buffer_.clear();
}

void AtomicFile::prepare() {
  if (descriptor_ < 0) return;
  flush_buffer();
  if (::fsync(descriptor_) != 0) fail("cannot be written");
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) fail("cannot be written");
}

void AtomicFile::move_to_target() {
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot be replaced");
  temporary_.clear();
}

void AtomicFile::commit() { commit_all({this}); }

void AtomicFile::commit_all(std::span<AtomicFile* const> files) {
  for (AtomicFile* file : files) file->prepare();
  for (AtomicFile* file : files) file->move_to_target();
}

void AtomicFile::fail(const char* what) const {
  const int code = errno;
  const char* advice = code == ENOSPC || code == EDQUOT  ? "; free some space or write elsewhere"
                       : code == EFBIG                   ? "; write where large files are allowed"
                       : code == EACCES || code == EROFS ? "; choose a folder that you may write to"
                       : code == ENOENT                  ? "; create the folder first"
                                                         : "; choose another place to write to";
  throw Error(target_.string() + ": " + what + ": " + std::strerror(code) + advice);
}

}  // namespace fathom
