#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <zlib.h>

#include "core/input_file.h"

namespace fathom {

struct InflateOptions {
  /// Distance of restart points in inflated bytes. A point takes 32 KB and makes every byte behind it reachable without
  /// inflating what lies before; 16 MB take some 50 ms.
  std::uint64_t restart_spacing_bytes = 16 << 20;

  /// Throws Error when a value is out of range.
  void check() const;
};

/// Random access to the bytes of a zlib or gzip stream. Restart points are made while the stream is first read; reading
/// on never goes back, and any place that was passed before is reached from the nearest point. Not thread-safe.
class InflateStream {
 public:
  enum class Fault {
    none,
    ends_early,  ///< the stream ends, or the file does, before the bytes asked for
    damaged,     ///< the bytes asked for cannot be inflated, or the checksum of all bytes is wrong
    too_long     ///< the stream holds more bytes than expected
  };

  /// The stream lies in `file` from `offset`, `compressed_bytes` long, and should hold `inflated_bytes`. `file` must
  /// outlive this object.
  InflateStream(const InputFile& file, std::uint64_t offset, std::uint64_t compressed_bytes,
                std::uint64_t inflated_bytes, const InflateOptions& options = {});
  ~InflateStream();
  InflateStream(const InflateStream&) = delete;
  InflateStream& operator=(const InflateStream&) = delete;

  /// Fills `out` with the inflated bytes from `position`; both must lie within inflated_bytes. Whoever reads the last
  /// byte is also told of a wrong checksum. After a fault, bytes before the damage can still be read.
  Fault read(std::uint64_t position, std::span<std::byte> out);

  /// How far the stream was inflated without a fault.
  std::uint64_t good_bytes() const;

  /// Restart points made so far.
  std::size_t restart_points() const { return points_.size(); }
  /// Bytes inflated so far, those inflated again after a restart among them: what access costs.
  std::uint64_t work_bytes() const { return work_bytes_; }

 private:
  /// What inflating needs to begin in the middle.
  struct RestartPoint {
    std::uint64_t inflated = 0;    ///< position in the inflated bytes
    std::uint64_t compressed = 0;  ///< position in the file
    int bits = 0;                  ///< of the byte before `compressed` that are not used up yet
    std::vector<Bytef> window;     ///< the inflated bytes before, that later ones refer to
  };
  class Cursor;

  Fault advance_frontier(std::span<std::byte> out);
  Fault finish_frontier();
  Fault skip_to(Cursor& cursor, std::uint64_t position);
  Cursor& cursor_behind_frontier(std::uint64_t position);
  void add_restart_point();

  const InputFile& file_;
  std::uint64_t offset_;
  std::uint64_t end_;
  std::uint64_t inflated_bytes_;
  std::uint64_t spacing_;
  std::unique_ptr<Cursor> frontier_;  ///< reads on from the furthest place, and checks the checksum in the end
  std::unique_ptr<Cursor> behind_;    ///< reads what the frontier has passed
  Fault frontier_fault_ = Fault::none;
  bool finished_ = false;
  std::vector<RestartPoint> points_;
  std::uint64_t work_bytes_ = 0;
};

}  // namespace fathom
