#include "acquisition/live/tracker_pose.h"

#include <algorithm>
#include <utility>

#include "acquisition/rigid.h"

namespace fathom {

namespace {

bool is_letter_or_digit(char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

// "AToB": between two names, of which the second begins with a capital letter as the first may.
bool names_two_frames(std::string_view name) {
  for (std::size_t at = name.find("To", 1); at != std::string_view::npos; at = name.find("To", at + 1)) {
    if (at + 2 < name.size() && name[at + 2] >= 'A' && name[at + 2] <= 'Z') return true;
  }
  return false;
}

}  // namespace

Pose tracker_pose(const Eigen::Matrix4d& matrix, std::string status) {
  Pose pose{matrix, std::move(status)};
  if (!matrix.allFinite()) {
    if (pose.valid()) pose.status = "NOT_FINITE";
    pose.matrix.setIdentity();
  } else if (pose.valid() && !is_rigid(matrix)) {
    pose.status = "NOT_RIGID";
  }
  return pose;
}

std::string transform_name(std::string_view device) {
  constexpr std::string_view kSuffix = "Transform";
  std::string name(device);
  if (name.ends_with(kSuffix) && name.size() > kSuffix.size()) name.resize(name.size() - kSuffix.size());
  if (std::none_of(name.begin(), name.end(), is_letter_or_digit)) return {};
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !is_letter_or_digit(c); }, '_');
  return names_two_frames(name) ? name : name + "ToTracker";
}

}  // namespace fathom
