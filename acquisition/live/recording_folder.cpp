#include "acquisition/live/recording_folder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <vector>

#include <opencv2/core.hpp>

#include "acquisition/live/append_file.h"
#include "acquisition/live/folder_names.h"
#include "acquisition/live/sweep_lines.h"
#include "acquisition/metaimage.h"
#include "acquisition/sequence_file.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr std::size_t kPieceBytes = 1 << 20;
constexpr std::size_t kLongestFault = 300;

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

std::string shown(const std::filesystem::path& path) {
  constexpr std::size_t kLongestName = 300;
  return printable(path.string(), kLongestName);
}

/// Reads the lines of a sweep twice: to see what is whole, and to write the header.
class FolderFinisher {
 public:
  FolderFinisher(const std::filesystem::path& folder, bool check_pixels)
      : folder_(folder),
        check_pixels_(check_pixels),
        lines_(folder / kSweepLines),
        pixels_(folder / kSweepPixels),
        piece_(kPieceBytes) {}

  FinishedRecording run(const Progress& progress) {
    look(part_of(progress, 0.0, share_of_looking()));
    if (found_.frames == 0) {
      throw Error(shown(folder_) + ": holds no whole frame; there is nothing to recover");
    }
    found_.lost_bytes += pixels_.size() - found_.frames * frame_bytes_;
    found_.lost_bytes += lines_.size() - kept_line_bytes_;
    count_lost_samples();
    write(part_of(progress, share_of_looking(), 1.0));
    return found_;
  }

 private:
  double share_of_looking() const { return check_pixels_ ? 0.9 : 0.5; }

  void look(const Progress& progress) {
    for_each_line(lines_, [&](std::string_view line) {
      // How far the pixels are read is how far the work is.
      if (pixels_.size() > 0)
        report(progress, std::min(1.0, static_cast<double>(end_) / static_cast<double>(pixels_.size())));
      is_good_.push_back(take(line));
      if (is_good_.back()) kept_line_bytes_ += line.size() + 1;
    });
    if (!start_) {
      throw Error(shown(folder_ / kSweepLines) + ": its first line is damaged, and without it pixels cannot be read; " +
                  "nothing was changed");
    }
  }

  bool take(std::string_view line) {
    if (!start_) {
      if (is_good_.empty()) start_ = parse_sweep_start(line);
      if (start_) take_start();
      return start_.has_value();
    }
    if (const auto invalid = parse_invalid_line(line)) {
      invalid_.push_back(*invalid);
      return true;
    }
    if (const auto geometry = parse_geometry_line(line)) {
      if (!geometry_) geometry_ = geometry;
      return true;
    }
    const auto frame = parse_frame_line(line);
    if (!frame || !is_whole(*frame)) return false;
    const LiveFrame& image = frame->tracked.frame;
    if (found_.frames == 0) first_time_s_ = image.time_s;
    found_.duration_s = image.time_s - first_time_s_;
    contiguous_ = contiguous_ && frame->offset == found_.frames * frame_bytes_;
    next_frame_ = frame->frame + 1;
    last_time_s_ = image.time_s;
    end_ = frame->offset + frame_bytes_;
    ++found_.frames;
    for (const NamedPose& pose : frame->tracked.poses) transforms_.add(pose.transform);
    return true;
  }

  void take_start() {
    RecordingHeader header;
    const StatedSizes sizes = {.width = static_cast<std::uint64_t>(start_->width),
                               .height = static_cast<std::uint64_t>(start_->height),
                               .frames = 1,
                               .channels = static_cast<std::uint64_t>(CV_MAT_CN(start_->pixel_type))};
    set_image_format(header, sizes, CV_MAT_DEPTH(start_->pixel_type), lines_);
    frame_bytes_ = frame_bytes(header);
    if (frame_bytes_ == 0) lines_.fail("has images of no pixels; there is nothing to recover");
  }

  // Whether all of a frame is there, and it follows what was found so far.
  bool is_whole(const FrameLine& frame) {
    const bool in_file = frame.bytes == frame_bytes_ && frame.offset >= end_ && frame.offset <= pixels_.size() &&
                         pixels_.size() - frame.offset >= frame_bytes_;
    const double time_s = frame.tracked.frame.time_s;
    if (!in_file || frame.frame < next_frame_ || !(found_.frames == 0 || time_s > last_time_s_)) return false;
    return !check_pixels_ || crc32_of_pixels(frame.offset) == frame.pixels_crc32;
  }

  std::uint32_t crc32_of_pixels(std::uint64_t offset) {
    std::uint32_t crc = 0;
    for_each_piece(offset, [&](std::span<const std::byte> piece) { crc = crc32_of(crc, piece.data(), piece.size()); });
    return crc;
  }

  template <typename Use>
  void for_each_piece(std::uint64_t offset, Use use) {
    for (std::uint64_t done = 0; done < frame_bytes_;) {
      const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(frame_bytes_ - done, piece_.size()));
      const std::size_t count = pixels_.read_some(offset + done, std::span(piece_).first(wanted));
      if (count == 0) return;  // shortened meanwhile: the checksum will tell
      use(std::span<const std::byte>(piece_).first(count));
      done += count;
    }
  }

  void count_lost_samples() {
    if (!is_there(folder_ / kTrackerLines)) return;
    const InputFile samples(folder_ / kTrackerLines);
    std::uint64_t whole = 0;
    for_each_line(samples, [&](std::string_view line) { whole += is_whole_line(line) ? line.size() + 1 : 0; });
    found_.lost_bytes += samples.size() - whole;
  }

  void write(const Progress& progress) {
    std::optional<AtomicFile> copy;
    if (!contiguous_) copy.emplace(folder_ / kRecoveredPixels);
    RecordingHeader header;
    header.width = start_->width;
    header.height = start_->height;
    header.pixel_type = start_->pixel_type;
    auto fields = start_->fields;
    if (geometry_) fields.emplace(fields.begin(), kGeometryFaultField, printable(geometry_->fault, kLongestFault));
    header.fields = usable_fields(fields);
    header.fields.emplace_back("latency_applied_s", "0");
    const MetaImageLayout layout = {.compressed = false,
                                    .pixel_file = contiguous_ ? kSweepPixels : kRecoveredPixels,
                                    .reference_from_voxel = std::nullopt};
    AtomicFile file(folder_ / kSweepHeader);
    file.write(metaimage_preamble(header, static_cast<int>(found_.frames), layout));
    std::size_t index = 0;
    std::size_t written = 0;
    for_each_line(lines_, [&](std::string_view line) {
      if (index >= is_good_.size() || !is_good_[index++]) return;
      const auto frame = parse_frame_line(line);
      if (!frame) return;
      report(progress, static_cast<double>(written) / static_cast<double>(found_.frames));
      std::string text;
      append_frame_fields(text, transforms_.names(), frame_header(*frame), written++, kMetaImageFields);
      file.write(text);
      if (copy) for_each_piece(frame->offset, [&](std::span<const std::byte> piece) { copy->write(piece); });
    });
    file.write(metaimage_closing_line(layout));
    if (copy) {
      AtomicFile::commit_all({&*copy, &file});
    } else {
      file.commit();
    }
    report(progress, 1.0);
  }

  FrameHeader frame_header(const FrameLine& line) {
    FrameHeader header;
    header.time_s = line.tracked.frame.time_s;
    header.image_status = plain_status(line.tracked.frame.status);
    header.poses.resize(transforms_.names().size());
    for (const NamedPose& pose : line.tracked.poses) {
      if (const auto index = transforms_.index(pose.transform)) header.poses[*index] = storable(pose);
    }
    const bool marked = std::any_of(invalid_.begin(), invalid_.end(), [&](const InvalidLine& range) {
      return line.frame >= range.first && line.frame <= range.last;
    });
    const bool has_no_place = geometry_ && line.tracked.frame.time_s >= geometry_->since_s;
    if (marked || has_no_place) header.image_status = "INVALID";
    header.fields = usable_fields(line.tracked.frame.fields);
    header.fields.emplace_back(kSweepField, std::to_string(line.sweep));
    found_.invalid_frames += header.image_valid() && line.tracked.tracked ? 0 : 1;
    return header;
  }

  std::filesystem::path folder_;
  bool check_pixels_;
  InputFile lines_;
  InputFile pixels_;
  std::vector<std::byte> piece_;
  std::optional<SweepStart> start_;
  std::uint64_t frame_bytes_ = 0;
  std::vector<bool> is_good_;  // of the lines
  std::vector<InvalidLine> invalid_;
  std::optional<GeometryLine> geometry_;  // the first
  UsableTransforms transforms_;
  FinishedRecording found_;
  std::uint64_t kept_line_bytes_ = 0;
  std::uint64_t next_frame_ = 0;
  std::uint64_t end_ = 0;  // of the last frame's pixels
  double first_time_s_ = 0.0;
  double last_time_s_ = 0.0;
  bool contiguous_ = true;
};

}  // namespace

bool is_recording_folder(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored)) return false;
  return is_there(path / kSweepHeader) || is_there(path / kSweepLines) || is_there(path / kSweepPixels);
}

std::filesystem::path finished_header(const std::filesystem::path& folder) {
  if (is_there(folder / kSweepHeader)) return folder / kSweepHeader;
  if (!is_recording_folder(folder)) {
    throw Error(shown(folder) + ": is a folder without a recording; give a recording, or a folder with " +
                kSweepHeader);
  }
  if (is_being_written(folder / kSweepLines)) {
    throw Error(shown(folder) + ": is being recorded; open it when the recording has ended");
  }
  throw Error(shown(folder) + ": the recording was cut off before it was finished; run `fathom recover " +
              shown(folder) + "`");
}

FinishedRecording finish_folder(const std::filesystem::path& folder, bool check_pixels, const Progress& progress) {
  return FolderFinisher(folder, check_pixels).run(progress);
}

FinishedRecording recover_recording(const std::filesystem::path& folder, const Progress& progress) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw Error(shown(folder) + ": is no folder; name the folder that was recorded into");
  }
  if (is_there(folder / kSweepHeader)) {
    const auto recording = open_recording(folder / kSweepHeader);
    FinishedRecording found;
    found.was_finished = true;
    found.frames = static_cast<std::uint64_t>(recording->header().frame_count());
    return found;
  }
  if (!is_recording_folder(folder)) finished_header(folder);
  if (is_being_written(folder / kSweepLines)) {
    throw Error(shown(folder) + ": is being recorded; end the recording first");
  }
  FinishedRecording found = finish_folder(folder, true, progress);
  std::filesystem::remove(folder / kReservedSpace, ignored);
  return found;
}

void for_each_sample(const std::filesystem::path& folder, const std::function<void(const TrackerSample&)>& use) {
  const InputFile file(folder / kTrackerLines);
  for_each_line(file, [&](std::string_view line) {
    if (const auto sample = parse_sample_line(line)) use(*sample);
  });
}

}  // namespace fathom
