#include "acquisition/inflate_stream.h"

#include <algorithm>
#include <cassert>
#include <new>

#include "core/error.h"

namespace fathom {

namespace {

constexpr std::size_t kInputBytes = 1 << 16;
constexpr std::size_t kSkipBytes = 1 << 16;
constexpr std::size_t kWindowBytes = 1 << 15;     // deflate refers back no further
constexpr std::size_t kMostPoints = 2048;         // 64 MB of windows; a longer stream gets points further apart
constexpr std::uint64_t kLeastSpacing = 1 << 10;  // less would keep more windows than bytes between them
constexpr int kAnyHeader = 15 + 32;               // zlib's code for: largest window, zlib or gzip
constexpr int kNoHeader = -15;                    // and for the bare deflate stream inside

}  // namespace

void InflateOptions::check() const {
  if (restart_spacing_bytes < kLeastSpacing) throw Error("restart points must be at least 1 KB apart");
}

/// A place in the stream from which inflating goes on.
class InflateStream::Cursor {
 public:
  /// At the stream's beginning.
  Cursor(const InputFile& file, std::uint64_t begin, std::uint64_t end)
      : file_(file), next_input_(begin), end_(end), input_(kInputBytes) {
    if (inflateInit2(&stream_, kAnyHeader) != Z_OK) throw std::bad_alloc();
  }

  Cursor(const InputFile& file, const RestartPoint& point, std::uint64_t end)
      : file_(file), next_input_(point.compressed), end_(end), position_(point.inflated), input_(kInputBytes) {
    if (inflateInit2(&stream_, kNoHeader) != Z_OK) throw std::bad_alloc();
    if (point.bits > 0) {
      std::byte before{};
      file_.read_some(point.compressed - 1, std::span(&before, 1));
      inflatePrime(&stream_, point.bits, std::to_integer<int>(before) >> (8 - point.bits));
    }
    inflateSetDictionary(&stream_, point.window.data(), static_cast<uInt>(point.window.size()));
  }

  ~Cursor() { inflateEnd(&stream_); }
  Cursor(const Cursor&) = delete;
  Cursor& operator=(const Cursor&) = delete;

  std::uint64_t position() const { return position_; }
  bool ended() const { return ended_; }

  /// Inflates once, into at most all of `out`; `produced` says how much. With `stop_at_block` it stops where a block
  /// ends and sets at_block_end.
  Fault inflate_some(std::span<std::byte> out, bool stop_at_block, std::size_t& produced) {
    produced = 0;
    at_block_end_ = false;
    if (ended_) return Fault::ends_early;
    if (stream_.avail_in == 0) refill();
    stream_.next_out = reinterpret_cast<Bytef*>(out.data());
    stream_.avail_out = static_cast<uInt>(out.size());
    const bool had_input = stream_.avail_in > 0;
    const int code = ::inflate(&stream_, stop_at_block ? Z_BLOCK : Z_NO_FLUSH);
    produced = out.size() - stream_.avail_out;
    position_ += produced;
    if (code == Z_STREAM_END) {
      ended_ = true;
      return Fault::none;
    }
    if (code == Z_BUF_ERROR) return had_input ? Fault::none : Fault::ends_early;
    if (code != Z_OK) return Fault::damaged;
    constexpr int kAtBlockEnd = 128;
    constexpr int kInLastBlock = 64;
    at_block_end_ = stop_at_block && (stream_.data_type & kAtBlockEnd) && !(stream_.data_type & kInLastBlock);
    return Fault::none;
  }

  bool at_block_end() const { return at_block_end_; }

  RestartPoint restart_point() {
    RestartPoint point;
    point.inflated = position_;
    point.compressed = next_input_ - stream_.avail_in;
    point.bits = stream_.data_type & 7;
    point.window.resize(kWindowBytes);
    uInt length = kWindowBytes;
    inflateGetDictionary(&stream_, point.window.data(), &length);
    point.window.resize(length);
    return point;
  }

 private:
  void refill() {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(input_.size(), end_ - next_input_));
    const std::size_t count = file_.read_some(next_input_, std::span(input_).first(wanted));
    next_input_ += count;
    stream_.next_in = reinterpret_cast<Bytef*>(input_.data());
    stream_.avail_in = static_cast<uInt>(count);
  }

  const InputFile& file_;
  std::uint64_t next_input_;
  std::uint64_t end_;
  std::uint64_t position_ = 0;
  std::vector<std::byte> input_;
  z_stream stream_ = {};
  bool ended_ = false;
  bool at_block_end_ = false;
};

InflateStream::InflateStream(const InputFile& file, std::uint64_t offset, std::uint64_t compressed_bytes,
                             std::uint64_t inflated_bytes, const InflateOptions& options)
    : file_(file),
      offset_(offset),
      end_(offset + compressed_bytes),
      inflated_bytes_(inflated_bytes),
      spacing_(options.restart_spacing_bytes) {
  options.check();
  frontier_ = std::make_unique<Cursor>(file_, offset_, end_);
}

InflateStream::~InflateStream() = default;

std::uint64_t InflateStream::good_bytes() const { return frontier_->position(); }

void InflateStream::add_restart_point() {
  points_.push_back(frontier_->restart_point());
  if (points_.size() < kMostPoints) return;
  // Every second point goes, and new ones come at twice the distance: memory stays bounded for any length.
  for (std::size_t i = 1; i < points_.size(); i += 2) points_[i / 2] = std::move(points_[i]);
  points_.resize(points_.size() / 2);
  spacing_ *= 2;
}

InflateStream::Fault InflateStream::advance_frontier(std::span<std::byte> out) {
  while (!out.empty()) {
    if (frontier_fault_ != Fault::none) return frontier_fault_;
    const std::uint64_t next_point = (points_.empty() ? 0 : points_.back().inflated) + spacing_;
    const bool point_is_due = frontier_->position() >= next_point;
    // zlib stops at the ends of blocks only when told to, so it is told when a point is due, and not driven past that.
    const std::size_t most =
        point_is_due
            ? out.size()
            : static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), next_point - frontier_->position()));
    std::size_t produced = 0;
    frontier_fault_ = frontier_->inflate_some(out.first(most), point_is_due, produced);
    work_bytes_ += produced;
    out = out.subspan(produced);
    if (frontier_->at_block_end()) add_restart_point();
  }
  return Fault::none;
}

InflateStream::Fault InflateStream::finish_frontier() {
  while (!finished_ && frontier_fault_ == Fault::none) {
    if (frontier_->ended()) {
      finished_ = true;
      break;
    }
    std::byte beyond{};
    std::size_t produced = 0;
    frontier_fault_ = frontier_->inflate_some(std::span(&beyond, 1), false, produced);
    if (produced > 0 && frontier_fault_ == Fault::none) frontier_fault_ = Fault::too_long;
  }
  return frontier_fault_;
}

InflateStream::Cursor& InflateStream::cursor_behind_frontier(std::uint64_t position) {
  const auto after = std::upper_bound(points_.begin(), points_.end(), position,
                                      [](std::uint64_t p, const RestartPoint& point) { return p < point.inflated; });
  const std::uint64_t nearest = after == points_.begin() ? 0 : std::prev(after)->inflated;
  if (behind_ && behind_->position() <= position && behind_->position() >= nearest) return *behind_;
  behind_ = after == points_.begin() ? std::make_unique<Cursor>(file_, offset_, end_)
                                     : std::make_unique<Cursor>(file_, *std::prev(after), end_);
  return *behind_;
}

InflateStream::Fault InflateStream::skip_to(Cursor& cursor, std::uint64_t position) {
  std::array<std::byte, kSkipBytes> skipped;
  while (cursor.position() < position) {
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(skipped.size(), position - cursor.position()));
    const std::span<std::byte> out = std::span(skipped).first(step);
    if (&cursor == frontier_.get()) {
      if (const Fault fault = advance_frontier(out); fault != Fault::none) return fault;
      continue;
    }
    std::size_t produced = 0;
    if (const Fault fault = cursor.inflate_some(out, false, produced); fault != Fault::none) return fault;
    work_bytes_ += produced;
  }
  return Fault::none;
}

InflateStream::Fault InflateStream::read(std::uint64_t position, std::span<std::byte> out) {
  assert(position <= inflated_bytes_ && out.size() <= inflated_bytes_ - position);
  const std::uint64_t end = position + out.size();
  if (position < frontier_->position()) {
    Cursor& cursor = cursor_behind_frontier(position);
    if (const Fault fault = skip_to(cursor, position); fault != Fault::none) return fault;
    while (!out.empty() && cursor.position() < frontier_->position()) {
      const auto step =
          static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), frontier_->position() - cursor.position()));
      std::size_t produced = 0;
      if (const Fault fault = cursor.inflate_some(out.first(step), false, produced); fault != Fault::none) return fault;
      work_bytes_ += produced;
      out = out.subspan(produced);
    }
  }
  if (!out.empty()) {
    const std::uint64_t from = end - out.size();
    if (const Fault fault = skip_to(*frontier_, from); fault != Fault::none) return fault;
    if (const Fault fault = advance_frontier(out); fault != Fault::none) return fault;
  }
  return end == inflated_bytes_ ? finish_frontier() : Fault::none;
}

}  // namespace fathom
