#include "registration/pose_chain.h"

#include <algorithm>
#include <cctype>
#include <deque>
#include <map>

#include <Eigen/SVD>

namespace fathom {

namespace {

constexpr double kMaxNonRigidity = 1e-3;  // poses are printed with six digits; more than this is no rounding

Eigen::Isometry3d orthonormal(const Eigen::Matrix4d& matrix, const std::string& what) {
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const bool rigid =
      matrix.allFinite() &&
      (linear.transpose() * linear - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= 2.0 * kMaxNonRigidity &&
      linear.determinant() > 0.0;
  if (!rigid) throw Error(what + " is not a rigid motion; record again, or mark the frame invalid");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

bool knows_coordinates(const RecordingHeader& header, const std::string& name) {
  return std::any_of(header.transforms.begin(), header.transforms.end(), [&](const std::string& transform) {
    const auto ends = split_transform_name(transform);
    return ends && (ends->first == name || ends->second == name);
  });
}

// Breadth first over the transforms as undirected edges between coordinates.
std::optional<PoseChain> search(const RecordingHeader& header, const std::string& probe, const std::string& reference) {
  struct Arrival {
    std::string from;
    PoseChain::Step step;
  };
  std::map<std::string, Arrival> arrivals;
  std::deque<std::string> queue{probe};
  while (!queue.empty() && !arrivals.contains(reference)) {
    const std::string here = queue.front();
    queue.pop_front();
    for (std::size_t i = 0; i < header.transforms.size(); ++i) {
      const auto ends = split_transform_name(header.transforms[i]);
      if (!ends || (ends->first != here && ends->second != here)) continue;
      const bool inverted = ends->second == here;
      const std::string& next = inverted ? ends->first : ends->second;
      if (next == probe || arrivals.contains(next)) continue;
      arrivals[next] = {here, {i, inverted}};
      queue.push_back(next);
    }
  }
  if (!arrivals.contains(reference)) return std::nullopt;
  PoseChain chain{probe, reference, {}};
  for (std::string at = reference; at != probe; at = arrivals[at].from) chain.steps.push_back(arrivals[at].step);
  std::reverse(chain.steps.begin(), chain.steps.end());
  return chain;
}

std::optional<PoseChain> chosen_or_usual(const RecordingHeader& header, const FrameNames& names) {
  const std::string probe = names.probe.value_or("Probe");
  if (names.reference) return search(header, probe, *names.reference);
  return search(header, probe, knows_coordinates(header, "Reference") ? "Reference" : "Tracker");
}

}  // namespace

std::optional<std::pair<std::string, std::string>> split_transform_name(const std::string& name) {
  // "ToolToTracker", "StylusTipToStylus": the "To" that joins two names has a capital behind it and a name before.
  for (std::size_t at = name.find("To", 1); at != std::string::npos; at = name.find("To", at + 1)) {
    const std::size_t next = at + 2;
    if (next < name.size() && !std::islower(static_cast<unsigned char>(name[next]))) {
      return std::pair(name.substr(0, at), name.substr(next));
    }
  }
  return std::nullopt;
}

PoseChain find_pose_chain(const Recording& recording, const FrameNames& names) {
  const RecordingHeader& header = recording.header();
  if (const auto chain = chosen_or_usual(header, names)) return *chain;
  std::string have;
  for (const std::string& name : header.transforms) have += (have.empty() ? "" : ", ") + name;
  throw Error(recording.name() + ": no transforms lead from " + names.probe.value_or("Probe") + " to " +
              names.reference.value_or("Reference or Tracker") + "; " +
              (have.empty() ? "the recording has none at all, give one with a tracker's poses"
                            : "it has " + have + ": choose with --probe-frame and --reference-frame"));
}

std::optional<PoseChain> default_pose_chain(const Recording& recording, const FrameNames& names) {
  const RecordingHeader& header = recording.header();
  if (const auto chain = chosen_or_usual(header, names)) return chain;
  if (names.probe || names.reference) return std::nullopt;
  for (const auto& [key, value] : header.fields) {
    if (key != "DefaultFrameTransformName") continue;
    constexpr std::string_view kSuffix = "Transform";
    const std::string name = value.ends_with(kSuffix) ? value.substr(0, value.size() - kSuffix.size()) : value;
    const auto ends = split_transform_name(name);
    if (ends && header.transform_index(name)) return search(header, ends->first, ends->second);
  }
  return std::nullopt;
}

std::optional<Eigen::Isometry3d> reference_from_probe(const Recording& recording, const PoseChain& chain, int frame) {
  const FrameHeader& header = recording.header().frames[static_cast<std::size_t>(frame)];
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (const PoseChain::Step& step : chain.steps) {
    const std::optional<Pose>& stored = header.poses[step.transform];
    if (!stored || !stored->valid()) return std::nullopt;
    const Eigen::Isometry3d moved =
        orthonormal(stored->matrix, recording.name() + ": " + recording.header().transforms[step.transform] +
                                        " of frame " + std::to_string(frame));
    pose = (step.inverted ? moved.inverse() : moved) * pose;
  }
  return pose;
}

}  // namespace fathom
