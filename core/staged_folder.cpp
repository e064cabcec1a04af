#include "core/staged_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>
#include <vector>

#include "core/error.h"

namespace fathom {

StagedFolder::StagedFolder(const std::filesystem::path& target) : target_(target.lexically_normal()) {
  if (!target_.has_filename()) target_ = target_.parent_path();  // "out/" is "out"
  std::error_code code;
  const auto status = std::filesystem::status(target_, code);
  if (std::filesystem::exists(status) && !std::filesystem::is_directory(status)) {
    throw Error(target_.string() + ": is not a folder; choose another name");
  }
  std::string name = (target_.parent_path() / ("." + target_.filename().string() + ".XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr) {
    const std::error_code reason(errno, std::generic_category());
    throw Error(target_.string() + ": cannot be created: " + reason.message() + "; choose a folder you may write to");
  }
  staging_ = name;
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(staging_, ignored);
}

void StagedFolder::commit(const std::filesystem::path& last) {
  try {
    std::filesystem::create_directories(target_);
    for (const auto& entry : std::filesystem::directory_iterator(staging_)) {
      const auto place = target_ / entry.path().filename();
      if (std::filesystem::exists(place) && !std::filesystem::is_regular_file(place)) {
        throw Error(place.string() + ": is not a regular file; move it away or choose another folder");
      }
    }
    std::vector<std::filesystem::path> names;
    for (const auto& entry : std::filesystem::directory_iterator(staging_)) names.push_back(entry.path().filename());
    std::stable_partition(names.begin(), names.end(), [&last](const auto& name) { return name != last; });
    for (const auto& name : names) std::filesystem::rename(staging_ / name, target_ / name);
  } catch (const std::filesystem::filesystem_error& error) {
    throw Error(target_.string() + ": cannot be written to: " + error.code().message() +
                "; choose a folder you may write to");
  }
}

}  // namespace fathom
