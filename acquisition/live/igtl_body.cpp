#include "acquisition/live/igtl_body.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include <Eigen/Geometry>
#include <igtl_position.h>
#include <igtl_qtdata.h>
#include <igtl_tdata.h>

#include "acquisition/live/tracker_pose.h"
#include "core/error.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr double kUnitTolerance = 1e-3;  // of a quaternion's length, as of rotations

// Numbers of the line are big-endian.
std::uint32_t number_at(std::span<const std::byte> bytes, std::size_t at, std::size_t size) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < size; ++i) number = number << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
  return number;
}

std::string text_at(std::span<const std::byte> bytes, std::size_t at, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()) + at, size);
  return std::string(text.substr(0, text.find('\0')));
}

std::string look_up(const IgtlMetadata& metadata, const std::string& key) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? std::string() : found->second;
}

// A pose, and what its device is called. PLUS states its validity, and a name that was cut to fit, as metadata.
std::optional<IgtlPose> named_pose(const std::string& device, const Eigen::Matrix4d& matrix,
                                   const std::string& status) {
  const std::string name = transform_name(device);
  if (name.empty()) throw Error("it does not name its transform");
  // From pixels, with their size: a calibration, which no tracker measures.
  Pose pose = tracker_pose(matrix, printable(status));
  if (pose.status == "NOT_RIGID" && name.starts_with("Image")) return std::nullopt;
  return IgtlPose{name, std::move(pose)};
}

Eigen::Matrix4d matrix_of(const float (&position)[3], const Eigen::Quaterniond& rotation) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 3; ++i) matrix(i, 3) = static_cast<double>(position[i]);
  const double length = rotation.norm();
  // Another length is no rotation: shown as one that is not rigid.
  matrix.topLeftCorner<3, 3>() = std::abs(length - 1.0) <= kUnitTolerance
                                     ? rotation.normalized().toRotationMatrix()
                                     : Eigen::Matrix3d(Eigen::Matrix3d::Identity() * length);
  return matrix;
}

Eigen::Quaterniond quaternion_of(const float (&numbers)[4]) {
  return {static_cast<double>(numbers[3]), static_cast<double>(numbers[0]), static_cast<double>(numbers[1]),
          static_cast<double>(numbers[2])};
}

void require_size(std::span<const std::byte> content, std::size_t bytes) {
  if (content.size() != bytes) {
    throw Error("it has " + std::to_string(content.size()) + " bytes instead of " + std::to_string(bytes));
  }
}

std::vector<IgtlPose> one_pose(const IgtlHeader& header, const Eigen::Matrix4d& matrix, const IgtlMetadata& metadata) {
  const std::string whole_name = look_up(metadata, "IGTL_DEVICE_NAME");
  auto pose = named_pose(whole_name.empty() ? header.device : whole_name, matrix, look_up(metadata, "TransformStatus"));
  std::vector<IgtlPose> poses;
  if (pose) poses.push_back(std::move(*pose));
  return poses;
}

std::vector<IgtlPose> read_transform(const IgtlHeader& header, std::span<const std::byte> content,
                                     const IgtlMetadata& metadata) {
  require_size(content, 48);
  return one_pose(header, read_igtl_matrix(content.first<48>()), metadata);
}

std::vector<IgtlPose> read_position(const IgtlHeader& header, std::span<const std::byte> content,
                                    const IgtlMetadata& metadata) {
  // Shorter ones, without an orientation, are no poses.
  require_size(content, sizeof(igtl_position));
  igtl_position raw;
  std::memcpy(&raw, content.data(), sizeof raw);
  igtl_position_convert_byte_order(&raw);
  float position[3];
  float quaternion[4];
  std::memcpy(position, raw.position, sizeof position);
  std::memcpy(quaternion, raw.quaternion, sizeof quaternion);
  return one_pose(header, matrix_of(position, quaternion_of(quaternion)), metadata);
}

// A name that may have been cut at `most` bytes, as PLUS spells it in its metadata.
std::string whole_name(const std::string& name, std::size_t most, const IgtlMetadata& metadata) {
  constexpr std::string_view kStatus = "Status";
  if (name.size() < most) return name;
  const auto key = metadata.lower_bound(name);
  if (key == metadata.end() || !key->first.starts_with(name) || !key->first.ends_with(kStatus)) return name;
  return key->first.substr(0, key->first.size() - kStatus.size());
}

// The elements of TDATA and QTDATA, each with a name of its own.
template <typename Element, typename Convert, typename ToMatrix>
std::vector<IgtlPose> read_elements(std::span<const std::byte> content, const IgtlMetadata& metadata, Convert convert,
                                    ToMatrix to_matrix) {
  if (content.size() % sizeof(Element) != 0) {
    throw Error("its " + std::to_string(content.size()) + " bytes are no whole number of elements");
  }
  std::vector<IgtlPose> poses;
  for (std::size_t at = 0; at < content.size(); at += sizeof(Element)) {
    Element element;
    std::memcpy(&element, content.data() + at, sizeof element);
    convert(&element, 1);
    const std::string name = whole_name(text_at(content, at, sizeof element.name), sizeof element.name, metadata);
    auto pose =
        named_pose(name, to_matrix(element, content.subspan(at, sizeof element)), look_up(metadata, name + "Status"));
    if (pose) poses.push_back(std::move(*pose));
  }
  return poses;
}

std::vector<IgtlPose> read_tdata(const IgtlHeader&, std::span<const std::byte> content, const IgtlMetadata& metadata) {
  return read_elements<igtl_tdata_element>(
      content, metadata, igtl_tdata_convert_byte_order,
      [](const igtl_tdata_element&, std::span<const std::byte> bytes) { return read_igtl_matrix(bytes.last<48>()); });
}

std::vector<IgtlPose> read_qtdata(const IgtlHeader&, std::span<const std::byte> content, const IgtlMetadata& metadata) {
  return read_elements<igtl_qtdata_element>(content, metadata, igtl_qtdata_convert_byte_order,
                                            [](const igtl_qtdata_element& element, std::span<const std::byte>) {
                                              float position[3];
                                              float quaternion[4];
                                              std::memcpy(position, element.position, sizeof position);
                                              std::memcpy(quaternion, element.quaternion, sizeof quaternion);
                                              return matrix_of(position, quaternion_of(quaternion));
                                            });
}

using ReadPoses = std::vector<IgtlPose> (*)(const IgtlHeader&, std::span<const std::byte>, const IgtlMetadata&);

struct PoseType {
  std::string_view type;
  ReadPoses read;
};
// QTRANS is another name of POSITION.
constexpr PoseType kPoseTypes[] = {{"TRANSFORM", read_transform},
                                   {"TDATA", read_tdata},
                                   {"QTDATA", read_qtdata},
                                   {"POSITION", read_position},
                                   {"QTRANS", read_position}};

}  // namespace

IgtlMetadata read_igtl_metadata(std::span<const std::byte> header, std::span<const std::byte> body) {
  constexpr std::size_t kEntry_bytes = 8;  // size of the key (2 bytes), encoding (2), size of the value (4)
  IgtlMetadata metadata;
  if (header.empty()) return metadata;
  if (header.size() < 2 || header.size() != 2 + kEntry_bytes * number_at(header, 0, 2)) {
    throw Error("the index of its metadata has another size than stated");
  }
  std::size_t at = 0;
  for (std::size_t entry = 2; entry < header.size(); entry += kEntry_bytes) {
    const std::size_t key_bytes = number_at(header, entry, 2);
    const std::size_t value_bytes = number_at(header, entry + 4, 4);
    if (key_bytes + value_bytes > body.size() - at) throw Error("its metadata is cut off");
    metadata[text_at(body, at, key_bytes)] = text_at(body, at + key_bytes, value_bytes);
    at += key_bytes + value_bytes;
  }
  return metadata;
}

bool has_igtl_poses(const std::string& type) {
  return std::any_of(std::begin(kPoseTypes), std::end(kPoseTypes),
                     [&](const PoseType& each) { return each.type == type; });
}

std::vector<IgtlPose> read_igtl_poses(const IgtlHeader& header, std::span<const std::byte> content,
                                      const IgtlMetadata& metadata) {
  const auto* type = std::find_if(std::begin(kPoseTypes), std::end(kPoseTypes),
                                  [&](const PoseType& each) { return each.type == header.type; });
  return type->read(header, content, metadata);
}

std::string read_igtl_status(std::span<const std::byte> content) {
  constexpr std::uint32_t kAllIsWell = 1;
  constexpr std::size_t kName_bytes = 20;
  constexpr std::size_t kText = 30;  // after the code, a subcode of 8 bytes and the name
  if (content.size() < kText) throw Error("it has " + std::to_string(content.size()) + " bytes, too few");
  const std::uint32_t code = number_at(content, 0, 2);
  if (code == kAllIsWell) return {};
  std::string complaint = "status " + std::to_string(code);
  for (const std::string& text : {text_at(content, 10, kName_bytes), text_at(content, kText, content.size() - kText)}) {
    if (!text.empty()) complaint += ", " + printable(text, 200);
  }
  return complaint;
}

}  // namespace fathom
