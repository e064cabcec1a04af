#include "exam/make_exam.h"

#include <algorithm>
#include <system_error>

#include "acquisition/recording.h"
#include "core/error.h"
#include "core/printable.h"
#include "core/staged_folder.h"
#include "core/text_file.h"
#include "exam/scan.h"
#include "registration/calibration.h"
#include "segmentation/contours.h"

namespace fathom {

namespace {

// Throws Error for a name that exam.json could not hold, or that read_exam would refuse.
void require_storable(const std::string& name) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  const std::string text = nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (std::any_of(name.begin(), name.end(), is_control) || nlohmann::json::parse(text) != name) {
    throw Error(printable(name) + ": a name with control characters, or that is not UTF-8, has no place in an exam; " +
                "rename the file");
  }
}

// Brings files into an exam's folder, by way of a folder in which they are complete first.
class Intake {
 public:
  explicit Intake(const std::filesystem::path& folder) : folder_(folder), staged_(folder) {}

  std::string recording(const std::filesystem::path& file, const Progress& progress) {
    const auto opened = open_recording(file);
    if (const auto name = name_inside(file)) return *name;
    if (!std::filesystem::is_directory(file)) {
      const std::string name = copy(file);
      try {
        open_recording(staged_.path() / name);
        return name;
      } catch (const Error&) {
        // Its pixels are in another file: both become one.
        std::filesystem::remove(staged_.path() / name);
      }
    }
    // A recording folder's too.
    const std::string whole = free_name(file.stem().string(), ".mha");
    write_recording(*opened, staged_.path() / whole, {}, progress);
    return whole;
  }

  std::string document(const std::filesystem::path& file) {
    if (const auto name = name_inside(file)) return *name;
    return copy(file);
  }

  std::string text(const std::string& stem, const std::string& text) {
    const std::string name = free_name(stem, ".json");
    write_text_file(staged_.path() / name, text);
    return name;
  }

  // Under this very name, also where there is such a file.
  void fixed_text(const std::string& name, const std::string& text) { write_text_file(staged_.path() / name, text); }

  void finish(const Exam& exam) {
    for (const std::string& name : exam.recordings) require_storable(name);
    require_storable(exam.calibration);
    require_storable(exam.structures);
    write_text_file(staged_.path() / exam_json(exam).filename(), exam_text(exam));
    staged_.commit(exam_json(exam).filename());
  }

 private:
  // The name of a file that is in the folder already.
  std::optional<std::string> name_inside(const std::filesystem::path& file) const {
    std::error_code code;
    const auto root = std::filesystem::canonical(folder_, code);
    if (code) return std::nullopt;
    const auto place = std::filesystem::canonical(file, code);
    if (code) return std::nullopt;
    const auto relative = place.lexically_relative(root);
    if (relative.empty() || *relative.begin() == "..") return std::nullopt;
    return relative.string();
  }

  std::string free_name(const std::string& stem, const std::string& extension) const {
    for (int number = 1;; ++number) {
      const std::string name = stem + (number > 1 ? "-" + std::to_string(number) : "") + extension;
      if (!std::filesystem::exists(folder_ / name) && !std::filesystem::exists(staged_.path() / name)) return name;
    }
  }

  std::string copy(const std::filesystem::path& file) {
    if (!std::filesystem::is_regular_file(file)) throw Error(file.string() + ": is not a file; name a file");
    const std::string name = free_name(file.stem().string(), file.extension().string());
    std::error_code code;
    std::filesystem::copy_file(file, staged_.path() / name, code);
    if (code) throw Error(file.string() + ": cannot be copied into the exam: " + code.message() + "; check the disk");
    return name;
  }

  std::filesystem::path folder_;
  StagedFolder staged_;
};

// Throws Error unless all that the exam will hold goes together.
void require_consistent(const std::vector<std::filesystem::path>& recordings, const std::filesystem::path& calibration,
                        const std::filesystem::path& contours) {
  std::vector<int> frames;
  std::optional<Calibration> placed;
  if (!calibration.empty()) placed = read_calibration(calibration);
  std::string reference;
  for (const auto& file : recordings) {
    const auto recording = open_recording(file);
    frames.push_back(recording->header().frame_count());
    if (!placed) continue;
    const FrameLocator locator(*recording, *placed);
    if (!reference.empty() && locator.reference_frame() != reference) {
      throw Error(file.string() + ": lies in coordinates " + locator.reference_frame() + ", the others in " +
                  reference + "; make an exam of its own for it");
    }
    reference = locator.reference_frame();
  }
  if (contours.empty()) return;
  require_measurable(read_contours(contours), frames, OpenContours::kAllow, contours.string());
}

void take(const std::optional<std::string>& text, std::string& into) {
  if (text) into = *text;
}

Exam put_in(Exam exam, const ExamParts& parts, const Progress& progress) {
  std::vector<std::filesystem::path> recordings;
  for (const std::string& name : exam.recordings) recordings.push_back(file_of(exam, name));
  recordings.insert(recordings.end(), parts.recordings.begin(), parts.recordings.end());
  const auto chosen = [&](const std::filesystem::path& part, const std::string& stored) {
    return part.empty() && !stored.empty() ? file_of(exam, stored) : part;
  };
  require_consistent(recordings, chosen(parts.calibration, exam.calibration), chosen(parts.contours, exam.structures));

  Intake intake(exam.folder);
  for (const auto& file : parts.recordings) {
    std::string name = intake.recording(file, progress);
    if (std::find(exam.recordings.begin(), exam.recordings.end(), name) != exam.recordings.end()) {
      throw Error(file.string() + ": is in the exam already; name every recording once");
    }
    exam.recordings.push_back(std::move(name));
  }
  if (!parts.calibration.empty()) exam.calibration = intake.document(parts.calibration);
  if (!parts.contours.empty()) exam.structures = intake.document(parts.contours);
  if (parts.contours_text) exam.structures = intake.text("contours", *parts.contours_text);
  if (parts.history_text) intake.fixed_text(kHistoryFile, *parts.history_text);
  take(parts.patient, exam.patient);
  take(parts.operator_name, exam.operator_name);
  take(parts.date, exam.date);
  take(parts.notes, exam.notes);
  intake.finish(exam);
  return exam;
}

}  // namespace

Exam create_exam(const std::filesystem::path& folder, const ExamParts& parts, const Progress& progress) {
  Exam exam;
  exam.folder = folder;
  return create_exam(std::move(exam), parts, progress);
}

Exam create_exam(Exam exam, const ExamParts& parts, const Progress& progress) {
  const std::string folder = exam.folder.string();
  if (is_exam(exam.folder)) {
    throw Error(folder + ": holds an exam already; change it by `fathom exam update`, or name another folder");
  }
  if (parts.recordings.empty()) throw Error(folder + ": an exam needs a recording; name at least one");
  exam.recordings.clear();
  exam.calibration.clear();
  exam.structures.clear();
  return put_in(std::move(exam), parts, progress);
}

Exam update_exam(Exam exam, const ExamParts& parts, const Progress& progress) {
  // What was measured was measured of other inputs.
  if (!parts.recordings.empty() || !parts.calibration.empty() || !parts.contours.empty()) exam.results = nullptr;
  return put_in(std::move(exam), parts, progress);
}

}  // namespace fathom
