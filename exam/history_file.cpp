#include "exam/history_file.h"

#include <algorithm>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/json.h"
#include "exam/edit_json.h"

namespace fathom {

namespace {

constexpr const char* kMarker = "fathom_history";
constexpr int kVersion = 1;
// Of edits in memory. As text they have less than the 6 million values that the reader takes.
constexpr std::size_t kMostSaved = std::size_t{24} << 20;

// The range of edits to keep: around the one done last, the done ones first.
std::pair<std::size_t, std::size_t> to_keep(const History& history) {
  const auto& edits = history.edits();
  std::size_t bytes = 0;
  std::size_t first = history.done();
  while (first > 0 && (bytes += size_bytes(*edits[first - 1])) <= kMostSaved) --first;
  std::size_t last = history.done();
  while (last < edits.size() && (bytes += size_bytes(*edits[last])) <= kMostSaved) ++last;
  return {first, last};
}

void require_unique(const JsonValue& value, const std::vector<std::uint64_t>& ids) {
  if (std::set(ids.begin(), ids.end()).size() != ids.size()) value.fail("names one structure twice");
}

// Throws Error unless all edits can be undone and done again, without a state that no exam may have.
void require_fit(const SavedHistory& history, ExamContent content, const JsonValue& root) {
  content.ids = history.ids;
  const auto step = [&](std::size_t i, Direction direction) {
    if (apply(*history.edits[i], direction, content) && could_be_saved(content)) return;
    root.at("edits")[i].fail("does not fit the exam; undo starts anew");
  };
  for (std::size_t i = history.done; i-- > 0;) step(i, Direction::kUndo);
  for (std::size_t i = 0; i < history.edits.size(); ++i) step(i, Direction::kDo);
}

}  // namespace

bool could_be_saved(const ExamContent& content) {
  std::set<std::string> names;
  return std::all_of(content.structures.begin(), content.structures.end(), [&](const Structure& structure) {
    if (name_fault(structure.name) || !names.insert(structure.name).second) return false;
    std::set<std::pair<int, int>> marked;
    for (const Extremity& mark : structure.extremities) {
      if (!marked.insert({mark.recording, mark.frame}).second) return false;
    }
    for (const AbsentMark& mark : structure.absent) {
      if (!marked.insert({mark.recording, mark.frame}).second) return false;
    }
    return std::none_of(structure.contours.begin(), structure.contours.end(), [&](const Contour& contour) {
      return marked.contains({contour.recording, contour.frame});
    });
  });
}

void require_frames(const Edit& edit, const std::vector<int>& frame_counts, const std::string& file) {
  std::vector<Structure> named(1);
  named[0].name = "of an action";
  const auto add = [&](const auto& value) {
    using Value = std::decay_t<decltype(*value)>;
    if (!value) return;
    if constexpr (std::is_same_v<Value, Contour>) named[0].contours.push_back(*value);
    if constexpr (std::is_same_v<Value, Extremity>) named[0].extremities.push_back(*value);
    if constexpr (std::is_same_v<Value, AbsentMark>) named[0].absent.push_back(*value);
    if constexpr (std::is_same_v<Value, Structure>) named.push_back(*value);
  };
  const auto require_sweeps = [&](const std::vector<Sweep>& sweeps) {
    for (const Sweep& sweep : sweeps) {
      if (sweep.recording >= frame_counts.size() || sweep.last >= frame_counts[sweep.recording]) {
        throw Error(file + ": an action has a sweep that the recordings do not have; undo starts anew");
      }
    }
  };
  for (const Change& change : edit.changes) {
    std::visit(
        [&](const auto& c) {
          if constexpr (requires { c.before.has_value(); }) {
            add(c.before);
            add(c.after);
          } else if constexpr (requires { c.sweeps_before; }) {
            require_sweeps(c.sweeps_before);
            require_sweeps(c.sweeps_after);
          }
        },
        change);
  }
  require_measurable(named, frame_counts, OpenContours::kAllow, file);
}

std::string history_json(const History& history, const ExamContent& content) {
  const auto [first, last] = to_keep(history);
  std::string text = std::string("{\"") + kMarker + "\": " + std::to_string(kVersion) + ",\n\"content\": \"" +
                     digest_text(content) + "\",\n\"done\": " + std::to_string(history.done() - first) +
                     ",\n\"ids\": [";
  for (std::size_t i = 0; i < content.ids.size(); ++i) text += (i > 0 ? ", " : "") + std::to_string(content.ids[i]);
  text += "],\n\"edits\": [";
  for (std::size_t i = first; i < last; ++i) text += (i > first ? ",\n" : "\n") + edit_json(*history.edits()[i]);
  return text + "\n]}\n";
}

SavedHistory read_history(const std::filesystem::path& path, const ExamContent& content,
                          const std::vector<int>& frame_counts) {
  const nlohmann::json document = JsonValue::read_file(path);
  const JsonValue root(document, path);
  require_version(root, kMarker, kVersion);
  if (root.at("content").string() != digest_text(content)) {
    root.at("content").fail("is of other outlines: another program changed the exam; undo starts anew");
  }
  SavedHistory history;
  const JsonValue ids = root.at("ids");
  if (ids.size() != content.structures.size()) ids.fail("must have one number for each structure");
  for (std::size_t i = 0; i < ids.size(); ++i) {
    history.ids.push_back(static_cast<std::uint64_t>(ids[i].integer(1, 1 << 30)));
  }
  require_unique(ids, history.ids);
  const JsonValue edits = root.at("edits");
  for (std::size_t i = 0; i < edits.size(); ++i) {
    history.edits.push_back(std::make_shared<const Edit>(read_edit(edits[i])));
    require_frames(*history.edits.back(), frame_counts, path.string());
  }
  history.done = static_cast<std::size_t>(root.at("done").integer(0, static_cast<int>(edits.size())));
  require_fit(history, content, root);
  return history;
}

}  // namespace fathom
