#include "acquisition/sequence_fields.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cstdio>
#include <utility>

#include <Eigen/LU>

#include "acquisition/header_text.h"
#include "acquisition/rigid.h"
#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

namespace {

constexpr std::string_view kPrefix = "Seq_Frame";
constexpr std::string_view kTransform = "Transform";
constexpr std::string_view kTransformStatus = "TransformStatus";
constexpr std::uint64_t kMostFrames = 1'000'000;     // four hours and a half at 60 frames/s
constexpr std::uint64_t kMostMemory = 400ull << 20;  // keeps the whole program below 1 GB whatever a header says
constexpr std::uint64_t kFieldOverhead = 128;        // two strings, and the slack of a vector that grows

bool is_ok(std::string_view status) { return status.empty() || status == "OK"; }

/// "ProbeToTracker" from "ProbeToTrackerTransform"; empty when `name` does not end so, or has nothing before it.
std::string_view stem(std::string_view name, std::string_view suffix) {
  return name.size() > suffix.size() && name.ends_with(suffix) ? name.substr(0, name.size() - suffix.size())
                                                               : std::string_view();
}

std::string frame_name(std::uint64_t frame) { return "frame " + std::to_string(frame); }

}  // namespace

SequenceFields::SequenceFields(std::string file, std::string image_status_alias)
    : file_(std::move(file)), image_status_alias_(std::move(image_status_alias)) {}

void SequenceFields::fail(const std::string& what) const { throw Error(file_ + ": " + what); }

void SequenceFields::charge(std::uint64_t bytes) {
  memory_ += bytes;
  if (memory_ > kMostMemory) fail("its header holds more than this program can keep in memory; split the recording");
}

SequenceFields::Frame& SequenceFields::frame_at(std::uint64_t index) {
  if (index >= kMostFrames) {
    fail("has a field of frame " + std::to_string(index) + "; a recording has at most " + std::to_string(kMostFrames) +
         " frames");
  }
  if (index >= frames_.size()) {
    charge((index + 1 - frames_.size()) * sizeof(Frame));
    frames_.resize(index + 1);
  }
  return frames_[index];
}

std::size_t SequenceFields::transform_index(std::string_view name) {
  const auto found = transform_indices_.find(name);
  if (found != transform_indices_.end()) return found->second;
  charge(2 * (kFieldOverhead + name.size()));
  transforms_.emplace_back(name);
  transform_indices_.emplace(name, transforms_.size() - 1);
  return transforms_.size() - 1;
}

void SequenceFields::add_frame_field(std::string_view name, std::string_view value) {
  std::string_view rest = name.substr(kPrefix.size());
  std::uint64_t index = 0;
  const auto [end, code] = std::from_chars(rest.data(), rest.data() + rest.size(), index);
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  if (code != std::errc() || rest.size() < 2 || rest[0] != '_') {
    fail("\"" + printable(name) + "\" is not a frame's field such as Seq_Frame0000_Timestamp; the header is damaged");
  }
  rest.remove_prefix(1);
  Frame& frame = frame_at(index);
  const auto fail_twice = [&] {
    fail(frame_name(index) + ": " + printable(rest) + " is given twice; the header is damaged");
  };

  const std::string_view status_of = stem(rest, kTransformStatus);
  const std::string_view matrix_of = stem(rest, kTransform);
  if (!status_of.empty() || !matrix_of.empty()) {
    const std::size_t transform = transform_index(status_of.empty() ? matrix_of : status_of);
    auto& poses = frame.header.poses;
    if (transform >= poses.size()) {
      charge((transforms_.size() - poses.size()) * sizeof(std::optional<Pose>));
      poses.resize(transforms_.size());
      frame.has_matrix.resize(transforms_.size());
      frame.has_status.resize(transforms_.size());
    }
    if (!poses[transform]) poses[transform].emplace();
    Pose& pose = *poses[transform];
    const auto given = status_of.empty() ? frame.has_matrix.begin() : frame.has_status.begin();
    if (given[static_cast<std::ptrdiff_t>(transform)]) fail_twice();
    given[static_cast<std::ptrdiff_t>(transform)] = true;
    if (!status_of.empty()) {
      charge(value.size());
      pose.status = value;
      return;
    }
    Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix;
    if (!parse_reals(value, std::span(matrix.data(), 16))) {
      fail(frame_name(index) + ": " + printable(rest) + " is \"" + printable(value) +
           "\", not 16 finite numbers; correct or remove it");
    }
    pose.matrix = matrix;
    return;
  }
  if (rest == "Timestamp") {
    if (frame.header.time_s) fail_twice();
    frame.header.time_s = parse_real(value);
    if (!frame.header.time_s) {
      fail(frame_name(index) + ": Timestamp is \"" + printable(value) +
           "\", not a finite number; correct or remove it");
    }
    return;
  }
  charge(value.size());
  if (rest == "ImageStatus") {
    if (frame.has_image_status) fail_twice();
    frame.has_image_status = true;
    frame.header.image_status = value;
    return;
  }
  charge(kFieldOverhead + rest.size());
  frame.header.fields.emplace_back(rest, value);
}

void SequenceFields::add_field(std::string_view name, std::string_view value) {
  charge(kFieldOverhead + name.size() + value.size());
  fields_.emplace_back(name, value);
}

void SequenceFields::check_duplicates(const std::vector<std::pair<std::string, std::string>>& fields,
                                      const std::string& where) const {
  if (fields.size() < 2) return;
  std::vector<std::string_view> names;
  names.reserve(fields.size());
  for (const auto& field : fields) names.emplace_back(field.first);
  std::sort(names.begin(), names.end());
  const auto twice = std::adjacent_find(names.begin(), names.end());
  if (twice != names.end()) fail(where + printable(*twice) + " is given twice; the header is damaged");
}

void SequenceFields::use_image_status_alias(Frame& frame) const {
  if (image_status_alias_.empty() || frame.has_image_status) return;
  auto& fields = frame.header.fields;
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const auto& field) { return field.first == image_status_alias_; });
  if (found == fields.end()) return;
  frame.header.image_status = found->second;
  fields.erase(found);
}

void SequenceFields::settle_poses(Frame& frame, std::size_t index) const {
  auto& poses = frame.header.poses;
  for (std::size_t t = 0; t < poses.size(); ++t) {
    if (!poses[t]) continue;
    if (!frame.has_matrix[t]) {
      // A status alone says nothing of where the tool is: there is no pose, and the status is kept as a plain field.
      frame.header.fields.emplace_back(transforms_[t] + std::string(kTransformStatus), poses[t]->status);
      poses[t].reset();
      continue;
    }
    check_pose(*poses[t], transforms_[t], file_ + ": " + frame_name(index));
  }
  poses.resize(transforms_.size());
}

void SequenceFields::finish(std::uint64_t frame_count, RecordingHeader& header) {
  if (frame_count == 0) fail("has no frames; record again");
  if (frame_count > kMostFrames) {
    fail("claims to have " + std::to_string(frame_count) + " frames; at most " + std::to_string(kMostFrames) +
         " can be read");
  }
  if (frames_.size() > frame_count) {
    fail("has a field of frame " + std::to_string(frames_.size() - 1) + ", but only " + std::to_string(frame_count) +
         " frames; the header is damaged");
  }
  check_duplicates(fields_, "");
  frame_at(frame_count - 1);
  for (const Frame& frame : frames_) {
    charge(sizeof(FrameHeader) + (transforms_.size() - frame.header.poses.size()) * sizeof(std::optional<Pose>));
  }
  std::vector<bool> used(transforms_.size());
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    check_duplicates(frames_[i].header.fields, frame_name(i) + ": ");
    use_image_status_alias(frames_[i]);
    settle_poses(frames_[i], i);
    for (std::size_t t = 0; t < used.size(); ++t) used[t] = used[t] || frames_[i].header.poses[t].has_value();
  }
  header.frames.clear();
  header.frames.reserve(frames_.size());
  for (Frame& frame : frames_) {
    auto& poses = frame.header.poses;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < poses.size(); ++t) {
      if (!used[t]) continue;
      if (kept != t) poses[kept] = std::move(poses[t]);
      ++kept;
    }
    poses.resize(kept);
    header.frames.push_back(std::move(frame.header));
  }
  header.transforms.clear();
  for (std::size_t t = 0; t < transforms_.size(); ++t) {
    if (used[t]) header.transforms.push_back(std::move(transforms_[t]));
  }
  header.fields = std::move(fields_);
}

void check_pose(const Pose& pose, const std::string& transform, const std::string& where) {
  const auto refuse = [&](const std::string& what) {
    throw Error(where + ": " + printable(transform) + "Transform " + what +
                "; set its status to INVALID or correct it");
  };
  if (!pose.matrix.allFinite()) refuse("has a number that is not finite");
  if (!is_ok(pose.status)) return;
  if (pose.matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) refuse("does not end in the row 0 0 0 1");
  if (transform.starts_with("Image")) return;
  if (!is_rigid(pose.matrix)) refuse("is not a rotation and a shift");
}

void append_field(std::string& text, std::string_view name, std::string_view value, const FieldSyntax& syntax) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  for (const char c : name) {
    text += is_control(c) || syntax.forbidden.find(c) != std::string_view::npos ? '_' : c;
  }
  text += syntax.separator;
  for (const char c : value) text += is_control(c) ? ' ' : c;
  text += '\n';
}

void append_frame_fields(std::string& text, const std::vector<std::string>& transforms, const FrameHeader& fields,
                         std::size_t frame, const FieldSyntax& syntax) {
  assert(fields.poses.size() == transforms.size());
  char prefix[32];
  std::snprintf(prefix, sizeof prefix, "Seq_Frame%04zu_", frame);
  const auto append = [&](std::string_view name, std::string_view suffix, std::string_view value) {
    text += prefix;
    append_field(text, std::string(name) + std::string(suffix), value, syntax);
  };
  std::string numbers;
  for (std::size_t t = 0; t < transforms.size(); ++t) {
    if (!fields.poses[t]) continue;
    const Pose& pose = *fields.poses[t];
    numbers.clear();
    for (int i = 0; i < 16; ++i) {
      if (i > 0) numbers += ' ';
      numbers += format_real(pose.matrix(i / 4, i % 4));
    }
    append(transforms[t], kTransform, numbers);
    if (!pose.status.empty()) append(transforms[t], kTransformStatus, pose.status);
  }
  if (fields.time_s) {
    numbers.clear();
    numbers += format_real(*fields.time_s);
    append("Timestamp", "", numbers);
  }
  bool name_is_taken = false;
  for (const auto& [name, value] : fields.fields) {
    append(name, "", value);
    name_is_taken = name_is_taken || name == syntax.image_status;
  }
  // Where another field bears the name, "ImageStatus" is written even if empty: the reader prefers it.
  if (fields.image_status.empty() && !name_is_taken) return;
  append(name_is_taken ? "ImageStatus" : syntax.image_status, "", fields.image_status);
}

}  // namespace fathom
