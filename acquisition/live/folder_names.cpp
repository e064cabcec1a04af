#include "acquisition/live/folder_names.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "acquisition/header_text.h"
#include "acquisition/metaimage.h"
#include "acquisition/sequence_fields.h"
#include "core/error.h"

namespace fathom {

namespace {

// With "Seq_Frame000000_" before the name the whole line stays below the 1000 characters that PLUS reads at once.
constexpr std::size_t kLongestName = 200;
constexpr std::size_t kLongestValue = 750;
constexpr std::size_t kMostTransforms = 64;

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

bool is_taken(std::string_view name) {
  return name == "Timestamp" || name == "ImageStatus" || name == "Status" || name == kSweepField ||
         name == "latency_applied_s" || name.ends_with("Transform") || name.ends_with("TransformStatus") ||
         name.starts_with("Seq_Frame") || is_metaimage_storage_field(name);
}

bool is_usable(std::string_view name) {
  return !name.empty() && name.size() <= kLongestName && std::all_of(name.begin(), name.end(), is_plain) &&
         !is_taken(name);
}

}  // namespace

std::string_view sweep_of(const FrameHeader& frame) {
  for (const auto& [name, value] : frame.fields) {
    if (name == kSweepField) return value;
  }
  return {};
}

std::string plain_status(const std::string& status) {
  if (status.empty() || status == "OK") return status;
  std::string plain(trimmed(std::string_view(status).substr(0, kLongestName)));
  for (char& c : plain) {
    if (!is_plain(c)) c = '_';
  }
  return plain.empty() || plain == "OK" ? "INVALID" : plain;
}

Pose storable(const NamedPose& pose) {
  Pose stored{pose.pose.matrix, plain_status(pose.pose.status)};
  if (!stored.matrix.allFinite()) stored = {Eigen::Matrix4d::Identity(), stored.valid() ? "INVALID" : stored.status};
  try {
    check_pose(stored, pose.transform, {});
  } catch (const Error&) {
    stored.status = "INVALID";
  }
  return stored;
}

std::vector<std::pair<std::string, std::string>> usable_fields(
    const std::vector<std::pair<std::string, std::string>>& fields) {
  std::vector<std::pair<std::string, std::string>> usable;
  std::set<std::string_view> used;
  for (const auto& [name, value] : fields) {
    if (is_usable(name) && value.size() <= kLongestValue && used.insert(name).second) usable.emplace_back(name, value);
  }
  return usable;
}

void UsableTransforms::add(const std::string& device_name) {
  if (indices_.contains(device_name) || indices_.size() == kMostTransforms) return;
  std::string name = device_name.substr(0, kLongestName);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !is_plain(c); }, '_');
  const bool usable = !name.empty() && !name.ends_with("Transform") && !name.ends_with("TransformStatus") &&
                      std::find(names_.begin(), names_.end(), name) == names_.end();
  indices_[device_name] = usable ? std::optional(names_.size()) : std::nullopt;
  if (usable) names_.push_back(name);
}

std::optional<std::size_t> UsableTransforms::index(const std::string& device_name) const {
  const auto found = indices_.find(device_name);
  return found == indices_.end() ? std::nullopt : found->second;
}

}  // namespace fathom
