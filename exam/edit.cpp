#include "exam/edit.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "registration/dividing_planes.h"

namespace fathom {

namespace {

template <typename Item>
constexpr std::vector<Item> Structure::*kList = nullptr;
template <>
constexpr std::vector<Contour> Structure::*kList<Contour> = &Structure::contours;
template <>
constexpr std::vector<Extremity> Structure::*kList<Extremity> = &Structure::extremities;
template <>
constexpr std::vector<AbsentMark> Structure::*kList<AbsentMark> = &Structure::absent;

bool same(const Contour& a, const Contour& b) {
  return a.frame == b.frame && a.recording == b.recording && a.closed == b.closed && a.confidence == b.confidence &&
         a.points_px == b.points_px;
}

bool same(const Extremity& a, const Extremity& b) {
  return a.frame == b.frame && a.recording == b.recording && a.point_px == b.point_px;
}

bool same(const AbsentMark& a, const AbsentMark& b) { return a.frame == b.frame && a.recording == b.recording; }

bool same(const DividingPlane& a, const DividingPlane& b) { return a.coeffs() == b.coeffs(); }

template <typename Item>
bool same(const std::vector<Item>& a, const std::vector<Item>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Item& left, const Item& right) { return same(left, right); });
}

bool same(const Structure& a, const Structure& b) {
  return a.name == b.name && a.color == b.color && a.opacity == b.opacity && same(a.contours, b.contours) &&
         same(a.extremities, b.extremities) && same(a.absent, b.absent);
}

template <typename Value>
bool same(const std::optional<Value>& a, const std::optional<Value>& b) {
  return a.has_value() == b.has_value() && (!a || same(*a, *b));
}

// Puts `to` where `from` is, either of which may be missing. False where `from` is not there.
template <typename Item>
bool exchange(std::vector<Item>& list, std::size_t index, const std::optional<Item>& from,
              const std::optional<Item>& to) {
  if (from ? index >= list.size() || !same(list[index], *from) : index > list.size()) return false;
  const auto place = list.begin() + static_cast<std::ptrdiff_t>(index);
  if (from && to) {
    *place = *to;
  } else if (from) {
    list.erase(place);
  } else if (to) {
    list.insert(place, *to);
  }
  return true;
}

template <typename Value>
std::pair<const Value&, const Value&> directed(const Value& before, const Value& after, Direction direction) {
  return direction == Direction::kDo ? std::pair<const Value&, const Value&>(before, after)
                                     : std::pair<const Value&, const Value&>(after, before);
}

struct Applier {
  Direction direction;
  ExamContent& content;

  template <typename Item>
  bool operator()(const ItemChange<Item>& change) const {
    if (change.structure >= content.structures.size()) return false;
    const auto [from, to] = directed(change.before, change.after, direction);
    return exchange(content.structures[change.structure].*kList<Item>, change.index, from, to);
  }

  bool operator()(const StructureChange& change) const {
    const auto [from, to] = directed(change.before, change.after, direction);
    if (!exchange(content.structures, change.index, from, to)) return false;
    const auto place = content.ids.begin() + static_cast<std::ptrdiff_t>(change.index);
    if (from && !to) content.ids.erase(place);
    if (to && !from) content.ids.insert(place, change.id);
    return true;
  }

  bool operator()(const StyleChange& change) const {
    if (change.structure >= content.structures.size()) return false;
    const auto [from, to] = directed(change.before, change.after, direction);
    Structure& structure = content.structures[change.structure];
    if (StructureStyle{structure.name, structure.color, structure.opacity} != from) return false;
    structure.name = to.name;
    structure.color = to.color;
    structure.opacity = to.opacity;
    return true;
  }

  bool operator()(const DivisionChange& change) const {
    const auto [sweeps_from, sweeps_to] = directed(change.sweeps_before, change.sweeps_after, direction);
    const auto [planes_from, planes_to] = directed(change.planes_before, change.planes_after, direction);
    if (content.sweeps != sweeps_from || !same(content.planes, planes_from)) return false;
    content.sweeps = sweeps_to;
    content.planes = planes_to;
    return true;
  }

  bool operator()(const TextChange& change) const {
    const auto [from, to] = directed(change.before, change.after, direction);
    std::string& text = content.texts[static_cast<std::size_t>(change.text)];
    if (text != from) return false;
    text = to;
    return true;
  }
};

template <typename Item>
bool unchanged(const ItemChange<Item>& change) {
  return same(change.before, change.after);
}
bool unchanged(const StructureChange& change) { return same(change.before, change.after); }
bool unchanged(const StyleChange& change) { return change.before == change.after; }
bool unchanged(const DivisionChange& change) {
  return change.sweeps_before == change.sweeps_after && same(change.planes_before, change.planes_after);
}
bool unchanged(const TextChange& change) { return change.before == change.after; }

// Whether other items keep their places.
bool keeps_places(const Change& change) {
  return std::visit(
      [](const auto& c) {
        if constexpr (requires { c.before.has_value(); }) {
          return c.before.has_value() && c.after.has_value();
        } else {
          return true;
        }
      },
      change);
}

// Makes one change of an earlier and a later one. False where they are of different things.
template <typename Item>
bool join(ItemChange<Item>& earlier, ItemChange<Item>& later) {
  if (earlier.structure != later.structure || earlier.index != later.index || !earlier.after || !later.before) {
    return false;
  }
  earlier.after = std::move(later.after);
  return true;
}
bool join(StructureChange& earlier, StructureChange& later) {
  if (earlier.index != later.index || !earlier.after || !later.before) return false;
  earlier.after = std::move(later.after);
  return true;
}
bool join(StyleChange& earlier, StyleChange& later) {
  if (earlier.structure != later.structure) return false;
  earlier.after = std::move(later.after);
  return true;
}
bool join(DivisionChange& earlier, DivisionChange& later) {
  earlier.sweeps_after = std::move(later.sweeps_after);
  earlier.planes_after = std::move(later.planes_after);
  return true;
}
bool join(TextChange& earlier, TextChange& later) {
  if (earlier.text != later.text) return false;
  earlier.after = std::move(later.after);
  return true;
}

bool join(Change& earlier, Change& later) {
  return std::visit(
      [](auto& a, auto& b) {
        if constexpr (std::is_same_v<decltype(a), decltype(b)>) {
          return join(a, b);
        } else {
          return false;
        }
      },
      earlier, later);
}

std::size_t bytes(const Contour& contour) {
  return sizeof contour + contour.points_px.capacity() * sizeof(Eigen::Vector2d);
}
std::size_t bytes(const Extremity& extremity) { return sizeof extremity; }
std::size_t bytes(const AbsentMark& mark) { return sizeof mark; }
std::size_t bytes(const Structure& structure) {
  std::size_t sum = sizeof structure + structure.name.size() + structure.color.size();
  for (const Contour& contour : structure.contours) sum += bytes(contour);
  return sum + structure.extremities.size() * sizeof(Extremity) + structure.absent.size() * sizeof(AbsentMark);
}

std::size_t bytes(const Change& change) {
  return sizeof change + std::visit(
                             [](const auto& c) -> std::size_t {
                               if constexpr (requires { c.before.has_value(); }) {
                                 return (c.before ? bytes(*c.before) : 0) + (c.after ? bytes(*c.after) : 0);
                               } else if constexpr (std::is_same_v<decltype(c), const StyleChange&>) {
                                 return c.before.name.size() + c.after.name.size();
                               } else if constexpr (std::is_same_v<decltype(c), const DivisionChange&>) {
                                 return (c.sweeps_before.size() + c.sweeps_after.size()) * sizeof(Sweep) +
                                        (c.planes_before.size() + c.planes_after.size()) * sizeof(DividingPlane);
                               } else {
                                 return c.before.size() + c.after.size();
                               }
                             },
                             change);
}

std::uint64_t hash(std::string_view text, std::uint64_t so_far) {
  for (const char c : text) so_far = (so_far ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return so_far;
}

constexpr std::uint64_t kHashStart = 0xcbf29ce484222325U;

}  // namespace

void put_in_order(Structure& structure) {
  const auto by_place = [](const auto& a, const auto& b) {
    return std::tie(a.recording, a.frame) < std::tie(b.recording, b.frame);
  };
  std::stable_sort(structure.contours.begin(), structure.contours.end(), by_place);
  std::stable_sort(structure.extremities.begin(), structure.extremities.end(), by_place);
  std::stable_sort(structure.absent.begin(), structure.absent.end(), by_place);
  // Files do not keep the sign of zero.
  for (Contour& contour : structure.contours) {
    for (Eigen::Vector2d& point : contour.points_px) point.array() += 0.0;
  }
  for (Extremity& extremity : structure.extremities) extremity.point_px.array() += 0.0;
}

std::uint64_t outlines_digest(const ExamContent& content) {
  return hash(contours_json(content.structures), kHashStart);
}

std::uint64_t content_digest(const ExamContent& content) {
  std::uint64_t digest = outlines_digest(content);
  digest = hash(planes_json({content.sweeps, content.planes}), digest);
  for (const std::string& text : content.texts) digest = hash(std::string_view(text.c_str(), text.size() + 1), digest);
  return digest;
}

std::string digest_text(const ExamContent& content) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(content_digest(content)));
  return digits;
}

std::uint64_t measured_digest(const ExamContent& content) {
  std::vector<Structure> structures = content.structures;
  for (Structure& structure : structures) {
    structure.name = structure.color = {};
    structure.opacity = kUsualOpacity;
  }
  return hash(planes_json({content.sweeps, content.planes}), hash(contours_json(structures), kHashStart));
}

bool apply(const Change& change, Direction direction, ExamContent& content) {
  return std::visit(Applier{direction, content}, change);
}

bool apply(const Edit& edit, Direction direction, ExamContent& content) {
  const auto step = [&](const Change& change) { return apply(change, direction, content); };
  return direction == Direction::kDo ? std::all_of(edit.changes.begin(), edit.changes.end(), step)
                                     : std::all_of(edit.changes.rbegin(), edit.changes.rend(), step);
}

bool is_nothing(const Change& change) {
  return std::visit([](const auto& c) { return unchanged(c); }, change);
}

void add_change(Change change, Edit& edit) {
  if (is_nothing(change)) return;
  for (std::size_t i = edit.changes.size(); i-- > 0;) {
    Change& earlier = edit.changes[i];
    if (join(earlier, change)) {
      if (is_nothing(earlier)) edit.changes.erase(edit.changes.begin() + static_cast<std::ptrdiff_t>(i));
      return;
    }
    if (!keeps_places(earlier) || !keeps_places(change)) break;
  }
  edit.changes.push_back(std::move(change));
}

std::size_t size_bytes(const Edit& edit) {
  std::size_t sum = sizeof edit + edit.name.size();
  for (const Change& change : edit.changes) sum += bytes(change);
  return sum;
}

}  // namespace fathom
