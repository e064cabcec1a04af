#include "viewer/session.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "core/error.h"
#include "exam/anonymous.h"
#include "viewer/calibration_beside.h"

namespace fathom {

Session::Session(std::function<void()> wake) : frames_(std::move(wake)), worker_(2) {}

Session::~Session() { worker_.cancel_all(); }

const StructureView* Session::find_structure(std::uint64_t id) const {
  return structures_ ? structures_->find(id) : nullptr;
}

void Session::cancel(const std::string& key) {
  if (structures_) structures_->cancel(*document_, key);
  worker_.cancel(key);
}

bool Session::is_under_way(const std::string& key) const {
  const std::vector<JobStatus> jobs = worker_.jobs();
  return std::any_of(jobs.begin(), jobs.end(), [&](const JobStatus& job) { return job.key == key && !job.cancelling; });
}

void Session::retry_surface(std::uint64_t id) {
  if (structures_) structures_->retry_surface(*document_, id);
}

void Session::save() {
  attempt("save", [this] { start_saving(document_->begin_save(), "Saving"); });
}

void Session::save_as(const std::filesystem::path& folder) {
  attempt("save as",
          [&] { start_saving(document_->begin_save_as(folder), "Saving to " + folder.filename().string(), folder); });
}

void Session::start_saving(std::shared_ptr<PendingSave> pending, const std::string& title,
                           const std::filesystem::path& opened) {
  const Document* of = document_.get();
  const auto work = [this, pending, of, opened](const Progress& progress) -> std::function<void()> {
    pending->write(progress);
    return [this, pending, of, opened] {
      if (document_.get() == of) attempt("save", [&] { document_->finish_save(*pending); });
      if (!opened.empty() && on_opened) on_opened(opened);
    };
  };
  worker_.start({"save", title, work, [this](const std::string& error) { say("save", error); }});
}

void Session::open(const std::filesystem::path& path) { open(path, {}); }

void Session::open(const std::filesystem::path& path, const DocumentOptions& options) {
  const auto work = [this, path, options](const Progress&) -> std::function<void()> {
    // A std::function must be copyable, so the document travels in shared hands.
    auto opened = std::make_shared<std::unique_ptr<Document>>(std::make_unique<Document>(path, options));
    return [this, opened, path] { take_document(std::move(*opened), path); };
  };
  worker_.start({"open", "Opening " + path.filename().string(), work,
                 [this, path](const std::string& error) { say(path.filename().string(), error); }});
}

void Session::take_document(std::unique_ptr<Document> document, const std::filesystem::path& path) {
  worker_.cancel_all();  // what it does is of another document
  structures_.reset();
  document_ = std::move(document);
  calibration_beside_ = document_->is_calibrated() ? std::filesystem::path() : find_calibration_beside(path);
  structures_ = std::make_unique<StructureViews>(*document_, worker_);
  told_ = 0;
  const ViewState before = view;
  view = ViewState();
  view.brush_px = before.brush_px;
  view.assist = before.assist;
  view.assist.low = AssistOptions().low;  // grey values of one recording say nothing of another's
  view.assist.high = AssistOptions().high;
  view.show_surfaces = before.show_surfaces;
  if (const RecordingHeader* shown = header(); shown != nullptr && shown->frame_count() > 0) {
    // The outlined part is what one wants to see; else the middle.
    int frame = shown->frame_count() / 2;
    if (!document_->structures().empty()) {
      const std::vector<Contour>& contours = document_->structures().front().contours;
      if (!contours.empty()) {
        frame = contours[contours.size() / 2].frame;
        view.recording = contours[contours.size() / 2].recording;
      }
    }
    show_frame(frame);
  }
  if (on_opened) on_opened(path);
}

void Session::close() {
  worker_.cancel_all();
  structures_.reset();
  document_.reset();
  view = ViewState();
}

bool Session::attempt(const std::string& about, const std::function<void()>& command) {
  try {
    command();
    return true;
  } catch (const std::exception& error) {
    if (document_ && document_->in_action()) document_->cancel_action();
    say(about, error.what());
    return false;
  }
}

std::string Session::text_to_show(const std::string& text) const {
  return view.hides_names && document_ ? without_file_names(text, document_->snapshot()) : text;
}

void Session::say(std::string about, std::string text, bool is_error) {
  const auto same = [&](const Message& message) { return message.text == text; };
  std::erase_if(messages_, same);
  messages_.push_back({std::move(about), std::move(text), is_error});
}

void Session::poll() {
  worker_.poll();
  if (!document_) return;
  for (; told_ < document_->messages().size(); ++told_) say(document_->title(), document_->messages()[told_], false);
  document_->poll();
  structures_->update(*document_, worker_);
}

bool Session::busy() const { return !worker_.idle() || frames_.busy(); }

const RecordingHeader* Session::header() const {
  if (!document_) return nullptr;
  const auto index = static_cast<std::size_t>(view.recording);
  return index < document_->scan()->recordings.size() ? &document_->scan()->recordings[index]->header() : nullptr;
}

int Session::frame_count() const { return header() == nullptr ? 0 : header()->frame_count(); }

void Session::show_frame(int frame) {
  const int count = frame_count();
  if (count == 0) return;
  const int wanted = std::clamp(frame, 0, count - 1);
  if (wanted != view.frame) view.drop_unfinished();
  view.frame = wanted;
}

void Session::show_recording(int recording) {
  if (!document_ || recording < 0 || static_cast<std::size_t>(recording) >= document_->scan()->recordings.size())
    return;
  view.recording = recording;
  view.drop_unfinished();
  view.frame = std::clamp(view.frame, 0, std::max(0, frame_count() - 1));
}

std::optional<Eigen::Affine3d> Session::reference_from_image() const {
  if (!document_ || frame_count() == 0) return std::nullopt;
  const auto& locators = document_->scan()->locators;
  const auto index = static_cast<std::size_t>(view.recording);
  if (index >= locators.size() || !document_->is_calibrated()) return std::nullopt;
  return locators[index].reference_from_image(view.frame);
}

double Session::pixel_aspect() const {
  const auto placed = reference_from_image();
  return placed ? placed->linear().col(1).norm() / placed->linear().col(0).norm() : 1.0;
}

std::optional<std::size_t> Session::active_structure() const {
  if (!document_ || document_->structures().empty()) return std::nullopt;
  return std::min(view.structure, document_->structures().size() - 1);
}

std::size_t Session::require_structure() {
  if (const auto active = active_structure()) return *active;
  Structure structure;
  structure.name = "structure 1";
  structure.color.clear();
  view.structure = document_->add_structure(std::move(structure));
  return view.structure;
}

}  // namespace fathom
