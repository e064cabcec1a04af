#include "segmentation/contours.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/numbers.h"
#include "segmentation/contour_entries.h"
#include "segmentation/frame_list.h"

namespace fathom {

namespace {

constexpr double kFarOutside = 0.25;       // of the image's size
constexpr std::size_t kLongestName = 200;  // bytes

// Recording and frame.
using Place = std::pair<int, int>;

void append(std::string& text, double value) {
  assert(std::isfinite(value));
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, end);
}

void append(std::string& text, const Eigen::Vector2d& point) {
  text += '[';
  append(text, point.x());
  text += ", ";
  append(text, point.y());
  text += ']';
}

std::string entry_start(int frame, int recording) {
  std::string text = "{\"frame\": " + std::to_string(frame);
  if (recording != 0) text += ", \"recording\": " + std::to_string(recording);
  return text;
}

// The structure's contours, extremities and marks, each on a line of its own, by recording and frame.
std::vector<std::string> entries(const Structure& structure) {
  std::vector<std::tuple<Place, std::size_t, std::string>> ordered;
  const auto add = [&](const auto& items) {
    for (const auto& item : items) {
      ordered.emplace_back(Place(item.recording, item.frame), ordered.size(), entry_json(item));
    }
  };
  add(structure.contours);
  add(structure.extremities);
  add(structure.absent);
  std::sort(ordered.begin(), ordered.end());
  std::vector<std::string> lines;
  lines.reserve(ordered.size());
  for (auto& [place, order, text] : ordered) lines.push_back(std::move(text));
  return lines;
}

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

std::optional<std::string> name_fault(const std::string& name) {
  if (name.empty()) return "is empty";
  if (name.size() > kLongestName) return "is too long for a name";
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto byte = static_cast<unsigned char>(name[i]);
    // A terminal obeys those from U+0080 to U+009F too, which UTF-8 writes as two bytes.
    const bool high = byte == 0xc2 && i + 1 < name.size() && static_cast<unsigned char>(name[i + 1]) < 0xa0;
    if (byte < 0x20 || byte == 0x7f || high) return "must not contain control characters";
  }
  return std::nullopt;
}

std::string entry_json(const Contour& contour) {
  std::string text = entry_start(contour.frame, contour.recording);
  text += contour.closed ? ", \"closed\": true" : ", \"closed\": false";
  if (contour.confidence) {
    text += ", \"confidence\": ";
    append(text, *contour.confidence);
  }
  text += ", \"points\": [";
  for (std::size_t i = 0; i < contour.points_px.size(); ++i) {
    if (i > 0) text += ", ";
    append(text, contour.points_px[i]);
  }
  return text + "]}";
}

std::string entry_json(const Extremity& extremity) {
  std::string text = entry_start(extremity.frame, extremity.recording) + ", \"point\": ";
  append(text, extremity.point_px);
  return text + "}";
}

std::string entry_json(const AbsentMark& mark) {
  return entry_start(mark.frame, mark.recording) + ", \"absent\": true}";
}

std::string structure_json(const Structure& structure, const std::string& line_start) {
  std::string text = "{\"name\": " + quoted(structure.name) + ", \"color\": " + quoted(structure.color);
  if (structure.opacity != kUsualOpacity) text += ", \"opacity\": " + format_real(structure.opacity);
  text += ", \"contours\": [";
  const std::vector<std::string> lines = entries(structure);
  for (std::size_t k = 0; k < lines.size(); ++k) text += (k > 0 ? "," + line_start : line_start) + lines[k];
  return text + "]}";
}

std::string contours_json(const std::vector<Structure>& structures) {
  std::string text = "{\"fathom_contours\": 1, \"structures\": [";
  for (std::size_t i = 0; i < structures.size(); ++i) {
    text += (i > 0 ? ",\n" : "\n") + structure_json(structures[i], "\n  ");
  }
  return text + "\n]}\n";
}

void require_measurable(const std::vector<Structure>& structures, int frame_count, const std::string& file) {
  require_measurable(structures, std::vector<int>{frame_count}, OpenContours::kRefuse, file);
}

void require_measurable(const std::vector<Structure>& structures, const std::vector<int>& frame_counts,
                        OpenContours open, const std::string& file) {
  for (const Structure& structure : structures) {
    const auto fail = [&](int frame, const std::string& what) {
      throw Error(file + ": structure " + structure.name + ": frame " + std::to_string(frame) + " " + what);
    };
    const auto require_place = [&](int frame, int recording) {
      if (recording < 0 || static_cast<std::size_t>(recording) >= frame_counts.size()) {
        const bool alone = frame_counts.size() == 1;
        fail(frame, "stands on recording " + std::to_string(recording) + " of an exam" +
                        (alone ? "; give the contours that were drawn on this recording alone"
                               : ", which has no such recording; give the contours that were drawn in this exam"));
      }
      const int frame_count = frame_counts[static_cast<std::size_t>(recording)];
      if (frame < 0 || frame >= frame_count) {
        fail(frame, "is not in the recording, which has " + std::to_string(frame_count) +
                        " frames, numbered from 0; give the contours that were drawn on this recording");
      }
    };
    for (const Contour& contour : structure.contours) {
      require_place(contour.frame, contour.recording);
      if (!contour.closed && open == OpenContours::kRefuse) {
        fail(contour.frame, "has an open contour, which encloses no area; close it, or leave it out");
      }
    }
    for (const AbsentMark& mark : structure.absent) require_place(mark.frame, mark.recording);
    for (const Extremity& extremity : structure.extremities) require_place(extremity.frame, extremity.recording);
  }
}

std::optional<std::string> outside_image_warning(const Structure& structure, int width, int height) {
  const Eigen::Array2d size(width, height);
  const auto far_outside = [&](const Eigen::Vector2d& point) {
    return (point.array() < -kFarOutside * size).any() || (point.array() > (1.0 + kFarOutside) * size).any();
  };
  std::vector<int> frames;
  for (const Contour& contour : structure.contours) {
    if (std::any_of(contour.points_px.begin(), contour.points_px.end(), far_outside)) frames.push_back(contour.frame);
  }
  for (const Extremity& extremity : structure.extremities) {
    if (far_outside(extremity.point_px)) frames.push_back(extremity.frame);
  }
  if (frames.empty()) return std::nullopt;
  return "the outlines of " + frame_list(std::move(frames)) +
         " reach far out of the image; check that they were drawn on this recording";
}

}  // namespace fathom
