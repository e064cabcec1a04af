#include "registration/pose_chain.h"

#include <algorithm>
#include <cctype>
#include <deque>
#include <map>

#include "acquisition/header_text.h"
#include "acquisition/rigid.h"

namespace fathom {

namespace {

Eigen::Isometry3d orthonormal(const Eigen::Matrix4d& matrix, const std::string& what) {
  if (!matrix.allFinite() || !is_rigid(matrix)) {
    throw Error(what + " is not a rigid motion; record again, or mark the frame invalid");
  }
  return nearest_rigid(matrix);
}

bool knows_coordinates(const RecordingHeader& header, const std::string& name) {
  return std::any_of(header.transforms.begin(), header.transforms.end(), [&](const std::string& transform) {
    const auto ends = split_transform_name(transform);
    return ends && (ends->first == name || ends->second == name);
  });
}

struct Edge {
  std::string to;
  PoseChain::Step step;
};

// The transforms as undirected edges between coordinates. Those of the image are pixels to millimetres, no motions: a
// way through them would be shorter at times, but never a pose.
std::map<std::string, std::vector<Edge>> edges_of(const RecordingHeader& header) {
  constexpr const char* kImage = "Image";
  std::map<std::string, std::vector<Edge>> edges;
  for (std::size_t i = 0; i < header.transforms.size(); ++i) {
    const auto ends = split_transform_name(header.transforms[i]);
    if (!ends || ends->first == kImage || ends->second == kImage) continue;
    edges[ends->first].push_back({ends->second, {i, false}});
    edges[ends->second].push_back({ends->first, {i, true}});
  }
  return edges;
}

// Breadth first, so that the chain is the shortest.
std::optional<PoseChain> search(const RecordingHeader& header, const std::string& probe, const std::string& reference) {
  const auto edges = edges_of(header);
  std::map<std::string, Edge> arrivals;  // Edge::to is where one came from
  std::deque<std::string> queue{probe};
  while (!queue.empty() && !arrivals.contains(reference)) {
    const std::string here = queue.front();
    queue.pop_front();
    const auto leaving = edges.find(here);
    if (leaving == edges.end()) continue;
    for (const Edge& edge : leaving->second) {
      if (edge.to == probe || arrivals.contains(edge.to)) continue;
      arrivals[edge.to] = {here, edge.step};
      queue.push_back(edge.to);
    }
  }
  if (!arrivals.contains(reference)) return std::nullopt;
  PoseChain chain{probe, reference, {}};
  for (std::string at = reference; at != probe; at = arrivals[at].to) chain.steps.push_back(arrivals[at].step);
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
  constexpr std::size_t kLongestList = 300;  // characters in a message
  std::string have;
  for (const std::string& name : header.transforms) {
    have += (have.empty() ? "" : ", ") + name;
    if (have.size() > kLongestList) break;
  }
  have = printable(have, kLongestList);
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
        orthonormal(stored->matrix, recording.name() + ": " + printable(recording.header().transforms[step.transform]) +
                                        " of frame " + std::to_string(frame));
    pose = (step.inverted ? moved.inverse() : moved) * pose;
  }
  return pose;
}

}  // namespace fathom
