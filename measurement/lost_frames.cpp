#include "measurement/lost_frames.h"

#include <algorithm>
#include <utility>

#include "segmentation/frame_list.h"

namespace fathom {

std::string lost_frames_warning(std::vector<int> lost, int first, int last) {
  const bool start = *std::min_element(lost.begin(), lost.end()) < first;
  const bool end = *std::max_element(lost.begin(), lost.end()) > last;
  std::string text = frame_list(std::move(lost)) + " left out: no valid position is known there";
  if (start || end) text += ", so the organ is not measured";
  if (start) text += " before frame " + std::to_string(first);
  if (end) text += std::string(start ? " nor" : "") + " beyond frame " + std::to_string(last);
  return text;
}

}  // namespace fathom
