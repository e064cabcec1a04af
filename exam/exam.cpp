#include "exam/exam.h"

#include <algorithm>
#include <array>
#include <optional>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/json.h"
#include "core/printable.h"
#include "core/text_file.h"
#include "registration/dividing_planes.h"

namespace fathom {

namespace {

constexpr const char* kFileName = "exam.json";
constexpr std::size_t kMaxRecordings = 1000;
constexpr std::size_t kLongestName = 1000;  // bytes

// The keys whose values are texts, with the members that they become.
constexpr std::array<std::pair<const char*, std::string Exam::*>, 6> kTexts{{{"calibration", &Exam::calibration},
                                                                             {"structures", &Exam::structures},
                                                                             {"patient", &Exam::patient},
                                                                             {"operator", &Exam::operator_name},
                                                                             {"date", &Exam::date},
                                                                             {"notes", &Exam::notes}}};

// Why a name must not be followed, for the user; empty where it may.
std::optional<std::string> name_fault(const std::filesystem::path& folder, const std::string& name) {
  if (name.empty()) return "is empty; name a file of the exam's folder";
  if (name.size() > kLongestName) return "is too long for a name; name a file of the exam's folder";
  if (std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; })) {
    return "holds control characters; name a file of the exam's folder";
  }
  const std::string outside = "leads out of the exam's folder; move the file into it";
  const std::filesystem::path path = name;
  if (path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end()) return outside;
  // Symbolic links may lead anywhere.
  std::error_code code;
  const auto root = std::filesystem::canonical(folder, code);
  const auto place = code ? root : std::filesystem::weakly_canonical(folder / path, code);
  if (code) return "cannot be followed: " + code.message() + "; check the links in the exam's folder";
  const auto [end, rest] = std::mismatch(root.begin(), root.end(), place.begin(), place.end());
  if (end != root.end()) return outside;
  if (rest == place.end()) return "is the exam's folder itself; name a file in it";
  return std::nullopt;
}

std::string file_name(const JsonValue& value, const std::filesystem::path& folder) {
  std::string name = value.string();
  if (const auto fault = name_fault(folder, name)) value.fail(*fault);
  return name;
}

void read_recordings(const JsonValue& names, Exam& exam) {
  if (names.size() == 0) names.fail("names no recording; name at least one");
  if (names.size() > kMaxRecordings) names.fail("names more than 1000 recordings; make several exams of them");
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string name = file_name(names[i], exam.folder);
    if (std::find(exam.recordings.begin(), exam.recordings.end(), name) != exam.recordings.end()) {
      names[i].fail("is named twice; name every recording once");
    }
    exam.recordings.push_back(std::move(name));
  }
}

// `made`, but elements that `same` finds unchanged in the file as they stand there, with all that others added.
template <typename Value, typename Same>
nlohmann::json kept_elements(nlohmann::json made, const std::vector<Value>& values, const nlohmann::json& stored,
                             const std::vector<Value>& stored_values, Same same) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto found = std::find_if(stored_values.begin(), stored_values.end(),
                                    [&](const Value& candidate) { return same(candidate, values[i]); });
    if (found != stored_values.end()) made[i] = stored[static_cast<std::size_t>(found - stored_values.begin())];
  }
  return made;
}

}  // namespace

bool is_exam(const std::filesystem::path& path) {
  std::error_code ignored;
  if (path.filename() == kFileName) return true;
  return std::filesystem::is_directory(path, ignored) && std::filesystem::exists(path / kFileName, ignored);
}

std::filesystem::path exam_json(const Exam& exam) { return exam.folder / kFileName; }

Exam read_exam(const std::filesystem::path& path) {
  Exam exam;
  exam.folder = path.filename() == kFileName ? path.parent_path() : path;
  if (exam.folder.empty()) exam.folder = ".";
  exam.document = JsonValue::read_file(exam_json(exam));
  const JsonValue root(exam.document, exam_json(exam));
  require_version(root, "fathom_exam", 1);
  read_recordings(root.at("recordings"), exam);
  for (const auto& [key, member] : kTexts) {
    if (root.has(key) && !root.at(key).is_null()) exam.*member = root.at(key).string();
  }
  for (const char* key : {"calibration", "structures"}) {
    if (root.has(key) && !root.at(key).is_null()) file_name(root.at(key), exam.folder);
  }
  PlanesFile planes = planes_of(root);
  for (std::size_t i = 0; i < planes.sweeps.size(); ++i) {
    if (planes.sweeps[i].recording >= exam.recordings.size()) {
      root.at("sweeps")[i].fail("is of recording " + std::to_string(planes.sweeps[i].recording) + ", but there are " +
                                std::to_string(exam.recordings.size()) + ", counted from 0");
    }
  }
  exam.sweeps = std::move(planes.sweeps);
  exam.dividing_planes = std::move(planes.planes);
  if (root.has("results")) exam.results = exam.document["results"];
  return exam;
}

std::filesystem::path file_of(const Exam& exam, const std::string& name) {
  const auto fail = [&](const std::string& what) {
    throw Error(exam_json(exam).string() + ": " + printable(name) + " " + what);
  };
  if (const auto fault = name_fault(exam.folder, name)) fail(*fault);
  std::error_code ignored;
  if (!std::filesystem::exists(exam.folder / name, ignored)) {
    fail("is not in the folder; copy it there, or name the file that is");
  }
  return exam.folder / name;
}

std::string exam_text(const Exam& exam) {
  nlohmann::json json = exam.document.is_object() ? exam.document : nlohmann::json::object();
  json["fathom_exam"] = 1;
  json["recordings"] = exam.recordings;
  for (const auto& [key, member] : kTexts) {
    if (!(exam.*member).empty() || (json.contains(key) && json[key].is_string())) json[key] = exam.*member;
  }
  // A key without a file must not become a file without a name.
  for (const char* key : {"calibration", "structures"}) {
    if (json.contains(key) && json[key] == "") json.erase(key);
  }
  const nlohmann::json made = nlohmann::json::parse(planes_json({exam.sweeps, exam.dividing_planes}));
  const PlanesFile stored =
      exam.document.is_object() ? planes_of(JsonValue(exam.document, exam_json(exam))) : PlanesFile{};
  json["sweeps"] =
      kept_elements(made["sweeps"], exam.sweeps, json["sweeps"], stored.sweeps, std::equal_to<const Sweep&>());
  json["dividing_planes"] =
      kept_elements(made["dividing_planes"], exam.dividing_planes, json["dividing_planes"], stored.planes,
                    [](const DividingPlane& a, const DividingPlane& b) { return a.coeffs() == b.coeffs(); });
  if (!exam.results.is_null() || json.contains("results")) json["results"] = exam.results;
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void set_division(Exam& exam, std::vector<Sweep> sweeps, std::vector<DividingPlane> planes) {
  const auto same_plane = [](const DividingPlane& a, const DividingPlane& b) { return a.coeffs() == b.coeffs(); };
  const bool same =
      std::equal(sweeps.begin(), sweeps.end(), exam.sweeps.begin(), exam.sweeps.end()) &&
      std::equal(planes.begin(), planes.end(), exam.dividing_planes.begin(), exam.dividing_planes.end(), same_plane);
  if (!same) exam.results = nullptr;
  exam.sweeps = std::move(sweeps);
  exam.dividing_planes = std::move(planes);
}

void write_exam(const Exam& exam) { write_text_file(exam_json(exam), exam_text(exam)); }

}  // namespace fathom
