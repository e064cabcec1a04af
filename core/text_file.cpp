#include "core/text_file.h"

#include <fstream>

#include "core/atomic_file.h"
#include "core/error.h"

namespace fathom {

std::string read_text_file(const std::filesystem::path& path, std::uintmax_t max_bytes) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) throw Error(path.string() + ": does not exist; check the name");
  if (!std::filesystem::is_regular_file(status)) throw Error(path.string() + ": is not a file; name a file");
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  if (code) throw Error(path.string() + ": cannot be read: " + code.message() + "; check its permissions");
  if (size > max_bytes) {
    throw Error(path.string() + ": is " + std::to_string(size >> 20) + " MB long, more than the " +
                std::to_string(max_bytes >> 20) + " MB that such a file may have; name another file");
  }
  std::ifstream stream(path, std::ios::binary);
  std::string text(size, '\0');
  if (!stream || !stream.read(text.data(), static_cast<std::streamsize>(size))) {
    throw Error(path.string() + ": cannot be read; check its permissions");
  }
  return text;
}

void write_text_file(const std::filesystem::path& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace fathom
