#include "registration/fill_holes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "core/error.h"

namespace fathom {

namespace {

constexpr int kMaxGap = 15;
constexpr int kWord = 64;
constexpr int kDirections = 13;
constexpr std::array<std::array<int, 3>, kDirections> kDirection = {{{1, 0, 0},
                                                                     {0, 1, 0},
                                                                     {0, 0, 1},
                                                                     {1, 1, 0},
                                                                     {1, -1, 0},
                                                                     {1, 0, 1},
                                                                     {1, 0, -1},
                                                                     {0, 1, 1},
                                                                     {0, 1, -1},
                                                                     {1, 1, 1},
                                                                     {1, 1, -1},
                                                                     {1, -1, 1},
                                                                     {-1, 1, 1}}};

// Which voxels have a value, 64 of a row in a word. Rows have a word of zeros at both ends, so that they can be
// shifted.
class Bits {
 public:
  explicit Bits(const cv::Mat& filled)
      : columns_(filled.size[2]),
        rows_(filled.size[1]),
        slices_(filled.size[0]),
        words_((columns_ + kWord - 1) / kWord) {
    bits_.resize(static_cast<std::size_t>(slices_) * static_cast<std::size_t>(rows_) * stride());
    // Whether anything is filled, by blocks, for a quick look around a word.
    blocks_y_ = (rows_ + kBlock - 1) / kBlock;
    blocks_.resize(static_cast<std::size_t>((slices_ + kBlock - 1) / kBlock) * static_cast<std::size_t>(blocks_y_) *
                   static_cast<std::size_t>(words_));
    cv::parallel_for_(cv::Range(0, (slices_ + kBlock - 1) / kBlock), [&](const cv::Range& range) {
      for (int z = range.start * kBlock; z < std::min(slices_, range.end * kBlock); ++z) {
        for (int y = 0; y < rows_; ++y) pack(filled.ptr<std::uint8_t>(z, y), y, z);
      }
    });
  }

  int words() const { return words_; }

  /// 64 voxels from column 64 * word + shift on, |shift| < 64; zeros outside.
  std::uint64_t at(int word, int shift, int y, int z) const {
    if (y < 0 || y >= rows_ || z < 0 || z >= slices_) return 0;
    const std::uint64_t* p = row(y, z) + word + 1;
    if (shift == 0) return p[0];
    return shift > 0 ? (p[0] >> shift) | (p[1] << (kWord - shift)) : (p[0] << -shift) | (p[-1] >> (kWord + shift));
  }

  /// Whether anything may be filled within kMaxGap + 1 of a word.
  bool anything_near(int word, int y, int z) const {
    const int last_z = (slices_ + kBlock - 1) / kBlock - 1;
    for (int bz = std::max(0, z / kBlock - 1); bz <= std::min(last_z, z / kBlock + 1); ++bz) {
      for (int by = std::max(0, y / kBlock - 1); by <= std::min(blocks_y_ - 1, y / kBlock + 1); ++by) {
        for (int w = std::max(0, word - 1); w <= std::min(words_ - 1, word + 1); ++w) {
          if (blocks_[block(w, by, bz)] != 0) return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr int kBlock = kMaxGap + 1;

  std::size_t stride() const { return static_cast<std::size_t>(words_) + 2; }
  std::size_t block(int word, int by, int bz) const {
    return (static_cast<std::size_t>(bz) * static_cast<std::size_t>(blocks_y_) + static_cast<std::size_t>(by)) *
               static_cast<std::size_t>(words_) +
           static_cast<std::size_t>(word);
  }
  const std::uint64_t* row(int y, int z) const {
    return bits_.data() +
           (static_cast<std::size_t>(z) * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(y)) * stride();
  }
  void pack(const std::uint8_t* filled, int y, int z) {
    auto* to = const_cast<std::uint64_t*>(row(y, z)) + 1;
    for (int w = 0; w < words_; ++w) {
      std::uint64_t word = 0;
      const int count = std::min(kWord, columns_ - w * kWord);
      for (int i = 0; i < count; ++i) word |= static_cast<std::uint64_t>(filled[w * kWord + i] != 0) << i;
      to[w] = word;
      if (word != 0) blocks_[block(w, y / kBlock, z / kBlock)] = 1;
    }
  }

  int columns_, rows_, slices_, words_, blocks_y_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint8_t> blocks_;
};

// A line through a voxel: `back` steps to one end, `ahead` to the other.
struct Line {
  int direction, back, ahead;
  int squared_length;
};

// All lines, the shortest first.
std::vector<Line> lines_within(int max_gap) {
  std::vector<Line> lines;
  for (int d = 0; d < kDirections; ++d) {
    const auto& v = kDirection[static_cast<std::size_t>(d)];
    const int squared_step = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    for (int length = 2; length * length * squared_step <= (max_gap + 1) * (max_gap + 1); ++length) {
      for (int back = 1; back < length; ++back) {
        lines.push_back({d, back, length - back, length * length * squared_step});
      }
    }
  }
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Line& a, const Line& b) { return a.squared_length < b.squared_length; });
  return lines;
}

template <typename Pixel>
class Filler {
 public:
  Filler(cv::Mat& voxels, cv::Mat& filled, const std::vector<Line>& lines)
      : voxels_(voxels), filled_(filled), lines_(lines), bits_(filled) {}

  std::int64_t slice(int z) const {
    std::int64_t count = 0;
    for (int y = 0; y < voxels_.size[1]; ++y) {
      for (int w = 0; w < bits_.words(); ++w) {
        const int left = voxels_.size[2] - w * kWord;
        const std::uint64_t exists = left >= kWord ? ~std::uint64_t{0} : (std::uint64_t{1} << left) - 1;
        const std::uint64_t empty = exists & ~bits_.at(w, 0, y, z);
        if (empty != 0 && bits_.anything_near(w, y, z)) count += word(w, y, z, empty);
      }
    }
    return count;
  }

 private:
  std::int64_t word(int w, int y, int z, std::uint64_t empty) const {
    std::array<float, kWord> sum;
    std::array<std::uint8_t, kWord> lines;
    std::int64_t count = 0;
    std::uint64_t found = 0;  // on lines of the length at hand
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const Line& line = lines_[i];
      const auto& d = kDirection[static_cast<std::size_t>(line.direction)];
      std::uint64_t hits = empty & bits_.at(w, -line.back * d[0], y - line.back * d[1], z - line.back * d[2]);
      if (hits != 0) hits &= bits_.at(w, line.ahead * d[0], y + line.ahead * d[1], z + line.ahead * d[2]);
      if (hits != 0) {
        const Pixel* from = voxels_.ptr<Pixel>(z - line.back * d[2], y - line.back * d[1]) - line.back * d[0];
        const Pixel* to = voxels_.ptr<Pixel>(z + line.ahead * d[2], y + line.ahead * d[1]) + line.ahead * d[0];
        const float share = static_cast<float>(line.back) / static_cast<float>(line.back + line.ahead);
        for (std::uint64_t rest = hits; rest != 0; rest &= rest - 1) {
          const int bit = std::countr_zero(rest);
          const auto b = static_cast<std::size_t>(bit);
          const int x = w * kWord + bit;
          const auto low = static_cast<float>(from[x]);
          const float value = low + share * (static_cast<float>(to[x]) - low);
          const bool first = (found >> bit & 1) == 0;
          sum[b] = first ? value : sum[b] + value;
          lines[b] = first ? 1 : static_cast<std::uint8_t>(lines[b] + 1);
          found |= std::uint64_t{1} << bit;
        }
      }
      const bool last_of_length = i + 1 == lines_.size() || lines_[i + 1].squared_length != line.squared_length;
      if (found == 0 || !last_of_length) continue;
      for (std::uint64_t rest = found; rest != 0; rest &= rest - 1) {
        const int bit = std::countr_zero(rest);
        const auto b = static_cast<std::size_t>(bit);
        voxels_.ptr<Pixel>(z, y)[w * kWord + bit] =
            static_cast<Pixel>(std::floor(sum[b] / static_cast<float>(lines[b]) + 0.5f));
        filled_.ptr<std::uint8_t>(z, y)[w * kWord + bit] = 255;
      }
      count += std::popcount(found);
      empty &= ~found;
      found = 0;
      if (empty == 0) break;
    }
    return count;
  }

  cv::Mat& voxels_;
  cv::Mat& filled_;
  const std::vector<Line>& lines_;
  Bits bits_;  // of before: what is filled now is no end of a line, so slices may be done in any order
};

template <typename Pixel>
std::int64_t fill(cv::Mat& voxels, cv::Mat& filled, const std::vector<Line>& lines) {
  const Filler<Pixel> filler(voxels, filled, lines);
  std::atomic<std::int64_t> count = 0;
  cv::parallel_for_(cv::Range(0, voxels.size[0]), [&](const cv::Range& range) {
    for (int z = range.start; z < range.end; ++z) count += filler.slice(z);
  });
  return count;
}

}  // namespace

void FillHolesOptions::check() const {
  if (max_gap_voxels < 1 || max_gap_voxels > kMaxGap) {
    throw Error("the longest gap to fill must be 1 to " + std::to_string(kMaxGap) + " voxels");
  }
}

std::int64_t fill_holes(cv::Mat& voxels, cv::Mat& filled, const FillHolesOptions& options) {
  options.check();
  assert(voxels.dims == 3 && filled.dims == 3 && filled.type() == CV_8U && voxels.size == filled.size);
  const std::vector<Line> lines = lines_within(options.max_gap_voxels);
  switch (voxels.type()) {
    case CV_8UC1:
      return fill<std::uint8_t>(voxels, filled, lines);
    case CV_8SC1:
      return fill<std::int8_t>(voxels, filled, lines);
    case CV_16UC1:
      return fill<std::uint16_t>(voxels, filled, lines);
    case CV_16SC1:
      return fill<std::int16_t>(voxels, filled, lines);
    default:
      throw Error("holes are filled in voxels of 8 or 16 bits only");
  }
}

}  // namespace fathom
