#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exam/document.h"
#include "exam/job.h"
#include "viewer/frame_loader.h"
#include "viewer/structure_views.h"
#include "viewer/view_state.h"

namespace fathom {

/// Something that the user must know, with the thing that it is about.
struct Message {
  std::string about;
  std::string text;
  bool is_error = true;
};

/// What all panes look at: one document, how it is viewed, the work under way beside the frame, and messages. Panes
/// read it and send it commands.
class Session {
 public:
  explicit Session(std::function<void()> wake);
  ~Session();

  /// Null where nothing is open.
  Document* document() { return document_.get(); }
  const Document* document() const { return document_.get(); }
  ViewState view;
  Worker& worker() { return worker_; }
  const Worker& worker() const { return worker_; }
  FrameLoader& frames() { return frames_; }
  /// What is known of a structure, by its id; null where nothing is.
  const StructureView* find_structure(std::uint64_t id) const;
  /// Stops work under way, by its key.
  void cancel(const std::string& key);
  /// Whether work of this key runs or waits, and was not cancelled.
  bool is_under_way(const std::string& key) const;
  /// Makes a structure's surface after all that was cancelled.
  void retry_surface(std::uint64_t id);

  /// Opens an exam or recording, beside the frame. What is open stays until that is done, and where it fails.
  void open(const std::filesystem::path& path);
  /// With a calibration and contours for a recording that is no exam.
  void open(const std::filesystem::path& path, const DocumentOptions& options);
  /// Beside the frame; in a folder where there is none yet.
  void save();
  void save_as(const std::filesystem::path& folder);
  void close();
  /// A calibration that lies beside the recording that was opened without one; empty where there is none.
  const std::filesystem::path& calibration_beside() const { return calibration_beside_; }

  /// Does what the user asked for; an Error becomes a message about `about`, and an action under way is taken back.
  bool attempt(const std::string& about, const std::function<void()>& command);
  /// The same, or without names of files where the view hides names.
  std::string text_to_show(const std::string& text) const;
  void say(std::string about, std::string text, bool is_error = true);
  std::vector<Message>& messages() { return messages_; }
  const std::vector<Message>& messages() const { return messages_; }

  /// Once a frame: results of work that is done, and new work for what changed.
  void poll();
  bool busy() const;

  // Of the shown frame.
  void show_frame(int frame);
  void show_recording(int recording);
  int frame_count() const;
  const RecordingHeader* header() const;
  /// Empty without a calibration or a pose.
  std::optional<Eigen::Affine3d> reference_from_image() const;
  /// Height of a pixel over its width.
  double pixel_aspect() const;

  /// Where the document has the active structure; empty where there is none.
  std::optional<std::size_t> active_structure() const;
  /// The same, made where there is none.
  std::size_t require_structure();

  /// Called when a document was opened or saved under a name.
  std::function<void(const std::filesystem::path&)> on_opened;

 private:
  // `opened`: the folder of a new exam, told to on_opened once it is there.
  void start_saving(std::shared_ptr<PendingSave> pending, const std::string& title,
                    const std::filesystem::path& opened = {});
  void take_document(std::unique_ptr<Document> document, const std::filesystem::path& path);

  std::unique_ptr<Document> document_;
  std::filesystem::path calibration_beside_;
  std::vector<Message> messages_;
  std::size_t told_ = 0;  // of the document's own messages
  FrameLoader frames_;
  Worker worker_;
  std::unique_ptr<StructureViews> structures_;  // of document_; goes before what it refers to
};

}  // namespace fathom
