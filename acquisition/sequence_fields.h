#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/recording.h"

namespace fathom {

/// Collects the fields of a sequence's header, in the form that MetaImage and NRRD sequences share:
/// `Seq_FrameNNNN_Name`, with NNNN from 0 and at least four digits. Names ending in `Transform` and `TransformStatus`
/// are poses, `Timestamp` and `ImageStatus` are what they say, all others are kept as text.
///
/// Every function throws Error that begins with the file's name.
class SequenceFields {
 public:
  /// `image_status_alias`: a second name for ImageStatus, used where ImageStatus is not given (NRRD: "Status"); or
  /// empty.
  explicit SequenceFields(std::string file, std::string image_status_alias = {});

  static bool is_frame_field(std::string_view name) { return name.starts_with("Seq_Frame"); }

  /// Adds `Seq_FrameNNNN_Name`. Throws Error when the name has not that form, the field was given before, or its value
  /// is not a matrix or number where it must be one.
  void add_frame_field(std::string_view name, std::string_view value);

  /// Adds a field of the whole recording. Throws Error when it takes too much memory.
  void add_field(std::string_view name, std::string_view value);

  /// Moves everything into `header`. Throws Error when a frame lies beyond `frame_count`, a field is given twice, a
  /// pose is not valid as check_pose says, or the whole would take more memory than a recording's header may.
  void finish(std::uint64_t frame_count, RecordingHeader& header);

  std::size_t frames_seen() const { return frames_.size(); }

 private:
  struct Frame {
    FrameHeader header;
    std::vector<bool> has_matrix;  ///< as FrameHeader::poses
    std::vector<bool> has_status;
    bool has_image_status = false;
  };

  void charge(std::uint64_t bytes);
  Frame& frame_at(std::uint64_t index);
  std::size_t transform_index(std::string_view name);
  void check_duplicates(const std::vector<std::pair<std::string, std::string>>& fields, const std::string& where) const;
  void use_image_status_alias(Frame& frame) const;
  void settle_poses(Frame& frame, std::size_t index) const;
  [[noreturn]] void fail(const std::string& what) const;

  std::string file_;
  std::string image_status_alias_;
  std::uint64_t memory_ = 0;  ///< an estimate of what was taken, in bytes
  std::vector<Frame> frames_;
  std::vector<std::string> transforms_;
  std::map<std::string, std::size_t, std::less<>> transform_indices_;
  std::vector<std::pair<std::string, std::string>> fields_;
};

/// Throws Error unless a pose may be stored in a recording: all numbers finite; unless its status is other than OK, the
/// bottom row is 0 0 0 1; and unless its name begins with "Image" (pixels to millimetres), the rest is a rotation to
/// 1e-3 in every element of R^T R. `where` begins the message.
void check_pose(const Pose& pose, const std::string& transform, const std::string& where);

/// How a format spells its fields.
struct FieldSyntax {
  std::string_view separator;     ///< between name and value
  std::string_view forbidden;     ///< characters that a name cannot hold; written as '_'
  std::string_view image_status;  ///< name of a frame's image status
};

/// Appends one field and a line end. Control characters in the value, a line end among them, become blanks.
void append_field(std::string& text, std::string_view name, std::string_view value, const FieldSyntax& syntax);

/// Appends the fields of one frame, `Seq_FrameNNNN_Name` each; it has one, perhaps empty, pose for each transform.
void append_frame_fields(std::string& text, const std::vector<std::string>& transforms, const FrameHeader& fields,
                         std::size_t frame, const FieldSyntax& syntax);

}  // namespace fathom
