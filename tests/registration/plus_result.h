#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/numbers.h"
#include "registration/probe_poses.h"
#include "registration/wire_phantom.h"
#include "tests/scratch_folder.h"

namespace fathom {

/// The points that PLUS found in a sweep, and its poses, from one section ("CalibrationData") of its result file.
inline std::pair<ProbePoses, std::vector<WirePoint>> plus_points(const std::filesystem::path& file,
                                                                 const std::string& section,
                                                                 const WirePhantom& phantom) {
  const std::string text = content_of(file);
  const std::size_t begin = text.find("<" + section + ">");
  const std::size_t end = text.find("</" + section + ">");
  std::vector<std::optional<Eigen::Isometry3d>> poses;
  std::vector<double> times;
  std::vector<WirePoint> points;
  const auto attribute = [](const std::string& line, const std::string& name) {
    const std::size_t at = line.find(name + "=\"");
    const std::size_t from = at + name.size() + 2;
    return at == std::string::npos ? std::string() : line.substr(from, line.find('"', from) - from);
  };
  std::istringstream stream(text.substr(begin, end - begin));
  Eigen::Matrix4d tracker_from_probe = Eigen::Matrix4d::Identity();
  for (std::string line; std::getline(stream, line);) {
    const auto matrix = [&] {
      const auto values = parse_reals(attribute(line, "Value"));
      return Eigen::Matrix4d(Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values->data()));
    };
    if (line.find("<Frame Index") != std::string::npos) poses.emplace_back();
    if (line.find("<Point WireName") != std::string::npos) {
      const auto position = parse_reals(attribute(line, "Position"));
      WirePoint point;
      point.frame = static_cast<int>(poses.size()) - 1;
      point.position_px = Eigen::Vector2d((*position)[0], (*position)[1]);
      for (std::size_t p = 0; p < phantom.patterns.size(); ++p) {
        for (std::size_t w = 0; w < 3; ++w) {
          if (phantom.patterns[p][w].name != attribute(line, "WireName")) continue;
          point.pattern = p;
          point.wire = w;
          points.push_back(point);
        }
      }
    }
    if (line.find("\"ProbeToTrackerTransform\"") != std::string::npos) tracker_from_probe = matrix();
    if (line.find("\"ReferenceToTrackerTransform\"") != std::string::npos) {
      const Eigen::Matrix4d pose = matrix().inverse() * tracker_from_probe;
      Eigen::Isometry3d rigid = Eigen::Isometry3d::Identity();
      rigid.linear() = Eigen::Quaterniond(Eigen::Matrix3d(pose.topLeftCorner<3, 3>())).normalized().toRotationMatrix();
      rigid.translation() = pose.topRightCorner<3, 1>();
      poses.back() = rigid;
    }
    if (line.find("Name=\"Timestamp\"") != std::string::npos) times.push_back(*parse_real(attribute(line, "Value")));
  }
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] <= times[i - 1]) times.clear();
  }
  if (times.size() != poses.size()) times.clear();
  return {ProbePoses(file.filename(), std::move(poses), std::move(times)), std::move(points)};
}

}  // namespace fathom
