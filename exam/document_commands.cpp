#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "core/error.h"
#include "core/printable.h"
#include "exam/document.h"

namespace fathom {

namespace {

constexpr double kFarthest_px = 1e6;             // as the reader of contours files allows
constexpr std::size_t kMostPoints = 1'000'000;   // in one contour, as there
constexpr std::size_t kMostInExam = 1'900'000;   // points of all structures: that reader stops at two million
constexpr std::size_t kLongestText = 1'000'000;  // bytes
constexpr std::array<const char*, 8> kPalette{"#33ccff", "#ffb000", "#7fd13b", "#ff5c8a",
                                              "#b48cff", "#ffe66d", "#2ec4b6", "#ff8552"};

template <typename Item>
std::size_t place_for(const std::vector<Item>& list, const Item& item) {
  const auto after = std::upper_bound(list.begin(), list.end(), item, [](const Item& a, const Item& b) {
    return std::pair(a.recording, a.frame) < std::pair(b.recording, b.frame);
  });
  return static_cast<std::size_t>(after - list.begin());
}

template <typename Item>
std::optional<std::size_t> index_at(const std::vector<Item>& list, int recording, int frame) {
  const auto found = std::find_if(list.begin(), list.end(),
                                  [&](const Item& item) { return item.recording == recording && item.frame == frame; });
  return found == list.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - list.begin()));
}

void require_point(const Eigen::Vector2d& point_px) {
  if (point_px.allFinite() && point_px.cwiseAbs().maxCoeff() <= kFarthest_px) return;
  throw Error("a point must lie within a million pixels of the image; place it again");
}

// Files keep no sign of zero.
Eigen::Vector2d positive_zero(const Eigen::Vector2d& point_px) { return (point_px.array() + 0.0).matrix(); }

void require_text(const std::string& what, const std::string& text) {
  const std::string stored = nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (nlohmann::json::parse(stored) != text) throw Error(what + " is not UTF-8; type it again");
}

void require_name(const std::string& name, const std::vector<Structure>& structures, std::size_t except) {
  if (const auto fault = name_fault(name)) throw Error("the structure's name " + *fault + "; choose another");
  require_text("the structure's name", name);
  for (std::size_t i = 0; i < structures.size(); ++i) {
    if (i == except || structures[i].name != name) continue;
    throw Error("another structure is called " + printable(name) + "; choose another name");
  }
}

void require_color(const std::string& color) {
  const auto hexadecimal = [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; };
  if (color.size() == 7 && color[0] == '#' && std::all_of(color.begin() + 1, color.end(), hexadecimal)) return;
  throw Error(printable(color) + " is not a colour; give one such as #33ccff");
}

void require_opacity(double opacity) {
  if (!(opacity >= 0.0 && opacity <= 1.0)) throw Error("an opacity must lie between 0 and 1");
}

StyleChange style_change(std::size_t structure, const Structure& of, StructureStyle to) {
  return {structure, {of.name, of.color, of.opacity}, std::move(to)};
}

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

}  // namespace

const Structure& Document::structure_at(std::size_t structure) const {
  if (structure < content_.structures.size()) return content_.structures[structure];
  throw Error("there is no structure " + std::to_string(structure + 1) + "; choose one that there is");
}

const Contour& Document::contour_at(std::size_t structure, std::size_t contour) const {
  const Structure& of = structure_at(structure);
  if (contour < of.contours.size()) return of.contours[contour];
  throw Error(of.name + " has no contour " + std::to_string(contour + 1) + "; choose one that there is");
}

void Document::require_frame(int recording, int frame) const {
  const auto count = scan_->recordings.size();
  if (recording < 0 || static_cast<std::size_t>(recording) >= count) {
    throw Error("there is no recording " + std::to_string(recording + 1) + "; choose one that there is");
  }
  const int frames = scan_->recordings[static_cast<std::size_t>(recording)]->header().frame_count();
  if (frame >= 0 && frame < frames) return;
  throw Error("frame " + std::to_string(frame) + " is not in the recording, which has " + std::to_string(frames) +
              ", numbered from 0; choose one of them");
}

// `instead_of`: how many points the contour takes the place of.
void Document::require_contour(const Contour& contour, std::size_t instead_of) const {
  require_frame(contour.recording, contour.frame);
  const std::size_t points = contour.points_px.size();
  if (points < 3) throw Error("an outline needs at least three points; go on drawing");
  if (points > kMostPoints) throw Error("an outline has more than a million points; thin them out");
  for (const Eigen::Vector2d& point : contour.points_px) require_point(point);
  if (contour.confidence && !(*contour.confidence >= 0.0 && *contour.confidence <= 1.0)) {
    throw Error("an outline's confidence must lie between 0 and 1");
  }
  std::size_t all = points;
  for (const Structure& structure : content_.structures) {
    for (const Contour& other : structure.contours) all += other.points_px.size();
  }
  if (all > kMostInExam + instead_of) {
    throw Error("all outlines together have more points than an exam can hold (1900000); thin them out");
  }
}

void Document::require_not_outlined(const Structure& structure, int recording, int frame) const {
  if (!index_at(structure.contours, recording, frame)) return;
  throw Error("frame " + std::to_string(frame) + " is outlined; delete its outlines of " + structure.name + " first");
}

std::size_t Document::add_structure(Structure structure) {
  require_name(structure.name, content_.structures, kNone);
  if (structure.color.empty()) structure.color = kPalette[content_.structures.size() % kPalette.size()];
  require_color(structure.color);
  require_opacity(structure.opacity);
  Structure empty{structure.name, structure.color, {}, {}, {}, structure.opacity};
  put_in_order(structure);
  for (const Contour& contour : structure.contours) require_contour(contour, 0);
  const auto require_alone = [&](const auto& marks, const char* what) {
    for (const auto& mark : marks) {
      require_frame(mark.recording, mark.frame);
      require_not_outlined(structure, mark.recording, mark.frame);
      if (std::count_if(marks.begin(), marks.end(), [&](const auto& other) {
            return other.frame == mark.frame && other.recording == mark.recording;
          }) > 1) {
        throw Error("frame " + std::to_string(mark.frame) + " is " + what + " twice; keep one of the marks");
      }
    }
  };
  require_alone(structure.absent, "marked absent");
  require_alone(structure.extremities, "an extremity");
  for (const Extremity& extremity : structure.extremities) {
    require_point(extremity.point_px);
    if (!index_at(structure.absent, extremity.recording, extremity.frame)) continue;
    throw Error("frame " + std::to_string(extremity.frame) + " is an extremity and marked absent; keep one of them");
  }
  const std::size_t index = content_.structures.size();
  change("Add structure", StructureChange{index, next_id_++, std::nullopt, std::move(structure)});
  return index;
}

void Document::remove_structure(std::size_t structure) {
  const Structure& of = structure_at(structure);
  change("Delete structure", StructureChange{structure, content_.ids[structure], of, std::nullopt});
}

void Document::rename_structure(std::size_t structure, const std::string& name) {
  const Structure& of = structure_at(structure);
  require_name(name, content_.structures, structure);
  change("Rename structure", style_change(structure, of, {name, of.color, of.opacity}));
}

void Document::recolor_structure(std::size_t structure, const std::string& color) {
  const Structure& of = structure_at(structure);
  require_color(color);
  change("Change colour", style_change(structure, of, {of.name, color, of.opacity}));
}

void Document::set_opacity(std::size_t structure, double opacity) {
  const Structure& of = structure_at(structure);
  require_opacity(opacity);
  change("Change opacity", style_change(structure, of, {of.name, of.color, opacity}));
}

std::size_t Document::add_contour(std::size_t structure, Contour contour) {
  const Structure& of = structure_at(structure);
  require_contour(contour, 0);
  for (Eigen::Vector2d& point : contour.points_px) point = positive_zero(point);
  const bool alone = !in_action();
  if (alone) begin_action("Draw outline");
  // The outline says more than the mark.
  set_absent(structure, contour.recording, contour.frame, false);
  set_extremity(structure, contour.recording, contour.frame, std::nullopt);
  const std::size_t index = place_for(of.contours, contour);
  change("Draw outline", ItemChange<Contour>{structure, index, std::nullopt, std::move(contour)});
  if (alone) end_action();
  return index;
}

void Document::replace_contour(std::size_t structure, std::size_t contour, Contour by) {
  const Contour& old = contour_at(structure, contour);
  require_contour(by, old.points_px.size());
  if (by.frame != old.frame || by.recording != old.recording) {
    throw Error("an outline stays on its frame; delete it and draw another");
  }
  for (Eigen::Vector2d& point : by.points_px) point = positive_zero(point);
  change("Change outline", ItemChange<Contour>{structure, contour, old, std::move(by)});
}

void Document::remove_contour(std::size_t structure, std::size_t contour) {
  change("Delete outline", ItemChange<Contour>{structure, contour, contour_at(structure, contour), std::nullopt});
}

void Document::replace_points(const char* name, std::size_t structure, std::size_t contour, Polygon points_px) {
  Contour by = contour_at(structure, contour);
  by.points_px = std::move(points_px);
  by.confidence.reset();  // it was of the outline as it was made
  require_contour(by, contour_at(structure, contour).points_px.size());
  change(name, ItemChange<Contour>{structure, contour, contour_at(structure, contour), std::move(by)});
}

void Document::move_point(std::size_t structure, std::size_t contour, std::size_t point, const Eigen::Vector2d& to_px) {
  Polygon points = contour_at(structure, contour).points_px;
  if (point >= points.size()) throw Error("the outline has no such point; choose one that it has");
  points[point] = positive_zero(to_px);
  replace_points("Move point", structure, contour, std::move(points));
}

void Document::insert_point(std::size_t structure, std::size_t contour, std::size_t before,
                            const Eigen::Vector2d& point_px) {
  Polygon points = contour_at(structure, contour).points_px;
  if (before > points.size()) throw Error("the outline has no such point; choose one that it has");
  points.insert(points.begin() + static_cast<std::ptrdiff_t>(before), positive_zero(point_px));
  replace_points("Insert point", structure, contour, std::move(points));
}

void Document::remove_point(std::size_t structure, std::size_t contour, std::size_t point) {
  Polygon points = contour_at(structure, contour).points_px;
  if (point >= points.size()) throw Error("the outline has no such point; choose one that it has");
  if (points.size() == 3) throw Error("an outline of three points cannot lose one; delete the outline");
  points.erase(points.begin() + static_cast<std::ptrdiff_t>(point));
  replace_points("Delete point", structure, contour, std::move(points));
}

void Document::set_closed(std::size_t structure, std::size_t contour, bool closed) {
  Contour by = contour_at(structure, contour);
  by.closed = closed;
  change(closed ? "Close outline" : "Open outline",
         ItemChange<Contour>{structure, contour, contour_at(structure, contour), std::move(by)});
}

void Document::set_absent(std::size_t structure, int recording, int frame, bool absent) {
  const Structure& of = structure_at(structure);
  require_frame(recording, frame);
  const auto index = index_at(of.absent, recording, frame);
  if (absent == index.has_value()) return;
  if (!absent) {
    change("Remove mark", ItemChange<AbsentMark>{structure, *index, of.absent[*index], std::nullopt});
    return;
  }
  require_not_outlined(of, recording, frame);
  const bool alone = !in_action();
  if (alone) begin_action("Mark as absent");
  set_extremity(structure, recording, frame, std::nullopt);
  const AbsentMark mark{frame, recording};
  change("Mark as absent", ItemChange<AbsentMark>{structure, place_for(of.absent, mark), std::nullopt, mark});
  if (alone) end_action();
}

void Document::set_extremity(std::size_t structure, int recording, int frame,
                             const std::optional<Eigen::Vector2d>& point_px) {
  const Structure& of = structure_at(structure);
  require_frame(recording, frame);
  const auto index = index_at(of.extremities, recording, frame);
  if (!index && !point_px) return;
  if (point_px) require_point(*point_px);
  if (index) {
    const Extremity& old = of.extremities[*index];
    std::optional<Extremity> by;
    if (point_px) by = Extremity{frame, positive_zero(*point_px), recording};
    change(by ? "Move extremity" : "Remove mark", ItemChange<Extremity>{structure, *index, old, by});
    return;
  }
  require_not_outlined(of, recording, frame);
  const bool alone = !in_action();
  if (alone) begin_action("Mark extremity");
  set_absent(structure, recording, frame, false);
  const Extremity by{frame, positive_zero(*point_px), recording};
  change("Mark extremity", ItemChange<Extremity>{structure, place_for(of.extremities, by), std::nullopt, by});
  if (alone) end_action();
}

void Document::set_text(ExamText text, const std::string& to) {
  require_text("the text", to);
  if (to.size() > kLongestText) throw Error("the text is longer than a million characters; put it into a file");
  change("Change text", TextChange{text, this->text(text), to});
}

}  // namespace fathom
