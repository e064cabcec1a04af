#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/progress.h"

namespace fathom {

/// A transform that a tracker reported for one frame, exactly as stored: a 4x4 matrix in millimetres and a status.
struct Pose {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  std::string status;  ///< "OK", "INVALID", "MISSING", ...; empty where the file states none, which counts as OK

  bool valid() const { return status.empty() || status == "OK"; }
  bool operator==(const Pose&) const = default;
};

/// What is known of one frame besides its pixels.
struct FrameHeader {
  std::optional<double> time_s;            ///< stamp of the image; empty where the file has none
  std::string image_status;                ///< as stored; empty where the file states none, which counts as OK
  std::vector<std::optional<Pose>> poses;  ///< one for each of RecordingHeader::transforms; empty: not recorded here
  std::vector<std::pair<std::string, std::string>> fields;  ///< every other field of the frame, kept as read

  bool image_valid() const { return image_status.empty() || image_status == "OK"; }
};

/// What is known of a recording besides its pixels.
struct RecordingHeader {
  int width = 0;       ///< pixels; 0 in a recording of poses only
  int height = 0;      ///< pixels; 0 in a recording of poses only
  int pixel_type = 0;  ///< OpenCV's type: CV_8UC1, CV_8SC1, CV_16UC1, CV_16SC1, CV_32FC1, CV_64FC1, CV_8UC3 (RGB)
  std::vector<std::string> transforms;  ///< names as stored, without the suffix "Transform": "ProbeToTracker"
  std::vector<FrameHeader> frames;      ///< numbered from 0 as stored
  std::vector<std::pair<std::string, std::string>> fields;  ///< other header fields, kept as read
  std::vector<std::string> warnings;                        ///< what the reader had to assume, for the user

  int frame_count() const { return static_cast<int>(frames.size()); }
  bool has_images() const { return width > 0 && height > 0; }
  /// Index into `transforms` and FrameHeader::poses.
  std::optional<std::size_t> transform_index(const std::string& name) const;
};

/// An ordered list of frames, read from disk, being written, held in memory or simulated.
class Recording {
 public:
  virtual ~Recording() = default;

  const RecordingHeader& header() const { return header_; }

  /// The file or source, as named in messages.
  const std::string& name() const { return name_; }

  /// The pixels of a frame in MF orientation: x to the right, y away from the probe; RGB order where coloured. The
  /// matrix may be a read-only view of the file that lives as long as the recording: clone it before writing to it.
  /// May be called from several threads. Throws Error when `frame` is not in [0, frame_count), when the recording has
  /// no images, or when the stored pixels are damaged.
  virtual cv::Mat image(int frame) const = 0;

 protected:
  Recording(std::string name, RecordingHeader header) : header_(std::move(header)), name_(std::move(name)) {}

  /// Throws Error unless `frame` exists and has an image.
  void require_frame(int frame) const;
  /// Throws Error with the recording's name before `what`.
  [[noreturn]] void fail(const std::string& what) const;

  RecordingHeader header_;
  std::string name_;
};

/// Frames held in memory.
class MemoryRecording : public Recording {
 public:
  /// `images` is empty for a recording of poses only, else one image of the header's size and type for each frame.
  /// Throws Error unless that is so and every frame has one (perhaps empty) pose for each transform.
  MemoryRecording(std::string name, RecordingHeader header, std::vector<cv::Mat> images);
  cv::Mat image(int frame) const override;

 private:
  std::vector<cv::Mat> images_;
};

/// Opens a sequence metafile (`.mha`, `.mhd` with its raw file, `.nrrd`; the file's first bytes decide, not its name),
/// or a recording folder.
///
/// Uncompressed pixels are memory-mapped; compressed ones are inflated as they are asked for, with restart points.
/// Throws Error on any fault that can be found without reading all pixels: the header is checked whole, sizes are
/// checked against the file's length before memory is taken, transforms must be finite and, unless marked invalid or
/// starting at the image ("Image..."), rigid to 1e-3.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& path);

struct WriteOptions {
  bool compress = false;  ///< zlib; uncompressed files open faster, as they can be memory-mapped
};

/// Writes a recording in the format named by the extension of `path`: .mha, .mhd (with a .raw beside it, or .zraw where
/// compressed) or .nrrd. Pixels in MF orientation; poses, times, statuses and other fields as in the header, except
/// fields that say how another file was stored. One frame is held at a time. The file appears whole or not at all.
/// Throws Error for another extension, for poses and times that could not be read back, and when the disk fails;
/// Cancelled.
void write_recording(const Recording& recording, const std::filesystem::path& path, const WriteOptions& options = {},
                     const Progress& progress = {});

}  // namespace fathom
