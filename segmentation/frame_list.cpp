#include "segmentation/frame_list.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace fathom {

namespace {
constexpr std::size_t kMostRuns = 6;  // more make a message that nobody reads
}

std::string frame_list(std::vector<int> frames) {
  assert(!frames.empty());
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  if (frames.size() == 1) return "frame " + std::to_string(frames.front());

  std::vector<std::string> runs;
  std::size_t left = frames.size();
  for (std::size_t i = 0; i < frames.size() && runs.size() < kMostRuns;) {
    std::size_t last = i;
    while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
    if (last == i + 1) last = i;  // two neighbours read better one by one
    runs.push_back(std::to_string(frames[i]) + (last > i ? " to " + std::to_string(frames[last]) : ""));
    left -= last - i + 1;
    i = last + 1;
  }
  if (left > 0) runs.push_back(std::to_string(left) + " more");
  std::string text = "frames " + runs.front();
  for (std::size_t i = 1; i < runs.size(); ++i) text += (i + 1 < runs.size() ? ", " : " and ") + runs[i];
  return text;
}

}  // namespace fathom
