#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "acquisition/live/live_source.h"
#include "core/progress.h"

namespace fathom {

// A recording folder: `sweep.raw`, `sweep.jsonl` and `tracker.jsonl` grow while recording (see sweep_lines.h);
// `sweep.mhd` is written at the end and names the pixels of `sweep.raw`.

inline constexpr const char* kSweepHeader = "sweep.mhd";
inline constexpr const char* kSweepPixels = "sweep.raw";
inline constexpr const char* kSweepLines = "sweep.jsonl";
inline constexpr const char* kTrackerLines = "tracker.jsonl";
inline constexpr const char* kRecoveredPixels = "recovered.raw";  ///< good frames, where damaged ones lay between them

/// Whether `path` is a folder with a recording, finished or not.
bool is_recording_folder(const std::filesystem::path& path);

/// The header of a finished recording. Throws Error where `folder` is no recording folder, is being recorded, or was
/// never finished, with how to recover it.
std::filesystem::path finished_header(const std::filesystem::path& folder);

/// What a recording folder holds.
struct FinishedRecording {
  std::uint64_t frames = 0;
  std::uint64_t invalid_frames = 0;  ///< of these: image, place, or marked so
  double duration_s = 0.0;           ///< from the first frame's stamp to the last
  std::uint64_t lost_bytes = 0;      ///< in the folder's files, of nothing that could be read
  bool was_finished = false;         ///< before: nothing was changed
};

/// Writes `sweep.mhd` from the other files, as far as they go. With `check_pixels` every frame's pixels are read and
/// compared with their checksum, and damaged frames left out; the good ones behind them are copied to `recovered.raw`.
/// No other file is changed. Throws Error where there is no whole frame, or the disk fails; Cancelled.
FinishedRecording finish_folder(const std::filesystem::path& folder, bool check_pixels, const Progress& progress = {});

/// What a crash, a power cut or a full disk has left, made readable. A finished recording stays as it is. Throws Error
/// as finish_folder, and where `folder` is no recording or is still being recorded.
FinishedRecording recover_recording(const std::filesystem::path& folder, const Progress& progress = {});

/// Calls `use` with every raw sample of the tracker that is whole, as it came. Throws Error where the file is missing.
void for_each_sample(const std::filesystem::path& folder, const std::function<void(const TrackerSample&)>& use);

}  // namespace fathom
